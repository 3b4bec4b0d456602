/// --explain: reports what a shot needs, before any frame is made. Nothing is written.
///
/// The expected displacement and focusing follow from the scene, before any falloff. The displacement, error and time
/// of a frame are measured on the map of the first frame. That map has the frame's depth and pixels, but no mask and no
/// shutter. The time of the picture is measured on its middle rows. All times are of this machine at this moment.
/// Reading and writing files take time in addition.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "warp/resample/resample.h"
#include "warp/shimmer/footage_shot.h"

namespace eikonal {

/// What the explained command would do with its maps.
struct ExplainedRun {
    PixelWindow display;
    std::vector<int> frames;        ///< frames that are not finished yet; empty: as many as a movie has
    int first = 1;                  ///< the frame that is measured: the first of all, finished or not
    std::filesystem::path picture;  ///< file of its picture, in which depth may be a channel; empty: none
    std::size_t kept = 0;
    int threads = 1;
    double frame_bytes = 0;          ///< as for run_pipeline
    std::optional<Filter> resample;  ///< filter of the picture; none for `map`
    int instants = 1;                ///< maps per frame: the number of shutter samples
};

/// Prints the report on stdout. FrameError if the first frame's depth cannot be read.
void explain(const FootageShot& shot, const ExplainedRun& run);

}  // namespace eikonal
