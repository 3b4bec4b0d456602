/// Refractive index of air from wavelength, and the dispersion that follows from it (PHYSICS 2).
#pragma once

namespace eikonal {

/// Wavelengths that stand for the three colour channels [µm].
inline constexpr double kRedWavelength = 0.65, kGreenWavelength = 0.55, kBlueWavelength = 0.45;

/// n - 1 of dry air at 15 °C and 101325 Pa by Ciddor (1996), *added*; lambda in µm, 0.3 … 1.7.
constexpr double ciddor_refractivity(double lambda) {
    const double inverse2 = 1 / (lambda * lambda);
    return 0.05792105 / (238.0185 - inverse2) + 0.00167917 / (57.362 - inverse2);
}

/// Displacement of a channel relative to green: (n - 1)/(n_550 - 1), exaggerated about 1 by `dispersion` (0 off, 1 true).
constexpr double dispersion_scale(double lambda, double dispersion) {
    return 1 + dispersion * (ciddor_refractivity(lambda) / ciddor_refractivity(kGreenWavelength) - 1);
}

}  // namespace eikonal
