/// Refractive index of air from temperature and wavelength, and the dispersion that follows from it
/// (PHYSICS.md#refractivity).
///
///     (n - 1)/(n0 - 1) = T0/T   at constant pressure (Eq. 3)
///     paper: n0 = 1.00023, T0 = 273 K (*paper*).   air: Ciddor's n at 15 °C, T0 = 288.15 K (*added*, the default).
///
/// Only n - 1 is stored, never n. Range: T > 0 [K]; wavelengths 0.3 … 1.7 µm.
#pragma once

#include "noise/medium/optics.h"

namespace eikonal {

/// Range of the temperatures that scenes may state [K]. Hotter air is plasma, and colder air is solid.
inline constexpr double kLeastTemperature = 1, kGreatestTemperature = 1e9;

/// Wavelengths that stand for the three colour channels [µm].
inline constexpr double kRedWavelength = 0.65, kGreenWavelength = 0.55, kBlueWavelength = 0.45;

/// n - 1 of dry air at 15 °C and 101325 Pa by Ciddor (1996), *added*; lambda in µm, 0.3 … 1.7.
constexpr double ciddor_refractivity(double lambda) {
    const double inverse2 = 1 / (lambda * lambda);
    return 0.05792105 / (238.0185 - inverse2) + 0.00167917 / (57.362 - inverse2);
}

/// Displacement of a channel relative to green. It is (n - 1)/(n_550 - 1), with its difference from 1 multiplied by
/// `dispersion` (0 off, 1 as in real air).
constexpr double dispersion_scale(double lambda, double dispersion) {
    return 1 + dispersion * (ciddor_refractivity(lambda) / ciddor_refractivity(kGreenWavelength) - 1);
}

/// n - 1 as a function of temperature, without exaggeration.
struct IndexLaw {
    double refractivity;         ///< n0 - 1
    double T0;                   ///< [K]
    double ambient_temperature;  ///< T_a [K]

    /// n - 1 at T.
    constexpr double at(double T) const { return refractivity * (T0 / T); }
    constexpr double ambient() const { return at(ambient_temperature); }
    /// n(T) - n_ambient, computed without cancellation. It is negative for hot air.
    constexpr double above_ambient(double T) const {
        return refractivity * (T0 / T) * ((ambient_temperature - T) / ambient_temperature);
    }
};

/// lambda [µm] matters for IndexModel::Air only.
constexpr IndexLaw index_law(const OpticsSpec& optics, double lambda = kGreenWavelength) {
    if (optics.index == IndexModel::Paper) return {0.00023, 273, optics.ambient_temperature};
    return {ciddor_refractivity(lambda), 288.15, optics.ambient_temperature};
}

}  // namespace eikonal
