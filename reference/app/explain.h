/// `render --explain`: what frames need, before any is rendered. Nothing is written.
///
/// Displacement, steps, error and time are of a probe (ProbeLimits in render.h): pixels spread over the first frame, as
/// many as kExplainedSeconds suffice for, up to kMostExplained. So it takes seconds whatever the scene: rays that do
/// not end within the probe's steps are counted, and taken to go on, at what the air ahead costs, to where the straight
/// ones end, or to their budget. Displacement and error are of the rays that came to an end, or said to be unknown. The
/// times are this machine's, now; memory is what the process has come to hold, and what a frame's planes take.
#pragma once

#include <vector>

#include "reference/trace/render.h"

namespace eikonal::reference {

inline constexpr double kExplainedSeconds = 2;
inline constexpr int kMostExplained = 8192, kExplainedSamples = 16, kExplainedSteps = 20000;

/// Prints it on stdout. threads: in use. FrameError as Renderer::render.
void explain(const Renderer& renderer, const Scene& scene, const RenderSettings& settings,
             const std::vector<int>& frames, int threads);

}  // namespace eikonal::reference
