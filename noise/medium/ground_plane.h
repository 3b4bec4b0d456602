/// A plane that bounds the air from below, and the height of a point above it.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace eikonal {

using glm::dvec3;

struct GroundPlane {
    dvec3 origin{0, 0, 0};
    dvec3 normal{0, 1, 0};  ///< of unit length

    double height(const dvec3& x) const { return glm::dot(x - origin, normal); }
};

}  // namespace eikonal
