/// The rays that an aperture of some width gathers.
#pragma once

#include <glm/vec2.hpp>
#include <vector>

namespace eikonal {

/// Points of equal weight on the unit disc (Vogel's spiral), the more the wider the aperture is beside `cell`, the
/// finest feature that it averages over [m]; one point, the centre, for a point aperture (0).
std::vector<glm::dvec2> aperture_points(double aperture, double cell);

}  // namespace eikonal
