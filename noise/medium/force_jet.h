/// The force on a ray, and its derivatives, for media whose force depends on the ray's direction.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace eikonal {

using glm::dvec3;

/// F and its derivatives with respect to the ray's position and direction.
struct ForceJet {
    dvec3 force{0, 0, 0};
    glm::dmat3 by_position{0};   ///< ∂F_i/∂x_j at [j][i]
    glm::dmat3 by_direction{0};  ///< ∂F_i/∂p_j at [j][i]: nonzero for thin screens only
};

}  // namespace eikonal
