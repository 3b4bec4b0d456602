/// `render --explain`: what frames need, before any is rendered. Nothing is written.
///
/// Displacement, steps, error and time are of a probe: about kExplainedTiles tiles, spread over the first frame. The
/// times are this machine's, now; memory is what the process has come to hold, and what a frame's planes take.
#pragma once

#include <vector>

#include "reference/render.h"

namespace eikonal::reference {

inline constexpr int kExplainedTiles = 8;

/// Prints it on stdout. threads: in use. FrameError as Renderer::render.
void explain(const Renderer& renderer, const Scene& scene, const RenderSettings& settings,
             const std::vector<int>& frames, int threads);

}  // namespace eikonal::reference
