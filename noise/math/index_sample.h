/// What every field of refractive index returns at a point: n - n_ambient and its derivatives.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace eikonal {

/// n - n_ambient of a medium below this is nothing: what bounds are drawn by, in parts of its own largest.
inline constexpr double kNegligibleIndex = 1e-16;

/// Index above ambient (dimensionless) and its gradient [1/m], world axes.
struct IndexSample {
    double n = 0;
    glm::dvec3 gradient{0, 0, 0};
};

/// The same with the second derivatives ∂²n/∂x_i∂x_j [1/m²], symmetric.
struct IndexJet {
    double n = 0;
    glm::dvec3 gradient{0, 0, 0};
    glm::dmat3 hessian{0};
};

}  // namespace eikonal
