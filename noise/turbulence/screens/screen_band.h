/// One lattice of an evolving thin screen: the modes of optical path in one range of wavenumbers (a band), at any
/// instant.
///
/// Space. Mode k has the variance 2πδ/k² ∫_cell k²Φ(k, kz = 0) jinc²(kA/2) d²k over its own cell of the k plane
/// (PHYSICS.md#thin-screens, *added*). Φ is steep. Integration over the cell gives the right variance of the gradient
/// with few modes.
///
/// Time. Mode k is a Gaussian process of correlation exp(-αk²t²/4), which is the transform of exp(-κ²/(αk²)) in
/// PHYSICS.md#turbulence. It is made in the time domain, as a moving average of independent complex Gaussians z_j:
///     a(t) ∝ Σ_j z_j exp(-(t - t_j)²/2σ²),   σ = 1/(k√α),  t_j = jT/m,  m = T/(kKnotSpacing σ) rounded
/// The sum runs over the kKernelTaps nearest j, with j modulo m, and is divided by the root of its own variance. So the
/// variance is exact for every α, the loop over T has no seam, and every t has the same cost. No lattice of κ is
/// stored: z_j is a hash of (mode, j). The correlation equals that of a sum over a lattice of κ to kEvolutionError when
/// m >= 8. The rounding of m makes the decorrelation time of the slowest modes wrong by up to 1/(2m). Modes that
/// outlive the loop are frozen, and for α → 0 all of them are.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "noise/math/periodic_spline2.h"
#include "noise/turbulence/parameters/spectrum.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {

inline constexpr double kKnotSpacing = 1.25;
inline constexpr int kKernelTaps = 8;
/// Absolute error of a mode's correlation against exp(-αk²t²/4) with σ = T/(kKnotSpacing m).
inline constexpr double kEvolutionError = 6e-3;
/// A mode takes at most this many times nt independent values in a loop. Values that are T/nt apart are then
/// independent at large α.
inline constexpr int kStatesPerSample = 4;

/// The lattice of one band, and the modes that it holds.
struct BandGeometry {
    int nx, ny;        ///< lattice, >= 8
    double Lx, Ly, T;  ///< period [m, s] > 0
    int nt;            ///< time samples a loop >= 1
    int highest;       ///< the band holds only modes of index |i|, |j| <= highest and < n/2
    double thickness;  ///< δ of the slab [m] > 0
    double aperture;   ///< A [m] >= 0
    bool integrate;    ///< integrate over cells (von Kármán), else sample at their centres (the paper's spectrum)
};

/// Immutable, thread-safe.
class ScreenBand {
  public:
    /// index: different for every band of every screen of a medium.
    ScreenBand(const TurbulenceSpec& spec, const Spectrum& spectrum, const BandGeometry& geometry, std::uint64_t index);

    /// Optical path ψ [m] at any finite time t [s]. A frozen band returns the same spline every time.
    std::shared_ptr<const PeriodicSpline2> at(double t) const;
    /// The spectrum of ψ at time t: nx × (ny/2+1), half-complex.
    FftVector<complex32> spectrum_at(double t) const;

    const BandGeometry& geometry() const { return geometry_; }
    /// Discrete expectations of the variance of ∂ψ/∂x, of ∂ψ/∂y, and of ∂²ψ/∂x² [1/m²].
    double slope_variance_x() const { return slope_x_; }
    double slope_variance_y() const { return slope_y_; }
    double curvature_variance() const { return curvature_; }

    /// Bytes that a band of this geometry holds, with the most that at() needs.
    static double bytes(const BandGeometry& geometry);

  private:
    std::size_t half() const { return static_cast<std::size_t>(geometry_.ny / 2 + 1); }

    BandGeometry geometry_;
    // For each stored mode, row-major: amplitude, number of states in the loop, and two words of hash key.
    std::vector<float> amplitude_;
    std::vector<std::int32_t> states_;
    std::vector<std::uint32_t> key_a_, key_b_;
    std::shared_ptr<const SplinePlan2> plan_;
    std::shared_ptr<const PeriodicSpline2> frozen_;
    double slope_x_ = 0, slope_y_ = 0, curvature_ = 0;
};

}  // namespace eikonal
