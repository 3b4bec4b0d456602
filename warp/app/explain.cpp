#include "warp/app/explain.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>

#include "warp/app/footage.h"
#include "warp/app/pipeline.h"
#include "warp/app/shot_options.h"
#include "warp/displace/stated_error.h"
#include "warp/image/sequence.h"
#include "warp/shimmer/measure.h"

namespace eikonal {
namespace {

FrameMeasure measure(const FootageShot& shot, const ExplainedRun& run) {
    std::optional<Picture> picture;
    if (shot.depth().inside_picture() && !run.picture.empty()) picture = read_picture(run.picture);
    std::vector<Remark> remarks;
    const SharedDepth depth =
        shot.depth_of(run.first, {picture ? &*picture : nullptr, run.picture, {}}, run.display, remarks);
    return measure_frame(shot.shot(), run.first, depth, run.resample);
}

void explain_memory(const ExplainedRun& run) {
    const std::size_t at_a_time = static_cast<std::size_t>(run.threads + kFramesAhead),
                      frames = run.frames.empty() ? at_a_time : std::min(run.frames.size(), at_a_time);
    // The measured peak contains neither the frame's picture nor the warped one.
    const double pictures = run.resample ? 2.0 * 4 * sizeof(float) * static_cast<double>(run.display.area()) : 0;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    fmt::print("memory: about {:.0f} MB for one frame", static_cast<double>(usage.ru_maxrss) / 1e3 + pictures / 1e6);
    if (frames > 1)
        fmt::print(", and at most {:.0f} MB for each of {} more under way with it", run.frame_bytes / 1e6, frames - 1);
    fmt::print("\n");
}

}  // namespace

void explain(const FootageShot& footage_shot, const ExplainedRun& run) {
    const Shot& shot = footage_shot.shot();
    const int first = run.first;
    const Camera camera = shot.displacer().camera(first);
    fmt::print("picture: {} x {} pixels, {} px {}; {}\n", run.display.width, run.display.height,
               fmt::format("{:.5g}", camera.f_px),
               camera.projection == Projection::Perspective ? "of focal length" : "a metre",
               run.frames.empty() && run.kept > 0 ? fmt::format("all {} frames are there already", run.kept)
               : run.frames.empty()               ? "every frame of the movie"
                                                  : fmt::format("frames {} to make{}", frame_list(run.frames),
                                                  run.kept > 0 ? fmt::format(", {} there already", run.kept) : ""));
    for (const std::string& note : with_options(footage_shot.notes())) fmt::print("{}\n", note);
    if (shot.gain() == 0) {
        fmt::print("gain 0: nothing moves, frames are copied\n");
        return;
    }
    const FrameMeasure probe = measure(footage_shot, run);
    fmt::print("frame {}: {:.3g} px rms, {:.3g} px at most\n", first, probe.size.rms, probe.size.largest);
    fmt::print("error: 95 of 100 of {} sampled pixels of frame {} are off by {} at most, half of them by {}\n",
               probe.error->samples, first, shown_error(probe.error->p95), shown_error(probe.error->p50));
    const double frame = run.instants * (probe.instant + probe.map + probe.resample);
    fmt::print(
        "time: about {:.3g} s a frame on {} thread{} (media {:.2g} s, map {:.2g} s, picture {:.2g} s{}), {:.3g} s in "
        "all, and what reading and writing take\n",
        frame, run.threads, run.threads == 1 ? "" : "s", probe.instant, probe.map, probe.resample,
        run.instants > 1 ? fmt::format(", {} times", run.instants) : "",
        frame * static_cast<double>(std::max<std::size_t>(run.frames.size(), 1)));
    explain_memory(run);
}

}  // namespace eikonal
