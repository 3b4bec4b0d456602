/// The rays that pass through an aperture.
#pragma once

#include <glm/vec2.hpp>
#include <vector>

namespace eikonal {

/// Points of equal weight on the unit disc (Vogel's spiral). Their number grows with the width of the aperture relative
/// to `cell`, the finest feature that it averages over [m]. A point aperture (0) has one point, the centre.
std::vector<glm::dvec2> aperture_points(double aperture, double cell);

}  // namespace eikonal
