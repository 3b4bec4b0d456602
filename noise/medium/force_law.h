/// The force on rays that follows from the index of the air. PHYSICS.md#ray-equation
///     physical:  F = n∇n,  |dx/du| = n       (*corrected*)
///     paper:     F = ½∇n,  |dx/du| = √n      (*paper*: its "n" is the index squared)
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>

#include "noise/medium/optics.h"

namespace eikonal {

struct ForceLaw {
    RayEquation equation = RayEquation::Physical;
    double ambient = 0;  ///< n_ambient - 1
    double exaggeration = 1;

    /// The factor on ∇(n_i - n_ambient) of a medium where n is near 1.
    double strength() const { return exaggeration * (equation == RayEquation::Paper ? 0.5 : 1); }
    /// |dx/du| where the index is 1 + n; 0 where the index is not positive (n <= -1).
    double speed(double n) const {
        const double index = std::max(0.0, 1 + n);
        return equation == RayEquation::Paper ? std::sqrt(index) : index;
    }
};

/// A first-order bend ∫ (D - w) F dw of a straight ray [m].
struct StraightBend {
    glm::dvec3 value{0, 0, 0};
    double error = 0;  ///< relative error by the second order: bound of |n - n_ambient| along the ray
};

}  // namespace eikonal
