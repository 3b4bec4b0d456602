/// `render --explain`: reports what frames need, before any is rendered. Nothing is written.
///
/// Displacement, steps, error and time are measured by a probe (ProbeLimits in render.h). The probe takes pixels spread
/// over the first frame, as many as fit into kExplainedSeconds, but at most kMostExplained. It therefore takes only
/// seconds in any scene.
///
/// Some rays do not end within the probe's steps. They are counted. Each is assumed to go on to where the straight ray
/// ends, at the cost of the air ahead, but no farther than its budget. Displacement and error are those of the rays
/// that ended. If none ended they are reported as unknown.
///
/// The times are of this machine at this moment. The memory is that of the process so far, and of a frame's planes.
#pragma once

#include <vector>

#include "reference/trace/render.h"

namespace eikonal::reference {

inline constexpr double kExplainedSeconds = 2;
inline constexpr int kMostExplained = 8192, kExplainedSamples = 16, kExplainedSteps = 20000;

/// Prints the report on stdout. threads: the number in use. FrameError as Renderer::render.
void explain(const Renderer& renderer, const Scene& scene, const RenderSettings& settings,
             const std::vector<int>& frames, int threads);

}  // namespace eikonal::reference
