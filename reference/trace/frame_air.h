/// What every ray of one frame needs: the air at that instant, and the light that has passed through it. Private to
/// Renderer.
#pragma once

#include <optional>

#include "reference/trace/render.h"

namespace eikonal::reference {

struct Renderer::FrameAir {
    AirInstant field;
    TraceSettings trace;
    std::optional<Shadowgraph> sunlight;
    std::optional<double> background;  ///< axial depth at which u and v see the background [m]
};

}  // namespace eikonal::reference
