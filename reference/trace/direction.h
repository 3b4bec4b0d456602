/// Axes across a direction, and directions as places on a latitude-longitude picture, with the same bits on every
/// processor (noise/math/portable_math.h).
///
/// Convention: the middle of the picture lies along -z, u grows to the right (+x), v up (+y); u and v in [0, 1].
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

namespace eikonal::reference {

/// Maximal error of angle_turns, absolute, in turns (checked by tests/reference_test.cpp).
inline constexpr double kAngleError = 1e-13;

/// atan2(y, x) / 2π in [-0.5, 0.5]; 0 for (0, 0).
double angle_turns(double y, double x);

/// Unit vectors with right x up = normal (of unit length). `up` follows `hint` as far as it can; without one, +y, or -z
/// where the normal is vertical.
void perpendicular_axes(glm::dvec3 normal, const std::optional<glm::dvec3>& hint, glm::dvec3& right, glm::dvec3& up);

/// u, v of a direction of any length.
glm::dvec2 latitude_longitude(glm::dvec3 direction);

}  // namespace eikonal::reference
