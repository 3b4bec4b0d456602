#include "warp/app/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "warp/app/pipeline.h"
#include "warp/image/sequence.h"

namespace eikonal {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Probe {
    double instant = 0, map = 0, resample = 0;  ///< [s] of a whole picture's
    std::optional<StatedError> error;
};

/// Distances from far/8 to far, even in their inverse.
DepthPlane ramp(const PixelWindow& window, double far) {
    std::vector<float> metres(window.area());
    for (std::size_t i = 0; i < metres.size(); ++i) {
        const double part = static_cast<double>(i % static_cast<std::size_t>(window.width)) / window.width;
        metres[i] = static_cast<float>(far / (8 - 7 * part));
    }
    return {window, std::move(metres)};
}

Probe measure(const Shot& shot, const ExplainedRun& run, int frame) {
    const int rows = std::min(kExplainRows, run.display.height);
    const int middle = run.display.height / 2 / kExplainRows * kExplainRows;
    const PixelWindow strip{0, std::min(middle, run.display.height - rows), run.display.width, rows};
    const double whole = static_cast<double>(run.display.height) / rows;
    std::optional<DepthPlane> plane;
    DepthSource depth = shot.depth().constant().value_or(0);
    if (!shot.depth().constant()) depth = &plane.emplace(ramp(strip, shot.depth().far()));

    Probe probe;
    std::vector<float> uv(2 * strip.area());
    auto start = Clock::now();
    const Displacer::Instant instant =
        shot.displacer().at(frame, plane ? plane->nearest() : std::get<double>(depth),
                            plane ? plane->farthest() : std::get<double>(depth), shot.gain());
    probe.instant = seconds_since(start);
    start = Clock::now();
    instant.map(strip, depth, shot.meeting(), uv.data());
    probe.map = whole * seconds_since(start);
    probe.error = instant.stated_error(strip, depth, shot.meeting(), uv.data());
    if (run.resample) {
        const std::vector<float> plate(4 * strip.area(), 0.5F);
        std::vector<float> out(plate.size());
        start = Clock::now();
        resample({plate.data(), strip, 4, 4 * strip.width}, {uv.data(), strip, 2 * strip.width},
                 {out.data(), strip, 4, 4 * strip.width}, {*run.resample});
        probe.resample = whole * seconds_since(start);
    }
    return probe;
}

}  // namespace

void explain(const Shot& shot, const ExplainedRun& run) {
    const int first = run.frames.empty() ? shot.scene().time.first_frame : run.frames.front();
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
    fmt::print(
        "error: 95 of 100 of {} sampled pixels of frame {} are off by {:.2g} px at most, half of them by {:.2g} px\n",
        probe.error->samples, first, probe.error->p95, probe.error->p50);
    const double frame = run.instants * (probe.instant + probe.map + probe.resample);
    fmt::print(
        "time: about {:.3g} s a frame on {} thread{} (media {:.2g} s, map {:.2g} s, picture {:.2g} s{}), {:.3g} s in "
        "all, and what reading and writing take\n",
        frame, run.threads, run.threads == 1 ? "" : "s", probe.instant, probe.map, probe.resample,
        run.instants > 1 ? fmt::format(", {} times", run.instants) : "",
        frame * static_cast<double>(std::max<std::size_t>(run.frames.size(), 1)));
    fmt::print("memory: about {:.0f} MB a frame, at most {} of them at a time\n", run.frame_bytes / 1e6,
               run.threads + kFramesAhead);
}

}  // namespace eikonal
