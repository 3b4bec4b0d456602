/// Axes across a direction, and directions as places on a latitude-longitude picture.
///
/// The middle of the picture lies along -z. u grows to the right (+x) and v grows up (+y). u and v are in [0, 1]. The
/// bits are the same on every processor (noise/math/portable_math.h).
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

namespace eikonal::reference {

/// Largest absolute error of angle_turns [turns] (tests/reference/trace/straight_rays_test.cpp).
inline constexpr double kAngleError = 1e-13;

/// atan2(y, x) / 2π, in [-0.5, 0.5]. 0 for (0, 0).
double angle_turns(double y, double x);

/// Unit vectors with right x up = normal, which must have unit length. `up` is as near to `hint` as it can be. Without
/// a hint it is as near to +y, or to -z where the normal is vertical.
void perpendicular_axes(glm::dvec3 normal, const std::optional<glm::dvec3>& hint, glm::dvec3& right, glm::dvec3& up);

/// The place (u, v) of a direction of any length.
glm::dvec2 latitude_longitude(glm::dvec3 direction);

}  // namespace eikonal::reference
