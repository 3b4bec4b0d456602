/// `eikonal map`: displacement maps without any footage.

#include <fmt/format.h>

#include "noise/base/error.h"
#include "warp/app/commands.h"
#include "warp/app/explain.h"
#include "warp/app/outputs.h"
#include "warp/app/pipeline.h"
#include "warp/app/report.h"
#include "warp/app/shot.h"

namespace eikonal {
namespace {

/// Memory of a pixel on its way: map, depth, matte, and the map and the STMap as they are written.
constexpr double kMapBytes = 8 + 8 + 12 + 2 * 12;

/// Resolution: the scene's, else that of the first depth map that can be read, else kDefaultResolution.
PixelWindow choose_display(const Scene& scene, const DepthArguments& depth, const std::vector<int>& frames) {
    if (scene.camera.resolution) return {0, 0, (*scene.camera.resolution)[0], (*scene.camera.resolution)[1]};
    if (depth.depth)
        if (const FileChannel split = split_channel(*depth.depth); !split.file.empty())
            return display_window(first_header(FilePattern::parse(split.file), frames).parts.front());
    return {0, 0, kDefaultResolution[0], kDefaultResolution[1]};
}

}  // namespace

int run(const MapOptions& options) {
    const ThreadLimit limit(options.run);

    Scene scene = load_scene(options.scene);
    Outputs outputs;
    outputs.add("-o", options.output, OutputKind::Maps);
    if (options.strength.stmap) outputs.add("--stmap", *options.strength.stmap, OutputKind::Maps);
    if (options.run.report) outputs.add("--report", *options.run.report, OutputKind::Report);
    if (options.depth.depth && options.depth.depth->starts_with(':'))
        throw UserError(
            fmt::format("--depth {}: map has no INPUT whose channel it could be; name a file", *options.depth.depth));
    std::vector<int> frames =
        options.run.frames ? parse_frames(*options.run.frames) : std::vector<int>{scene.time.first_frame};
    const PixelWindow display = choose_display(scene, options.depth, frames);
    Shot shot(std::move(scene), options.scene, options.depth, options.strength, display, 1, {}, {},
              options.run.states_errors());
    outputs.check(frames, shot.companions());
    shot.tell(frames, options.run.verbose);
    const int first = frames.front();
    const std::size_t kept = options.run.overwrite ? 0 : outputs.keep_finished(frames, display);
    if (options.run.explain) {
        explain(shot, {display, frames, first, {}, kept, limit.threads(), shot.frame_bytes(kMapBytes), {}});
        return 0;
    }
    if (!options.run.skip_bad_frames)
        if (const auto missing = shot.missing_companion(frames)) throw FrameError(*missing);
    if (!frames.empty()) shot.try_companions(frames.front(), nullptr, {}, display);

    std::size_t next = 0;
    const Stages stages{[&]() -> std::unique_ptr<FrameItem> {
                            if (next == frames.size()) return nullptr;
                            auto item = std::make_unique<FrameItem>();
                            item->record.frame = frames[next++];
                            return item;
                        },
                        [] { return std::vector{0}; },
                        [&](FrameItem& item) {
                            const int frame = item.record.frame;
                            const Shot::Maps made = shot.maps(frame, {0}, nullptr, {}, display, item.record.remarks);
                            const DisplacementMap& map = made.of_instants.front();
                            item.record.stated = made.error;
                            const MapStatistics size = statistics(map);
                            item.record.rms = size.rms;
                            item.record.largest = size.largest;
                            if (const NamedFiles* stmap = outputs.find("--stmap"))
                                write_stmap(stmap->at(frame), map, display);
                            write_displacement(outputs.find("-o")->at(frame), map, display);
                        },
                        [](FrameItem&) {}};
    RunResult result;
    if (!frames.empty())
        result = run_pipeline(stages, options.run, frames.size(), limit.threads(), shot.frame_bytes(kMapBytes));
    tell_errors(shot, result, options.run.verbose);
    if (options.run.report) write_report(*options.run.report, shot, result, kept);
    print_outcome(result, options.run, frames.size(), "the same command makes the rest");
    return result.failed() ? 1 : 0;
}

}  // namespace eikonal
