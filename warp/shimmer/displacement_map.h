/// A displacement map in memory, and its size.
#pragma once

#include <vector>

#include "warp/pixels/linear_image.h"

namespace eikonal {

/// Displacement on a window: interleaved (u, v) in pixels.
struct DisplacementMap {
    PixelWindow window;
    std::vector<float> uv;  ///< 2 * window.area()
};

struct MapStatistics {
    double rms = 0, largest = 0;  ///< rms and largest value of |d| [px]
};
MapStatistics statistics(const DisplacementMap& map);

}  // namespace eikonal
