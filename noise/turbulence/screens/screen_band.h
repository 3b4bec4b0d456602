/// One lattice of an evolving thin screen: the modes of optical path in one range of wavenumbers, at any instant.
///
/// Space. Mode k has the variance 2πδ/k² ∫_cell k²Φ(k, kz = 0) jinc²(kA/2) d²k over its own cell of the k plane
/// (PHYSICS.md#thin-screens, *added*): integrating over the cell, where Φ is steep, makes the variance of the gradient
/// right with few modes.
///
/// Time. Mode k is a Gaussian process of correlation exp(-αk²t²/4), the transform of PHYSICS.md#turbulence's
/// exp(-κ²/(αk²)). It is made in the time domain, as a moving average of independent complex Gaussians z_j with the
/// kernel whose self-correlation that is:
///     a(t) ∝ Σ_j z_j exp(-(t - t_j)²/2σ²),   σ = 1/(k√α),  t_j = jT/m,  m = T/(kKnotSpacing σ) rounded
/// over the kKernelTaps nearest j, j modulo m, divided by the root of its own variance. So the variance is exact for
/// every α, the loop over T is seamless, any t costs the same, and no κ lattice need be stored: z_j is a hash of (mode,
/// j). Equal to the sum over a κ lattice to kEvolutionError in correlation when m >= 8; the rounding makes the
/// decorrelation time of the slowest modes wrong by up to 1/(2m), and freezes those that outlive the loop (α → 0: all
/// of them).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "noise/math/periodic_spline2.h"
#include "noise/turbulence/parameters/spectrum.h"

namespace eikonal {

inline constexpr double kKnotSpacing = 1.25;
inline constexpr int kKernelTaps = 8;
/// Absolute error of a mode's correlation against exp(-αk²t²/4) with σ = T/(kKnotSpacing m).
inline constexpr double kEvolutionError = 6e-3;
/// A mode takes at most this many times nt independent values in a loop: values T/nt apart are then independent at
/// large α.
inline constexpr int kStatesPerSample = 4;

/// What one band holds.
struct BandGeometry {
    int nx, ny;        ///< lattice, >= 8
    double Lx, Ly, T;  ///< period [m, s] > 0
    int nt;            ///< time samples a loop >= 1
    int highest;       ///< only modes of index |i|, |j| <= highest (< n/2)
    double thickness;  ///< δ of the slab [m] > 0
    double aperture;   ///< A [m] >= 0
    bool integrate;    ///< integrate over cells (von Kármán), or sample at their centres (the paper's spectrum)
};

/// Immutable, thread-safe.
class ScreenBand {
  public:
    /// index: distinct for every band of every screen of a medium.
    ScreenBand(const TurbulenceSpec& spec, const Spectrum& spectrum, const BandGeometry& geometry, std::uint64_t index);

    /// Optical path ψ [m] at time t, any finite; shared when the band is frozen.
    std::shared_ptr<const PeriodicSpline2> at(double t) const;
    /// Its spectrum: nx × (ny/2+1), half-complex.
    FftVector<complex32> spectrum_at(double t) const;

    const BandGeometry& geometry() const { return geometry_; }
    /// Discrete expectation: variance of ∂ψ/∂x, of ∂ψ/∂y, and of ∂²ψ/∂x² [1/m²].
    double slope_variance_x() const { return slope_x_; }
    double slope_variance_y() const { return slope_y_; }
    double curvature_variance() const { return curvature_; }

    /// Bytes held, and at most needed during at(), for a geometry.
    static double bytes(const BandGeometry& geometry);

  private:
    std::size_t half() const { return static_cast<std::size_t>(geometry_.ny / 2 + 1); }

    BandGeometry geometry_;
    // One a stored mode, row-major: amplitude, states in the loop, two words of hash key.
    std::vector<float> amplitude_;
    std::vector<std::int32_t> states_;
    std::vector<std::uint32_t> key_a_, key_b_;
    std::shared_ptr<const SplinePlan2> plan_;
    std::shared_ptr<const PeriodicSpline2> frozen_;
    double slope_x_ = 0, slope_y_ = 0, curvature_ = 0;
};

}  // namespace eikonal
