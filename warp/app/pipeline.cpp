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

namespace {

/// One run: its three stages, what they share, and what becomes of the frames.
class Run {
  public:
    Run(const Stages& stages, const RunOptions& options, std::size_t total, const std::stop_token& stop)
        : stages_(stages),
          options_(options),
          stop_(stop),
          progress_(options.progress, total, total == 1 ? "frame" : "frames") {}

    /// The next frame, or null at the end. Called in order, one at a time.
    FrameItem* take(tbb::flow_control& flow);
    /// Called in parallel.
    FrameItem* work(FrameItem* item);
    /// Called in order, one at a time.
    void finish(FrameItem* raw);
    RunResult result() {
        result_.interrupted = cut_short_;
        return std::move(result_);
    }

  private:
    void tell_remarks(const FrameRecord& record);
    void tell_failure(const FrameItem& item);

    const Stages& stages_;
    const RunOptions& options_;
    const std::stop_token& stop_;
    Progress progress_;
    RunResult result_;
    std::atomic<bool> enough_{false};     ///< no further frame is begun
    std::atomic<bool> cut_short_{false};  ///< by the user
    bool broken_ = false;                 ///< a movie cannot go on after a frame that it lacks
    std::set<std::string_view> told_;     ///< what remarks were about
};

FrameItem* Run::take(tbb::flow_control& flow) {
    if (stop_.stop_requested()) cut_short_ = true;
    if (enough_ || cut_short_) {
        flow.stop();
        return nullptr;
    }
    std::unique_ptr<FrameItem> item;
    FrameRecord failure;
    guarded(failure, [&] { item = stages_.take(); });
    if (!failure.error.empty()) {
        item = std::make_unique<FrameItem>();
        item->record = failure;
        item->following = stages_.failing();
        item->record.frame = item->following.front();
        item->following.erase(item->following.begin());
        if (!options_.skip_bad_frames) enough_ = true;
    }
    if (!item) flow.stop();
    return item.release();
}

FrameItem* Run::work(FrameItem* item) {
    const auto start = std::chrono::steady_clock::now();
    // Isolated: a thread that waits for its frame's rows must not begin another frame meanwhile.
    if (item->record.error.empty())
        tbb::this_task_arena::isolate([&] {
            guarded(item->record, [&] {
                check_stop(stop_);
                stages_.work(*item);
            });
        });
    if (!item->record.error.empty() && !options_.skip_bad_frames) enough_ = true;
    item->record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return item;
}

void Run::tell_remarks(const FrameRecord& record) {
    for (const Remark& remark : record.remarks) {
        if (!told_.insert(remark.about).second || !(remark.warning || options_.verbose)) continue;
        const std::string text = with_options(remark.text);
        progress_.line(fmt::format("eikonal: {}{}", remark.warning ? "warning: " : "", text));
        if (remark.warning) result_.warnings.push_back(text);
    }
}

void Run::tell_failure(const FrameItem& item) {
    const std::string which = item.following.empty()
                                  ? fmt::format("frame {}", item.record.frame)
                                  : fmt::format("frames {}-{}", item.record.frame, item.following.back());
    progress_.line(fmt::format("eikonal: {}: {}", which, item.record.error));
    if (!options_.skip_bad_frames) enough_ = broken_ = true;
}

void Run::finish(FrameItem* raw) {
    const std::unique_ptr<FrameItem> item(raw);
    FrameRecord& record = item->record;
    if (stop_.stop_requested() && record.error == kStopped) {
        cut_short_ = true;
        return;
    }
    tell_remarks(record);
    const bool lost = broken_ && record.error.empty() && stages_.in_one_file;
    if (lost)
        record.error = "not written, because an earlier frame failed";
    else if (record.error.empty() && !broken_)
        guarded(record, [&] { stages_.finish(*item); });
    if (!record.error.empty() && !lost) tell_failure(*item);
    result_.records.push_back(record);
    progress_.step(record.error.empty());
    for (const int frame : item->following) {
        result_.records.push_back(record);
        result_.records.back().frame = frame;
        progress_.step(false);
    }
}

}  // namespace

RunResult run_pipeline(const Stages& stages, const RunOptions& options, std::size_t total, int threads,
                       double frame_bytes, const std::stop_token& stop) {
    const auto memory = static_cast<double>(memory_limit());
    if (frame_bytes > memory)
        throw UserError(
            fmt::format("a frame of this size needs {:.3g} GB of memory, {:.3g} GB are available; use smaller pictures",
                        frame_bytes / 1e9, memory / 1e9));
    const auto in_flight =
        static_cast<std::size_t>(std::clamp(memory / std::max(frame_bytes, 1.0), 1.0, double(threads + kFramesAhead)));
    Run run(stages, options, total, stop);
    tbb::parallel_pipeline(
        in_flight, tbb::make_filter<void, FrameItem*>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& flow) {
                       return run.take(flow);
                   }) & tbb::make_filter<FrameItem*, FrameItem*>(tbb::filter_mode::parallel, [&](FrameItem* item) {
                       return run.work(item);
                   }) & tbb::make_filter<FrameItem*, void>(tbb::filter_mode::serial_in_order, [&](FrameItem* item) {
                       run.finish(item);
                   }));
    return run.result();
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
