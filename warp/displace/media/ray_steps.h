/// The number of steps that first-order rays take through cells of a given size. A scene with too many steps is
/// refused. One with many steps causes a warning.
#pragma once

#include <string>

#include "warp/displace/media/medium_bend.h"

namespace eikonal {

/// Number of cells [m] per metre of depth that the picture's most oblique ray crosses.
double cells_a_metre(const ShotContext& shot, const Camera& camera, const dvec3& cell);

/// A warning that frames take long, or an empty text. medium: "medium.2". UserError if a ray needs more than
/// kMostFirstOrderSteps.
std::string check_steps(const ShotContext& shot, const std::string& medium, const dvec3& cell);

/// FrameError if the camera and depth of a frame need too many steps.
void check_frame_steps(const ShotContext& shot, const std::string& medium, const dvec3& cell, const Camera& camera,
                       double farthest);

/// One line if rays as far as `farthest` [m] take long, else an empty text.
std::string many_steps_beyond(const ShotContext& shot, const std::string& medium, const dvec3& cell, double farthest,
                              Model model);

}  // namespace eikonal
