/// What a frame of a shot will cost and be, measured on one frame: for previews of a run, before anything is made.
#pragma once

#include <optional>

#include "warp/resample/resample.h"
#include "warp/shimmer/shot.h"

namespace eikonal {

inline constexpr int kMeasuredRows = 64;  ///< of the picture, resampled

/// Wall time of this machine, now, of a whole picture [s]; the size and the stated error of its map.
struct FrameMeasure {
    double instant = 0, map = 0, resample = 0;
    MapStatistics size;
    std::optional<StatedError> error;
};

/// Measures a frame on the display window, without matte and shutter. depth: of those pixels. filter: of the picture,
/// of which the middle rows are resampled; nothing: there is none.
FrameMeasure measure_frame(const Shot& shot, double frame, const SharedDepth& depth, std::optional<Filter> filter);

}  // namespace eikonal
