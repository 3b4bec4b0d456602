/// `eikonal field`: slices of the refractive field of one medium, for analysis (Medium::slices).

#include <fmt/format.h>

#include "noise/base/error.h"
#include "noise/base/memory.h"
#include "noise/medium/medium_spec.h"
#include "noise/medium/optics.h"
#include "warp/app/commands.h"
#include "warp/app/outputs.h"
#include "warp/app/pipeline.h"
#include "warp/app/progress.h"
#include "warp/app/shot_options.h"
#include "warp/program/thread_limit.h"
#include "warp/scene/shot_view.h"

namespace eikonal {
namespace {

/// Slices of the medium that the options name, at their frame.
FieldSlices make_slices(const FieldOptions& options, const Scene& scene) {
    if (static_cast<std::size_t>(options.medium) >= scene.media.size())
        throw UserError(fmt::format("--medium {}: the scene has {} medi{}, counted from 0", options.medium,
                                    scene.media.size(), scene.media.size() == 1 ? "um" : "a"));
    const MediumSpec& spec = scene.media[static_cast<std::size_t>(options.medium)];
    if (spec.has_absolute_index())
        throw UserError(
            fmt::format("--medium {}: is a {}, which is known in closed form; field writes the media that "
                        "the warp takes",
                        options.medium, spec.type()));
    const double fps = scene.time.fps.value_or(kDefaultFps);
    const double t = (options.frame.value_or(scene.time.first_frame) - scene.time.first_frame) / fps;
    const auto [width, height] = scene.camera.resolution.value_or(kDefaultResolution);
    const ShotFrame frame = shot_frame(CameraPath(scene.camera, width, height).reference(), width, height,
                                       scene.optics.aperture, DepthInput({}, scene).background().far, fps);
    ShotBudget budget{memory_limit()};
    const std::shared_ptr<const Medium> medium = spec.build({.name = fmt::format("medium.{}", options.medium),
                                                             .optics = scene.optics,
                                                             .frame = frame,
                                                             .lattice_splines = false,
                                                             .budget = &budget});
    return medium->slices(t, {scene.optics.ray_equation, index_law(scene.optics).ambient(), scene.optics.exaggeration});
}

/// UserError if a slice and its copy for the file need more memory than there is.
void check_memory(const FieldSlices& slices) {
    const double bytes = 2.0 * sizeof(float) * kFieldChannels * slices.width * slices.height;
    const auto memory = static_cast<double>(memory_limit());
    if (bytes > memory)
        throw UserError(fmt::format(
            "slices of {} x {} samples need {:.3g} GB of memory, {:.3g} GB are available; use a smaller lattice",
            slices.width, slices.height, bytes * 1e-9, memory * 1e-9));
}

}  // namespace

int run(const FieldOptions& options, const std::stop_token& stop) {
    const ThreadLimit limit(options.run.threads);
    const Scene scene = load_scene(options.scene);
    Outputs outputs;
    outputs.add("-o", options.output, OutputKind::Maps);
    const FieldSlices slices = make_slices(options, scene);
    check_memory(slices);
    std::vector<int> numbers(static_cast<std::size_t>(slices.count));
    for (int i = 0; i < slices.count; ++i) numbers[static_cast<std::size_t>(i)] = i;
    std::vector<NamedFiles> inputs;
    if (!scene.file.empty()) inputs.push_back({"the scene", FilePattern::parse(scene.file), true});
    outputs.check(numbers, inputs);
    if (options.run.verbose)
        fmt::print(stderr, "eikonal: {} slices of {} x {} samples\n", slices.count, slices.width, slices.height);

    static const std::vector<std::string> kNames{"n", "F.x", "F.y", "F.z"};
    const PixelWindow window{0, 0, slices.width, slices.height};
    std::vector<float> values(kFieldChannels * window.area());
    if (!options.run.overwrite) outputs.keep_finished(numbers, window, stop);
    if (numbers.empty()) return 0;
    std::size_t made = 0;
    Progress progress(options.run.progress, numbers.size(), "slices");
    for (const int slice : numbers) {
        if (stop.stop_requested())
            throw FrameError(
                fmt::format("interrupted after {} of {} slices; the same command goes on", made, numbers.size()));
        slices.fill(slice, values);
        std::vector<Attribute> attributes(slices.attributes.begin(), slices.attributes.end());
        attributes.emplace_back("eikonal/z", slices.position(slice));
        write_float_exr(outputs.find("-o")->at(slice), window, window, kNames, values, attributes);
        ++made;
        progress.step();
    }
    return 0;
}

}  // namespace eikonal
