#include "warp/app/pipeline.h"

#include <fmt/format.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <set>

#include "noise/base/error.h"
#include "noise/base/memory.h"
#include "warp/app/progress.h"
#include "warp/displace/displacer.h"
#include "warp/program/option_names.h"

namespace eikonal {
namespace {

/// Runs a stage. If it throws, the message becomes the frame's error.
template <class Stage>
void guarded(FrameRecord& record, Stage&& stage) {
    try {
        stage();
    } catch (const FrameError& error) {
        record.error = with_options(error.what());
    } catch (const UserError& error) {
        record.error = with_options(error.what());
    } catch (const std::bad_alloc&) {
        record.error = "not enough memory";
    } catch (const std::exception& error) {
        record.error = fmt::format("internal error, please report it: {}", error.what());
    }
}

}  // namespace

bool RunResult::failed() const {
    return interrupted ||
           std::any_of(records.begin(), records.end(), [](const FrameRecord& r) { return !r.error.empty(); });
}

RunResult run_pipeline(const Stages& stages, const RunOptions& options, std::size_t total, int threads,
                       double frame_bytes, const std::stop_token& stop) {
    const auto memory = static_cast<double>(memory_limit());
    if (frame_bytes > memory)
        throw UserError(
            fmt::format("a frame of this size needs {:.3g} GB of memory, {:.3g} GB are available; use smaller pictures",
                        frame_bytes / 1e9, memory / 1e9));
    const auto in_flight =
        static_cast<std::size_t>(std::clamp(memory / std::max(frame_bytes, 1.0), 1.0, double(threads + kFramesAhead)));
    RunResult result;
    Progress progress(options.progress, total, total == 1 ? "frame" : "frames");
    std::atomic<bool> enough{false}, cut_short{false};
    const auto take = [&](tbb::flow_control& flow) -> FrameItem* {
        if (stop.stop_requested()) cut_short = true;
        if (enough || cut_short) {
            flow.stop();
            return nullptr;
        }
        std::unique_ptr<FrameItem> item;
        FrameRecord failure;
        guarded(failure, [&] { item = stages.take(); });
        if (!failure.error.empty()) {
            item = std::make_unique<FrameItem>();
            item->record = failure;
            item->following = stages.failing();
            item->record.frame = item->following.front();
            item->following.erase(item->following.begin());
            if (!options.skip_bad_frames) enough = true;
        }
        if (!item) flow.stop();
        return item.release();
    };
    const auto work = [&](FrameItem* item) {
        const auto start = std::chrono::steady_clock::now();
        // Isolated, so that a thread that waits for rows of its frame does not begin another frame meanwhile.
        if (item->record.error.empty())
            tbb::this_task_arena::isolate([&] {
                guarded(item->record, [&] {
                    check_stop(stop);
                    stages.work(*item);
                });
            });
        if (!item->record.error.empty() && !options.skip_bad_frames) enough = true;
        item->record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        return item;
    };
    std::set<std::string_view> told;
    bool broken = false;  // true after a failed frame of a movie: the movie cannot go on without it
    const auto finish = [&](FrameItem* raw) {
        const std::unique_ptr<FrameItem> item(raw);
        FrameRecord& record = item->record;
        if (stop.stop_requested() && record.error == kStopped) {
            cut_short = true;
            return;
        }
        for (const Remark& remark : record.remarks) {
            if (!told.insert(remark.about).second || !(remark.warning || options.verbose)) continue;
            const std::string text = with_options(remark.text);
            progress.line(fmt::format("eikonal: {}{}", remark.warning ? "warning: " : "", text));
            if (remark.warning) result.warnings.push_back(text);
        }
        const bool lost = broken && record.error.empty() && stages.in_one_file;
        if (lost)
            record.error = "not written, because an earlier frame failed";
        else if (record.error.empty() && !broken)
            guarded(record, [&] { stages.finish(*item); });
        if (!record.error.empty() && !lost) {
            const std::string which = item->following.empty()
                                          ? fmt::format("frame {}", record.frame)
                                          : fmt::format("frames {}-{}", record.frame, item->following.back());
            progress.line(fmt::format("eikonal: {}: {}", which, record.error));
            if (!options.skip_bad_frames) enough = broken = true;
        }
        result.records.push_back(record);
        progress.step(record.error.empty());
        for (const int frame : item->following) {
            result.records.push_back(record);
            result.records.back().frame = frame;
            progress.step(false);
        }
    };
    tbb::parallel_pipeline(in_flight,
                           tbb::make_filter<void, FrameItem*>(tbb::filter_mode::serial_in_order, take) &
                               tbb::make_filter<FrameItem*, FrameItem*>(tbb::filter_mode::parallel, work) &
                               tbb::make_filter<FrameItem*, void>(tbb::filter_mode::serial_in_order, finish));
    result.interrupted = cut_short;
    return result;
}

void print_outcome(const RunResult& result, const RunOptions& options, std::size_t total, const std::string& rest) {
    const auto bad = static_cast<std::size_t>(std::count_if(result.records.begin(), result.records.end(),
                                                            [](const FrameRecord& r) { return !r.error.empty(); }));
    const std::size_t written = result.records.size() - bad;
    total = std::max(total, result.records.size());  // the stated length of a movie may be too small
    if (result.interrupted)
        fmt::print(stderr, "eikonal: interrupted after {} of {} frames; {}\n", written, total, rest);
    else if (bad > 0 && total > 1)
        fmt::print(stderr, "eikonal: {} of {} frames done; {}\n", written, total,
                   options.skip_bad_frames ? "the bad ones were skipped"
                                           : rest + "; --skip-bad-frames passes over bad frames");
}

}  // namespace eikonal
