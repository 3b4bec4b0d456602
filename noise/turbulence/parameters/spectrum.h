/// Spatial and temporal power spectra of the refractive index (PHYSICS.md#turbulence). k is an angular wavenumber
/// [rad/m].
///
/// Normalisation: <n'²> = ∫ Φ(k) d³k. Lattice modes have the variance Φ dk³; compare a realisation with that discrete
/// sum, never with the continuum.
#pragma once

#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {

/// Φ(|k|) of one turbulent medium, ready for evaluation.
///
/// von Kármán, *added* (default): Φ = 0.0330054 Cn² (k² + k0²)^(-11/6) exp(-k²/km²), k0 = 2π/L0, km = 5.92/l0, so that
///     D_n(r) = Cn² r^(2/3) for l0 << r << L0.
/// paper: S(k) = C k^(-11/3) for k >= k_m, 0 below; the dissipation end is the lattice's Nyquist wavenumber.
class Spectrum {
  public:
    /// lowest: k_m in rad/m, used by the paper's spectrum only.
    Spectrum(const TurbulenceSpec& spec, double lowest);

    /// Φ(k) [m³] from k² [rad²/m²]. Finite for every k² >= 0 (0 at k = 0 for the paper's).
    double operator()(double k2) const;

  private:
    SpectrumKind kind_;
    double scale_, k02_, inv_km2_, lowest2_;
};

/// Cn² for which 0.0330054 is the Kolmogorov constant: Γ(8/3) sin(π/3) / (4π²).
inline constexpr double kKolmogorovConstant = 0.0330054;
/// km l0 of the modified von Kármán spectrum.
inline constexpr double kInnerScaleConstant = 5.92;

/// Temporal weight of angular frequency kappa [rad/s] for a spatial mode k² (before normalisation over the lattice of
/// κ): exp(-κ²/(α k²)), *corrected* (each spatial mode is normalised over κ, so that its variance is exact for every
/// α). α k² = 0: 1 at κ = 0, else 0 (frozen).
double temporal_weight(double kappa, double alpha, double k2);

}  // namespace eikonal
