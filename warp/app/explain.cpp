#include "warp/app/explain.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>

#include "warp/app/pipeline.h"
#include "warp/displace/stated_error.h"
#include "warp/image/sequence.h"

namespace eikonal {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Probe {
    double instant = 0, map = 0, resample = 0;  ///< [s] of a whole picture's
    MapStatistics size;
    std::optional<StatedError> error;
};

Probe measure(const Shot& shot, const ExplainedRun& run, int frame) {
    const PixelWindow picture{0, 0, run.display.width, run.display.height};
    std::optional<DepthPlane> plane;
    DepthSource depth = shot.depth().constant().value_or(0);
    double nearest = std::get<double>(depth), farthest = nearest;
    if (!shot.depth().constant()) {
        std::optional<Picture> input;
        if (shot.depth().inside_input() && !run.picture.empty()) input = read_picture(run.picture);
        std::vector<Remark> remarks;
        plane.emplace(shot.depth().plane(frame, input ? &*input : nullptr, run.picture, run.display, run.display,
                                         shot.displacer().camera(frame), remarks));
        depth = &*plane;
        nearest = plane->nearest();
        farthest = plane->farthest();
    }

    Probe probe;
    DisplacementMap map{picture, std::vector<float>(2 * picture.area())};
    auto start = Clock::now();
    const Displacer::Instant instant = shot.displacer().at(frame, nearest, farthest, shot.gain());
    probe.instant = seconds_since(start);
    start = Clock::now();
    instant.map(picture, depth, shot.meeting(), map.uv.data());
    probe.map = seconds_since(start);
    probe.size = statistics(map);
    probe.error = instant.stated_error(picture, depth, shot.meeting(), map.uv.data());
    if (run.resample) {
        const int rows = std::min(kExplainRows, picture.height);
        const PixelWindow strip{0, (picture.height - rows) / 2, picture.width, rows};
        const std::vector<float> plate(4 * strip.area(), 0.5F);
        std::vector<float> out(plate.size());
        const float* uv =
            map.uv.data() + 2 * static_cast<std::size_t>(strip.y0) * static_cast<std::size_t>(strip.width);
        start = Clock::now();
        resample({plate.data(), strip, 4, 4 * strip.width}, {uv, strip, 2 * strip.width},
                 {out.data(), strip, 4, 4 * strip.width}, {*run.resample});
        probe.resample = static_cast<double>(picture.height) / rows * seconds_since(start);
    }
    return probe;
}

}  // namespace

void explain(const Shot& shot, const ExplainedRun& run) {
    const int first = run.first;
    const Camera camera = shot.displacer().camera(first);
    fmt::print("picture: {} x {} pixels, {} px {}; {}\n", run.display.width, run.display.height,
               fmt::format("{:.5g}", camera.f_px),
               camera.projection == Projection::Perspective ? "of focal length" : "a metre",
               run.frames.empty() && run.kept > 0 ? fmt::format("all {} frames are there already", run.kept)
               : run.frames.empty()               ? "every frame of the movie"
                                                  : fmt::format("frames {} to make{}", frame_list(run.frames),
                                                  run.kept > 0 ? fmt::format(", {} there already", run.kept) : ""));
    for (const std::string& note : shot.notes()) fmt::print("{}\n", note);
    if (shot.gain() == 0) {
        fmt::print("gain 0: nothing moves, frames are copied\n");
        return;
    }
    const Probe probe = measure(shot, run, first);
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
    const std::size_t at_a_time = static_cast<std::size_t>(run.threads + kFramesAhead),
                      frames = run.frames.empty() ? at_a_time : std::min(run.frames.size(), at_a_time);
    // what has been measured had neither the frame's picture nor the warped one
    const double pictures = run.resample ? 2.0 * 4 * sizeof(float) * static_cast<double>(run.display.area()) : 0;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    fmt::print("memory: about {:.0f} MB for one frame", static_cast<double>(usage.ru_maxrss) / 1e3 + pictures / 1e6);
    if (frames > 1)
        fmt::print(", and at most {:.0f} MB for each of {} more under way with it", run.frame_bytes / 1e6, frames - 1);
    fmt::print("\n");
}

}  // namespace eikonal
