/// What every field of refractive index returns at a point: n - n_ambient and its gradient.
#pragma once

#include <glm/vec3.hpp>

namespace eikonal {

/// Index above ambient (dimensionless) and its gradient [1/m], world axes.
struct IndexSample {
    double n = 0;
    glm::dvec3 gradient{0, 0, 0};
};

}  // namespace eikonal
