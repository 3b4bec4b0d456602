/// `eikonal map`: displacement maps without footage.

#include <fmt/format.h>

#include "noise/base/error.h"
#include "warp/app/commands.h"
#include "warp/app/explain.h"
#include "warp/app/footage.h"
#include "warp/app/map_files.h"
#include "warp/app/outputs.h"
#include "warp/app/pipeline.h"
#include "warp/app/report.h"
#include "warp/app/shot_options.h"
#include "warp/program/thread_limit.h"

namespace eikonal {
namespace {

/// Memory per pixel of a frame [bytes]: map, depth, matte, and the map and the STMap as they are written.
constexpr double kMapBytes = 8 + 8 + 12 + 2 * 12;

/// The resolution: that of the scene, else that of the first readable depth map, else kDefaultResolution.
PixelWindow choose_display(const Scene& scene, const DepthSettings& depth, const std::vector<int>& frames) {
    if (scene.camera.resolution) return {0, 0, (*scene.camera.resolution)[0], (*scene.camera.resolution)[1]};
    if (depth.depth)
        if (const FileChannel split = split_channel(*depth.depth); !split.file.empty())
            return display_window(first_header(FilePattern::parse(split.file), frames).parts.front());
    return {0, 0, kDefaultResolution[0], kDefaultResolution[1]};
}

Outputs map_outputs(const MapOptions& options) {
    Outputs outputs;
    outputs.add("-o", options.output, OutputKind::Maps);
    if (options.stmap) outputs.add("--stmap", *options.stmap, OutputKind::Maps);
    if (options.run.report) outputs.add("--report", *options.run.report, OutputKind::Report);
    return outputs;
}

/// Computes and writes the map of one frame.
void make_map(const FootageShot& shot, const Outputs& outputs, FrameRecord& record) {
    const PixelWindow& display = shot.shot().display();
    const Shot::Maps made = shot.maps(record.frame, {0}, {}, display, record.remarks);
    const DisplacementMap& map = made.of_instants.front();
    record.stated = made.error;
    const MapStatistics size = statistics(map);
    record.rms = size.rms;
    record.largest = size.largest;
    if (const NamedFiles* stmap = outputs.find("--stmap")) write_stmap(stmap->at(record.frame), map, display);
    write_displacement(outputs.find("-o")->at(record.frame), map, display);
}

RunResult make_maps(const MapOptions& options, const FootageShot& shot, const Outputs& outputs,
                    const std::vector<int>& frames, int threads, const std::stop_token& stop) {
    if (frames.empty()) return {};
    shot.try_companions(frames.front(), {}, shot.shot().display());
    std::size_t next = 0;
    const auto take = [&]() -> std::unique_ptr<FrameItem> {
        if (next == frames.size()) return nullptr;
        auto item = std::make_unique<FrameItem>();
        item->record.frame = frames[next++];
        return item;
    };
    const Stages stages{take, [] { return std::vector{0}; },
                        [&](FrameItem& item) { make_map(shot, outputs, item.record); }, [](FrameItem&) {}};
    return run_pipeline(stages, options.run, frames.size(), threads, shot.shot().frame_bytes(kMapBytes), stop);
}

}  // namespace

int run(const MapOptions& options, const std::stop_token& stop) {
    const ThreadLimit limit(options.run.threads);

    Scene scene = load_scene(options.shot.scene);
    const Outputs outputs = map_outputs(options);
    if (const auto& depth = options.shot.depth.depth; depth && depth->starts_with(':'))
        throw UserError(fmt::format("--depth {}: map has no INPUT whose channel it could be; name a file", *depth));
    std::vector<int> frames =
        options.run.frames ? parse_frames(*options.run.frames) : std::vector<int>{scene.time.first_frame};
    FootageShotSettings settings = shot_settings(options.shot, options.run, stop);
    const PixelWindow display = settings.view.display = choose_display(scene, options.shot.depth, frames);
    const FootageShot shot(std::move(scene), settings);
    outputs.check(frames, companions(shot));
    RunSummary summary{announce(shot, frames, options.run.verbose), 0, 0, "the same command makes the rest"};

    const int first = frames.front();
    if (!options.run.overwrite) summary.kept = outputs.keep_finished(frames, display, stop);
    if (options.run.explain) {
        explain(shot,
                {display, frames, first, {}, summary.kept, limit.threads(), shot.shot().frame_bytes(kMapBytes), {}});
        return 0;
    }
    if (!options.run.skip_bad_frames)
        if (const auto missing = shot.missing_companion(frames)) throw FrameError(*missing);
    RunResult result = make_maps(options, shot, outputs, frames, limit.threads(), stop);
    summary.total = frames.size();
    return conclude(shot, options.run, summary, result);
}

}  // namespace eikonal
