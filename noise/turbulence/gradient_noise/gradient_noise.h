/// Solid gradient noise in three dimensions and time: the paper's alternative source (Section 6, *paper*), not
/// periodic.
///
///     n(x, t) = g(x) Σ_o A_o N(R_o (x - v t)/s_o + offset_o, rate_o t),   s_o = s_0/2^o,   A_o ∝ s_o^(1/3)
///     (Kolmogorov)
///
/// N is Perlin's noise in four dimensions: gradients of the 32 edges of the hypercube hashed at integer cells, quintic
/// fade, hence C2. Cells s_o run from kLargestCell L0 down to kSmallestCell l0, each octave turned by its own rotation
/// R_o against the alignment of lattices. Σ A_o² <N²> is the spectrum's own variance ∫Φ d³k. *added*: rate_o =
/// √(3α/2)/s_o, for which the variance of ∂n/∂t is that of the modes' correlation exp(-αk²t²/4) at the same spatial
/// spectrum. Velocity is an exact translation. The paper's spectrum has no period here: its lowest wavenumber k_m
/// counts cycles per period[0], or per L0 if none is given, and it ends at the inner scale's 5.92/l0.
///
/// The gradient is the exact derivative of the value, falloff g included. Between l0 and L0 the structure function
/// follows Cn² r^(2/3) to about kStructureError: octaves are a coarse spectrum. Range: any finite x [m] and t [s];
/// cells are counted in 64 bits (beyond 2^52 of them the pattern repeats).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "noise/math/index_sample.h"
#include "noise/medium/media.h"

namespace eikonal {

/// <N²> of one octave over its cell: ¾·4 (∫w² + (1-w)²)³ ∫w²t² + (1-w)²(1-t)², w = 1 - fade.
inline constexpr double kGradientNoiseVariance = 3172411435.0 / 37016152173.0;
/// Largest cell in outer scales and bound of the smallest in inner scales: fitted, so that the structure function's
/// level is right at the spectrum's variance (a cell holds about half a wave).
inline constexpr double kLargestCell = 0.25, kSmallestCell = 0.7;
/// |D_n/(Cn² r^(2/3)) - 1| for 2 l0 <= r <= L0/8.
inline constexpr double kStructureError = 0.15;

/// Immutable, thread-safe.
class GradientNoiseField {
  public:
    explicit GradientNoiseField(const TurbulenceSpec& spec);

    /// n - n_ambient and ∇n [1/m] at x [m] and t [s].
    IndexSample sample(const dvec3& x, double t) const;
    /// With the Hessian [1/m²], continuous.
    IndexJet jet(const dvec3& x, double t) const;

    const std::optional<Falloff>& falloff() const { return falloff_; }
    /// s_o of the finest octave [m].
    double smallest_cell() const { return smallest_cell_; }

    /// ∫Φ d³k, without falloff.
    double variance() const { return variance_; }

  private:
    /// Without falloff.
    template <bool second>
    IndexJet sum(const dvec3& x, double t) const;

    struct Octave {
        std::array<dvec3, 3> rows;  // R_o/s_o [1/m]
        std::array<double, 4> offset;
        double amplitude, rate;
        std::uint64_t key;
    };

    std::vector<Octave> octaves_;
    dvec3 velocity_;
    std::optional<Falloff> falloff_;
    double variance_ = 0, smallest_cell_ = 0;
};

}  // namespace eikonal
