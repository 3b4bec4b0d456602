#include "noise/turbulence/parameters/spectrum.h"

#include "noise/math/portable_math.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {

Spectrum::Spectrum(const TurbulenceSpec& spec, double lowest) : kind_(spec.spectrum), lowest2_(lowest * lowest) {
    const double k0 = portable::kTwoPi / spec.outer_scale;
    const double km = kInnerScaleConstant / spec.inner_scale;
    k02_ = k0 * k0;
    inv_km2_ = 1 / (km * km);
    scale_ = kind_ == SpectrumKind::VonKarman ? kKolmogorovConstant * spec.cn2 : spec.strength;
}

double Spectrum::operator()(double k2) const {
    if (kind_ == SpectrumKind::VonKarman)
        return scale_ * portable::exp(-k2 * inv_km2_ - (11.0 / 6) * portable::log(k2 + k02_));
    if (k2 <= 0 || k2 < lowest2_ * (1 - 1e-12)) return 0;
    return scale_ * portable::exp(-(11.0 / 6) * portable::log(k2));
}

double temporal_weight(double kappa, double alpha, double k2) {
    const double width2 = alpha * k2;
    if (!(width2 > 0)) return kappa == 0 ? 1 : 0;
    return portable::exp(-kappa * kappa / width2);
}

}  // namespace eikonal
