/// How many steps first-order rays take through cells of a given size: too many are refused, many are warned of.
#pragma once

#include <string>

#include "warp/displace/media/medium_bend.h"

namespace eikonal {

/// Cells [m] that the picture's most oblique ray crosses a metre of depth.
double cells_a_metre(const ShotContext& shot, const Camera& camera, const dvec3& cell);

/// A warning that frames take long, or nothing. medium: "medium.2". UserError for more than kMostFirstOrderSteps.
std::string check_steps(const ShotContext& shot, const std::string& medium, const dvec3& cell);

/// FrameError if those of a frame's camera and depth are too many.
void check_frame_steps(const ShotContext& shot, const std::string& medium, const dvec3& cell, const Camera& camera,
                       double farthest);

/// A line on rays as far as `farthest` [m] that take long, or nothing.
std::string many_steps_beyond(const ShotContext& shot, const std::string& medium, const dvec3& cell, double farthest,
                              Model model);

}  // namespace eikonal
