/// eikonal-trace: declares its options, checks them, renders, reports. Exit statuses as in reference/README.md.
#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <mutex>

#include "noise/error.h"
#include "reference/render.h"
#include "warp/image/atomic_file.h"
#include "warp/image/picture.h"
#include "warp/image/sequence.h"

namespace {

using namespace eikonal;
using namespace eikonal::reference;

struct Options {
    std::filesystem::path scene, output;
    bool straight = false, overwrite = false, compact = false;
    std::string frames;
    int samples = 64, threads = 0;
    std::vector<std::string> settings;
};

void declare(CLI::App& app, Options& o) {
    app.require_subcommand(1);
    app.set_version_flag("--version", "eikonal-trace " EIKONAL_VERSION);
    CLI::App& render = *app.add_subcommand("render", "Render the objects of a scene: colour and depth (Z) as OpenEXR");
    render.add_option("SCENE", o.scene, "Scene file (.toml)")->required();
    render.add_option("-o,--output", o.output, "Output .exr; plate.####.exr for a sequence")->required();
    render.add_flag("--straight", o.straight,
                    "Straight rays: the undistorted plate and its depth (required: bent rays are not available yet)");
    render.add_option("--frames", o.frames, "Frames, e.g. 1-24, 1-9x2, 3,7 (default: the scene's first frame)");
    render.add_option("--samples", o.samples, "Samples a pixel for the colour; powers of two spread best")
        ->check(CLI::Range(1, 1 << 20))
        ->capture_default_str();
    render.add_flag("--compact", o.compact, "Small files: colour slightly lossy (DWAA), Z to 2e-6");
    render.add_option("--set", o.settings, "KEY=VALUE: override a key of the scene, e.g. camera.resolution=[640,360]")
        ->allow_extra_args(false);
    render.add_option("--threads", o.threads, "Threads (default: all; the picture does not depend on it)")
        ->check(CLI::Range(1, 4096));
    render.add_flag("--overwrite", o.overwrite, "Render frames again whose files exist");
}

FilePattern checked_output(const Options& o, std::size_t frame_count) {
    if (!o.straight)
        throw UserError(
            "render: bent rays are not available in this version; pass --straight to render the undistorted plate and "
            "its depth");
    if (o.output.extension() != ".exr")
        throw UserError(fmt::format(
            "--output {}: colour and depth are written as OpenEXR only; use a name ending in .exr", o.output.string()));
    const FilePattern pattern = FilePattern::parse(o.output);
    if (frame_count > 1 && !pattern.is_sequence())
        throw UserError(fmt::format("--output {}: {} frames need a frame number in the name, e.g. plate.####.exr",
                                    o.output.string(), frame_count));
    return pattern;
}

/// A line that is rewritten on a terminal, silent elsewhere.
class TileProgress {
  public:
    TileProgress(std::string what, int tiles)
        : what_(std::move(what)), tiles_(tiles), shown_(isatty(STDERR_FILENO) != 0) {}
    void tile_done() {
        const std::scoped_lock lock(mutex_);
        const int percent = 100 * ++done_ / tiles_;
        if (!shown_ || percent == percent_) return;
        percent_ = percent;
        fmt::print(stderr, "\r{} {:3} %{}", what_, percent, percent == 100 ? "\r\033[K" : "");
    }

  private:
    std::string what_;
    int tiles_, done_ = 0, percent_ = -1;
    bool shown_;
    std::mutex mutex_;
};

void render(const Options& o) {
    const Scene scene = read_scene(o.scene, o.settings);
    const std::vector<int> frames = o.frames.empty() ? std::vector{scene.time.first_frame} : parse_frames(o.frames);
    const FilePattern pattern = checked_output(o, frames.size());
    const Renderer renderer(scene, o.samples);
    for (const int frame : frames) {
        const std::filesystem::path file = pattern.at(frame);
        if (!o.overwrite && std::filesystem::exists(file)) {
            fmt::print(stderr, "frame {}: kept {} (--overwrite renders it again)\n", frame, file.string());
            continue;
        }
        try {
            const AtomicFile place(file);  // fails now rather than after the work if the file cannot be put there
            TileProgress progress(fmt::format("frame {}", frame), renderer.tile_count());
            write_frame(file, renderer.render(frame, [&] { progress.tile_done(); }),
                        o.compact ? Storage::Compact : Storage::Exact);
        } catch (const FrameError& error) {
            throw FrameError(fmt::format("frame {}: {}", frame, error.what()));
        }
        fmt::print(stderr, "frame {}: wrote {}\n", frame, file.string());
    }
}

int report(const std::exception& error, int status) {
    fmt::print(stderr, "eikonal-trace: {}\n", error.what());
    return status;
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app("Traces the scenes that eikonal distorts: the ground truth for its warp.", "eikonal-trace");
    declare(app, options);
    try {
        app.parse(argc, argv);
        const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(threads));
        set_image_threads(threads);
        render(options);
        return 0;
    } catch (const CLI::Success& shown) {  // --help, --version
        return app.exit(shown);
    } catch (const CLI::ParseError& error) {
        return report(error, 2);
    } catch (const UserError& error) {
        return report(error, 2);
    } catch (const std::exception& error) {
        return report(error, 1);
    }
}
