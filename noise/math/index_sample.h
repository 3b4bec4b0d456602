/// The refractive index above ambient at one point, with its derivatives: what every medium returns.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace eikonal {

/// |n - n_ambient| below this part of a medium's own largest value counts as zero. It decides where a medium ends.
inline constexpr double kNegligibleIndex = 1e-16;

/// Index above ambient (dimensionless) and its gradient [1/m], world axes.
struct IndexSample {
    double n = 0;
    glm::dvec3 gradient{0, 0, 0};
};

/// The index with its gradient [1/m] and its second derivatives ∂²n/∂x_i∂x_j [1/m²], which are symmetric.
struct IndexJet {
    double n = 0;
    glm::dvec3 gradient{0, 0, 0};
    glm::dmat3 hessian{0};
};

}  // namespace eikonal
