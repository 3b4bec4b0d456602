/// A bounded pipeline of frames. Frames are taken in order, processed in parallel and finished in order, so that
/// reading, warping and writing overlap. At most kFramesAhead frames more than there are threads are in memory. There
/// are fewer if the frames are so large that memory_limit() does not hold them.
///
/// A frame that fails is reported as "frame F: reason". With skip_bad_frames the others go on, otherwise no more are
/// begun. A requested stop ends the run and gives up the frames in progress. In both cases finished frames are kept.
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

/// The result of one frame.
struct FrameRecord {
    int frame = 0;
    std::string error;            ///< empty if the frame was written
    double rms = 0, largest = 0;  ///< displacement [px]
    std::optional<StatedError> stated;
    double seconds = 0;           ///< time of its work
    std::vector<Remark> remarks;  ///< remarks on its files
};

struct RunResult {
    std::vector<FrameRecord> records;  ///< in the order of the frames
    bool interrupted = false;
    std::vector<std::string> warnings;  ///< about the frames and their files, each given once
    bool failed() const;
};

/// A frame in the pipeline, which owns it.
struct FrameItem {
    virtual ~FrameItem() = default;
    FrameRecord record;
    std::vector<int> following;  ///< further frames that fail with this one for the same reason
};
struct Stages {
    /// Makes the item of the next frame, with its record's frame set; null at the end. Called in order, one call at a
    /// time. May throw FrameError, which is then the error of the frames that `failing` names.
    std::function<std::unique_ptr<FrameItem>()> take;
    std::function<std::vector<int>()> failing;
    /// Computes the frame. Called in parallel. May throw.
    std::function<void(FrameItem&)> work;
    /// Writes the frame. Called in order, one call at a time, and not for failed frames. May throw.
    std::function<void(FrameItem&)> finish;
    bool in_one_file = false;  ///< true for a movie: no frame after a failed one is written
};

/// Runs the stages. frame_bytes: approximate memory of one frame in the pipeline [bytes]. UserError: a frame needs more
/// than there is.
RunResult run_pipeline(const Stages& stages, const RunOptions& options, std::size_t total, int threads,
                       double frame_bytes, const std::stop_token& stop);

/// Reports on stderr how a run ended that did not make all frames. `rest`: what will become of the others, in words.
void print_outcome(const RunResult& result, const RunOptions& options, std::size_t total, const std::string& rest);

}  // namespace eikonal
