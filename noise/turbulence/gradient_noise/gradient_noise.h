/// Solid gradient noise in three dimensions and time: the paper's alternative source (Section 6, *paper*). It is not
/// periodic.
///
///     n(x, t) = g(x) Σ_o A_o N(R_o (x - v t)/s_o + offset_o, rate_o t),   s_o = s_0/2^o,   A_o ∝ s_o^(1/3)
///     (Kolmogorov)
///
/// N is Perlin's noise in four dimensions. Integer cells hash to one of the gradients along the 32 edges of the
/// hypercube. The quintic fade makes the second derivatives continuous. Cells s_o run from kLargestCell L0 down to
/// kSmallestCell l0. Each octave has its own rotation R_o, so that the lattices do not align. Σ A_o² <N²> is the
/// variance of the spectrum, ∫Φ d³k. The rate √(3α/2)/s_o gives ∂n/∂t the variance that the modes' correlation
/// exp(-αk²t²/4) implies at the same spatial spectrum (*added*). Velocity is an exact translation. The paper's spectrum
/// has no period here: its lowest wavenumber k_m counts cycles in period[0], or in L0 if there is no period, and the
/// spectrum ends at 5.92/l0.
///
/// The gradient is the exact derivative of the value, with the falloff g. Between l0 and L0 the structure function
/// follows Cn² r^(2/3) to about kStructureError, since octaves are a coarse spectrum. Range: any finite x [m] and t
/// [s]. The pattern repeats beyond 2^52 cells. Failures: UserError of the constructor.
/// Theory: PHYSICS.md#gradient-noise.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "noise/math/index_sample.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {

/// <N²> of one octave over its cell: ¾·4 (∫w² + (1-w)²)³ ∫w²t² + (1-w)²(1-t)², w = 1 - fade.
inline constexpr double kGradientNoiseVariance = 3172411435.0 / 37016152173.0;
/// The largest cell in outer scales, and the bound of the smallest in inner scales. They are fitted so that the
/// structure function has the right level at the spectrum's variance. (A cell holds about half a wave.)
inline constexpr double kLargestCell = 0.25, kSmallestCell = 0.7;
/// |D_n/(Cn² r^(2/3)) - 1| for 2 l0 <= r <= L0/8.
inline constexpr double kStructureError = 0.15;

/// Immutable, thread-safe.
class GradientNoiseField {
  public:
    /// UserError: the paper's spectrum without a lowest wavenumber.
    explicit GradientNoiseField(const TurbulenceSpec& spec);

    /// n - n_ambient and ∇n [1/m] at x [m] and t [s].
    IndexSample sample(const dvec3& x, double t) const;
    /// With the Hessian [1/m²], which is continuous.
    IndexJet jet(const dvec3& x, double t) const;

    const std::optional<Falloff>& falloff() const { return falloff_; }
    /// The cell s_o of the finest octave [m].
    double smallest_cell() const { return smallest_cell_; }

    /// The variance ∫Φ d³k, without falloff.
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
