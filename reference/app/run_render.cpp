/// `eikonal-trace render`: renders frames of a scene with straight or bent rays.
#include <fmt/format.h>
#include <tbb/info.h>

#include <chrono>
#include <cstdio>
#include <numeric>
#include <optional>

#include "noise/base/error.h"
#include "reference/app/commands.h"
#include "reference/app/explain.h"
#include "reference/app/tile_progress.h"
#include "reference/trace/frame_file.h"
#include "warp/image/atomic_file.h"
#include "warp/image/sequence.h"

namespace eikonal::reference {
namespace {

/// A pixel whose error exceeds this many tolerances is reported. The estimate of the steps' error is pessimistic, which
/// accounts for a factor of 2. The error of a spline that was made for the tolerance is added.
constexpr double kWarnedError = 3;
/// The user is warned if a larger part than this of the tried rays may have no end.
constexpr double kManyWithoutEnd = 0.05;

using Clock = std::chrono::steady_clock;

FilePattern checked_pattern(const RenderOptions& o, std::size_t frame_count) {
    const FilePattern pattern = FilePattern::parse(o.output);
    if (frame_count > 1 && !pattern.is_sequence())
        throw UserError(fmt::format("--output {}: {} frames need a frame number in the name, e.g. plate.####.exr",
                                    o.output.string(), frame_count));
    return pattern;
}

/// Reports what the user should know of a frame.
void report(const RenderOptions& o, const RenderedFrame& frame, int number, double seconds) {
    const auto warn = [&](std::size_t pixels, std::string_view what) {
        if (pixels > 0)
            fmt::print(stderr, "frame {}: warning: {} of {} pixels {}\n", number, pixels, frame.id.size(), what);
    };
    warn(frame.trapped() - frame.unfinished(),
         "hold rays that go round and round (id -1, black): the media are too strong");
    warn(frame.unfinished(), "hold rays that the step budget ended (id -3, black); --step-budget raises it");
    warn(frame.without_index(), "hold rays that came to where n <= 0 (id -2, black); lower [optics] exaggeration");
    // Counts of the pixels that show something.
    std::size_t beyond = 0, shown = 0;
    float farthest = 0;
    double errors = 0;
    for (std::size_t i = 0; i < frame.error.size(); ++i) {
        if (frame.id[i] < 0) continue;
        ++shown;
        errors += double{frame.error[i]};
        farthest = std::max(farthest, frame.error[i]);
        if (frame.error[i] > kWarnedError * o.render.rays.tolerance_px) ++beyond;
    }
    if (o.render.rays.integrator == Integrator::Adaptive)
        warn(beyond, fmt::format("may be off by more than {:g} times the tolerance of {:g} px, by up to {:.2g} px as "
                                 "their rays estimate it; a smaller --tolerance brings them nearer, as far as a "
                                 "lattice's spline (--explain) can be finer",
                                 kWarnedError, o.render.rays.tolerance_px, farthest));
    if (!frame.magnification.empty())
        fmt::print(stderr, "frame {}: {} of {} pixels are folded (negative magnification)\n", number, frame.folded(),
                   frame.id.size());
    if (!o.verbose) return;
    const double area = static_cast<double>(frame.depth.size());
    const auto mean = [&](const std::vector<float>& values) {
        return values.empty() ? 0.0 : std::accumulate(values.begin(), values.end(), 0.0) / area;
    };
    fmt::print(stderr, "frame {}: {:.2f} s, {:.1f} steps a ray, estimated error {:.2g} px on average\n", number,
               seconds, mean(frame.steps), errors / static_cast<double>(std::max<std::size_t>(shown, 1)));
}

/// Warns at once of what would otherwise show only after a long time.
void warn(const RenderOptions& o, int frame, const Renderer& renderer, const Probe& probe) {
    const auto many = [&](std::size_t rays) {
        return static_cast<double>(rays) >= kManyWithoutEnd * static_cast<double>(probe.pixels.width);
    };
    const std::size_t trapped = probe.pixels.trapped() - probe.pixels.unfinished();
    if (many(trapped))
        fmt::print(stderr,
                   "frame {}: warning: {} of {} rays tried go round and round, their pixels are black: the "
                   "media are too strong\n",
                   frame, trapped, probe.pixels.width);
    if (many(probe.off))
        fmt::print(
            stderr,
            "frame {}: warning: {} of {} rays tried are off by more than {:g} times the tolerance of {:g} px, by "
            "up to {:.2g} px, whatever `error` says: the air spreads far apart what little rays err by; a "
            "smaller --tolerance brings them nearer\n",
            frame, probe.off, probe.again, kPessimism, o.render.rays.tolerance_px, probe.farthest_off);
    if (!many(probe.beyond)) return;
    const double seconds = probe.time(static_cast<double>(renderer.width()) * renderer.height(), o.render.samples);
    fmt::print(
        stderr,
        "frame {}: warning: {} of {} rays tried are on a way that may use up their {} steps and be black; a frame may "
        "take {:.2g} {}: give the media bounds (falloff), or rays something to meet, or raise --step-budget\n",
        frame, probe.beyond, probe.pixels.width, o.render.rays.step_budget, seconds > 3600 ? seconds / 3600 : seconds,
        seconds > 3600 ? "h" : "s");
}

RenderedFrame render(const Renderer& renderer, const RenderOptions& o, int frame) {
    std::optional<TileProgress> progress;
    const auto begin = [&](const std::string& what, int parts) {
        progress.reset();  // clears the line of the progress
        progress.emplace(fmt::format("frame {}{}", frame, what), parts);
    };
    FrameWatch watch;
    watch.probed = [&](const Probe& probe) { warn(o, frame, renderer, probe); };
    watch.light.begins = [&](int object, int rows) { begin(fmt::format(", sunlight on object.{}", object), rows); };
    watch.light.row_done = [&] { progress->tile_done(); };
    watch.tiles_begin = [&] { begin("", renderer.tile_count()); };
    watch.tile_done = [&] { progress->tile_done(); };
    return renderer.render(frame, watch);
}

}  // namespace

int run(const RenderOptions& o, const std::stop_token& stop) {
    const Scene scene = read_scene(o.common.scene, o.common.settings, o.common.seed);
    const std::vector<int> frames = o.frames.empty() ? std::vector{scene.time.first_frame} : parse_frames(o.frames);
    const FilePattern pattern = checked_pattern(o, frames.size());
    RenderSettings settings = o.render;
    settings.stop = stop;
    const Renderer renderer(scene, settings);
    for (const int frame : frames) renderer.check_camera(frame);
    if (o.explain) {
        explain(renderer, scene, settings, frames,
                o.common.threads > 0 ? o.common.threads : tbb::info::default_concurrency());
        return 0;
    }
    for (const int frame : frames) {
        const std::filesystem::path file = pattern.at(frame);
        std::error_code ignored;
        if (!o.overwrite && std::filesystem::exists(file, ignored)) {
            fmt::print(stderr, "frame {}: kept {} (--overwrite renders it again)\n", frame, file.string());
            continue;
        }
        try {
            if (const auto object = renderer.camera_inside(frame)) {
                const std::string& name = scene.objects[static_cast<std::size_t>(*object)].name;
                fmt::print(stderr, "frame {}: warning: the camera is inside object.{}{}\n", frame, *object,
                           name.empty() ? "" : fmt::format(" \"{}\"", name));
            }
            const AtomicFile place(file);  // fails before the work, rather than after, if the file cannot be created
            const auto start = Clock::now();
            const RenderedFrame rendered = render(renderer, o, frame);
            write_frame(file, rendered, o.compact ? Storage::Compact : Storage::Exact);
            report(o, rendered, frame, std::chrono::duration<double>(Clock::now() - start).count());
        } catch (const FrameError& error) {
            throw FrameError(fmt::format("frame {}: {}", frame, error.what()));
        }
        fmt::print(stderr, "frame {}: wrote {}\n", frame, file.string());
    }
    return 0;
}

}  // namespace eikonal::reference
