/// --explain: what a shot needs, before anything is made. Nothing is written.
///
/// Displacement and focusing are expectations of the scene; error, time and memory are of a probe: the middle tile row
/// of the first frame's map, kExplainRows pixels high, for objects at the shot's distance or, where depth varies, at
/// distances from far/8 to far across the picture. The times are this machine's, now; reading and writing files come on
/// top.
#pragma once

#include <cstddef>
#include <vector>

#include "warp/app/shot.h"

namespace eikonal {

inline constexpr int kExplainRows = 64;

/// What the explained command would do with the maps.
struct ExplainedRun {
    PixelWindow display;
    std::vector<int> frames;  ///< not yet finished; empty: as many as a movie has
    std::size_t kept = 0;
    int threads = 1;
    double frame_bytes = 0;          ///< as run_pipeline's
    std::optional<Filter> resample;  ///< of the picture; none for `map`
    int instants = 1;                ///< maps a frame: shutter samples
};

/// Prints it on stdout.
void explain(const Shot& shot, const ExplainedRun& run);

}  // namespace eikonal
