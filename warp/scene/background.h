/// Where a scene's background is: what a depth map calls infinite, and what no object hides.
///
/// Air without bounds bends rays on all their way, so the background needs a distance. Over a heated surface it lies
/// behind all that is in sight: a mirage shows what is far, and a sky that stood before the ground's horizon would have
/// mirrored rays end on the ground beneath it.
#pragma once

#include <vector>

#include "warp/pixels/depth_range.h"
#include "warp/scene/scene.h"

namespace eikonal {

/// Distance of the background where nothing states it and surfaces are all that bends, for which no distance costs
/// anything [m].
inline constexpr double kDefaultSky = 1e6;

/// Whether there is a surface that is not at ambient temperature.
bool has_mirage(const Scene& scene);

/// kDefaultFar, or kDefaultSky for a scene of surfaces only.
double default_far(const Scene& scene);

/// Where a map's finite depths go on behind its background, which is at `far`, puts that at the farthest of them [m].
void put_background_behind(std::vector<float>& metres, double far);

}  // namespace eikonal
