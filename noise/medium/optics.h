/// [optics] of a scene: the properties of all media together, and of the lens. Plain data in SI units. Each default is
/// that of an omitted key.
#pragma once

#include <vector>

namespace eikonal {

/// Physical: F = n∇n (*corrected*). Paper: F = ½∇n (*paper*). PHYSICS.md#ray-equation
enum class RayEquation { Physical, Paper };
/// The dependence of the index on temperature: noise/medium/refractivity.h
enum class IndexModel { Air, Paper };

class Key;

struct OpticsSpec {
    RayEquation ray_equation = RayEquation::Physical;
    double ambient_temperature = 293.15;  ///< [K] > 0
    IndexModel index = IndexModel::Air;
    double exaggeration = 1;  ///< factor on n - n_ambient
    double aperture = 0;      ///< diameter [m] >= 0; 0 is a point aperture
};

/// The keys of its table.
std::vector<Key> keys(OpticsSpec& optics);

/// The factor on ∇n in first-order displacement: the exaggeration, and half of it in the paper's convention.
inline double force_strength(const OpticsSpec& optics) {
    return optics.exaggeration * (optics.ray_equation == RayEquation::Paper ? 0.5 : 1.0);
}

}  // namespace eikonal
