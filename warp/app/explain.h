/// --explain: what a shot needs, before anything is made. Nothing is written.
///
/// Displacement and focusing before any falloff are expectations of the scene. Displacement, error and time of a frame
/// are those of the first one's map, which is made with the depth and for the pixels that it will have, but without
/// mask and shutter; the picture's time is of its middle rows. The times are this machine's, now; reading and writing
/// files come on top.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "warp/resample/resample.h"
#include "warp/shimmer/footage_shot.h"

namespace eikonal {

/// What the explained command would do with the maps.
struct ExplainedRun {
    PixelWindow display;
    std::vector<int> frames;        ///< not yet finished; empty: as many as a movie has
    int first = 1;                  ///< of all frames, finished or not: the one that is tried
    std::filesystem::path picture;  ///< its file, whose channel depth may be; empty: none
    std::size_t kept = 0;
    int threads = 1;
    double frame_bytes = 0;          ///< as run_pipeline's
    std::optional<Filter> resample;  ///< of the picture; none for `map`
    int instants = 1;                ///< maps a frame: shutter samples
};

/// Prints it on stdout. FrameError if the first frame's depth cannot be read.
void explain(const FootageShot& shot, const ExplainedRun& run);

}  // namespace eikonal
