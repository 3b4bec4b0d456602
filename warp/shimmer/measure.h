/// The time, size and error of a shot's frames, measured on one frame before any is made.
#pragma once

#include <optional>

#include "warp/resample/resample.h"
#include "warp/shimmer/shot.h"

namespace eikonal {

inline constexpr int kMeasuredRows = 64;  ///< rows of the picture that are resampled

/// Wall time of a whole picture on this machine at this moment [s]; the size and the stated error of its map.
struct FrameMeasure {
    double instant = 0, map = 0, resample = 0;
    MapStatistics size;
    std::optional<StatedError> error;
};

/// Measures a frame on the display window, without matte and shutter. depth: of the pixels of that window. filter: of
/// the picture, whose middle rows are resampled; nothing if there is no picture.
FrameMeasure measure_frame(const Shot& shot, double frame, const SharedDepth& depth, std::optional<Filter> filter);

}  // namespace eikonal
