/// A displacement of one pixel.
#pragma once

namespace eikonal {

/// Displacement vector in pixels: x right, y down.
struct Shift {
    float x = 0, y = 0;
};

}  // namespace eikonal
