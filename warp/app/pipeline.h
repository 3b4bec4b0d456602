/// Frames through a bounded pipeline: taken in order, worked on in parallel, finished in order. Reading, warping and
/// writing of different frames overlap; no more than kFramesAhead frames beyond the number of threads are in memory,
/// fewer where they are so large that memory_limit() does not hold them.
///
/// A frame that fails is reported as "frame F: reason" and the others go on or, unless skip_bad_frames, no more are
/// begun. A requested stop ends the run and gives up the frames under way. Nothing already finished is lost either way.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "warp/app/options.h"
#include "warp/displace/displacer.h"
#include "warp/image/plane.h"

namespace eikonal {

inline constexpr int kFramesAhead = 1;

/// What became of one frame.
struct FrameRecord {
    int frame = 0;
    std::string error;            ///< empty: written
    double rms = 0, largest = 0;  ///< displacement [px]
    std::optional<StatedError> stated;
    double seconds = 0;           ///< of work
    std::vector<Remark> remarks;  ///< on its files
};

struct RunResult {
    std::vector<FrameRecord> records;  ///< in order
    bool interrupted = false;
    std::vector<std::string> warnings;  ///< on the frames and their files, told once each
    bool failed() const;
};

/// The three stages. `Item` is a frame on its way, owned by the pipeline.
struct FrameItem {
    virtual ~FrameItem() = default;
    FrameRecord record;
    std::vector<int> following;  ///< further frames that fail with it, for the same reason
};
struct Stages {
    /// In order, one at a time: makes the next frame's item, with its record's frame set; null at the end. May throw
    /// FrameError, which counts against the frames that `failing` then names.
    std::function<std::unique_ptr<FrameItem>()> take;
    std::function<std::vector<int>()> failing;
    /// In parallel. May throw.
    std::function<void(FrameItem&)> work;
    /// In order, one at a time; not called for failed frames. May throw.
    std::function<void(FrameItem&)> finish;
    bool in_one_file = false;  ///< a movie: a frame after a failed one is not written either
};

/// frame_bytes: of memory that one frame takes on its way, about. UserError: more than there is.
RunResult run_pipeline(const Stages& stages, const RunOptions& options, std::size_t total, int threads,
                       double frame_bytes, const std::stop_token& stop);

/// Tells on stderr how a run ended that did not make all frames. `rest`: what becomes of them.
void print_outcome(const RunResult& result, const RunOptions& options, std::size_t total, const std::string& rest);

}  // namespace eikonal
