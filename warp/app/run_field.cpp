/// `eikonal field`: slices of the refractive field of one medium, for analysis. Turbulence fills its lattice's period;
/// hot blobs, the box around those alive; a surface, a cube that stands on its origin. And the two commands that only
/// print.

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <functional>
#include <glm/common.hpp>
#include <utility>

#include "noise/base/error.h"
#include "noise/base/memory.h"
#include "noise/blobs/blob_instant.h"
#include "noise/blobs/blobs.h"
#include "noise/surface/surface.h"
#include "noise/turbulence/gradient_noise/gradient_noise.h"
#include "noise/turbulence/lattice/lattice_instant.h"
#include "noise/turbulence/screens/screens.h"
#include "warp/app/commands.h"
#include "warp/app/outputs.h"
#include "warp/app/pipeline.h"
#include "warp/app/progress.h"
#include "warp/app/shot.h"
#include "warp/image/interrupt.h"
#include "warp/scene/screen_view.h"

namespace eikonal {
namespace {

constexpr int kChannels = 4;
/// Samples along each axis of a field that has no lattice of its own.
constexpr int kSamples = 64;
/// What is shown about blobs [σ], and the height over a surface [dropoff].
constexpr double kBlobMargin = 3, kLayerHeight = 8;

/// The z-slices of a field: how many, of what size, and what one holds.
struct Slices {
    int count = 0, width = 0, height = 0;
    std::function<void(int slice, std::vector<float>& interleaved)> fill;  ///< n, F.x, F.y, F.z a sample
    std::vector<Attribute> attributes;
    std::function<double(int slice)> position;  ///< z of a slice [m]
};

void describe(Slices& slices, const std::array<double, 4>& period, const std::array<double, 3>& spacing, double t) {
    for (int i = 0; i < 4; ++i)
        slices.attributes.emplace_back(fmt::format("eikonal/period.{}", "xyzt"[i]),
                                       period[static_cast<std::size_t>(i)]);
    for (int i = 0; i < 3; ++i)
        slices.attributes.emplace_back(fmt::format("eikonal/spacing.{}", "xyz"[i]),
                                       spacing[static_cast<std::size_t>(i)]);
    slices.attributes.emplace_back("eikonal/time", t);
}

Slices lattice_slices(const TurbulenceSpec& spec, double t, double exaggeration, double force_factor) {
    const LatticeGeometry g = choose_lattice(spec);
    check_lattice(spec, g, memory_limit());
    const LatticeField field(spec, g);
    auto nodes = std::make_shared<std::array<FftVector<float>, kChannels>>();
    constexpr std::array kComponents{Component::Index, Component::ForceX, Component::ForceY, Component::ForceZ};
    for (std::size_t c = 0; c < kChannels; ++c) (*nodes)[c] = node_field(field, t, kComponents[c]);
    Slices slices{g.size[2], g.size[0], g.size[1], {}, {}, [g](int z) { return z * g.spacing(2); }};
    slices.fill = [=](int z, std::vector<float>& out) {
        for (int row = 0; row < g.size[1]; ++row)
            for (int x = 0; x < g.size[0]; ++x) {
                const int y = g.size[1] - 1 - row;  // y up: the last row of nodes is on top
                const auto node =
                    (static_cast<std::size_t>(x) * static_cast<std::size_t>(g.size[1]) + static_cast<std::size_t>(y)) *
                        static_cast<std::size_t>(g.size[2]) +
                    static_cast<std::size_t>(z);
                float* pixel = &out[kChannels * (static_cast<std::size_t>(row) * static_cast<std::size_t>(g.size[0]) +
                                                 static_cast<std::size_t>(x))];
                for (std::size_t c = 0; c < kChannels; ++c)
                    pixel[c] = (*nodes)[c][node] * static_cast<float>(c == 0 ? exaggeration : force_factor);
            }
    };
    describe(slices, g.period, {g.spacing(0), g.spacing(1), g.spacing(2)}, t);
    return slices;
}

/// Samples of a function of position on a grid from `low` on.
Slices sampled_slices(const std::array<int, 3>& size, const dvec3& low, const dvec3& spacing, double exaggeration,
                      double force_factor, std::function<IndexSample(const dvec3&)> sample) {
    Slices slices{size[2], size[0], size[1], {}, {}, [=](int z) { return low.z + z * spacing.z; }};
    slices.fill = [=](int z, std::vector<float>& out) {
        tbb::parallel_for(0, size[1], [&](int row) {
            for (int x = 0; x < size[0]; ++x) {
                const IndexSample s = sample(low + spacing * dvec3(x, size[1] - 1 - row, z));
                float* pixel = &out[kChannels * (static_cast<std::size_t>(row) * static_cast<std::size_t>(size[0]) +
                                                 static_cast<std::size_t>(x))];
                pixel[0] = static_cast<float>(exaggeration * s.n);
                for (int c = 0; c < 3; ++c) pixel[c + 1] = static_cast<float>(force_factor * s.gradient[c]);
            }
        });
    };
    return slices;
}

Slices noise_slices(const TurbulenceSpec& spec, double t, double exaggeration, double force_factor) {
    auto field = std::make_shared<const GradientNoiseField>(spec);
    const std::array<int, 4> size = spec.lattice.value_or(std::array{kSamples, kSamples, kSamples, 1});
    const double side = 2 * spec.outer_scale;
    const std::array<double, 4> period = spec.period.value_or(std::array{side, side, side, 0.0});
    const dvec3 spacing{period[0] / size[0], period[1] / size[1], period[2] / size[2]};
    Slices slices = sampled_slices({size[0], size[1], size[2]}, {0, 0, 0}, spacing, exaggeration, force_factor,
                                   [=](const dvec3& x) { return field->sample(x, t); });
    describe(slices, {0, 0, 0, 0}, {spacing.x, spacing.y, spacing.z}, t);  // no period
    return slices;
}

/// A box of kSamples³ between two corners.
Slices box_slices(const dvec3& low, const dvec3& high, double t, double exaggeration, double force_factor,
                  std::function<IndexSample(const dvec3&)> sample) {
    const dvec3 spacing = (high - low) / double{kSamples - 1};
    Slices slices =
        sampled_slices({kSamples, kSamples, kSamples}, low, spacing, exaggeration, force_factor, std::move(sample));
    describe(slices, {0, 0, 0, 0}, {spacing.x, spacing.y, spacing.z}, t);
    slices.attributes.emplace_back("eikonal/origin.x", low.x);
    slices.attributes.emplace_back("eikonal/origin.y", low.y);
    return slices;
}

/// Without blobs alive: a metre about the origin, of nothing.
Slices blob_slices(const BlobsSpec& spec, const IndexLaw& law, const std::string& name, double t, double exaggeration,
                   double force_factor) {
    const std::vector<Blob> blobs = BlobCloud(spec, law, name).at(t);
    dvec3 low(-0.5), high(0.5);
    bool any = false;
    for (const Blob& blob : blobs) {
        if (blob.n == 0) continue;
        const dvec3 margin(kBlobMargin * blob.sigma);
        low = any ? glm::min(low, blob.center - margin) : blob.center - margin;
        high = any ? glm::max(high, blob.center + margin) : blob.center + margin;
        any = true;
    }
    auto instant = std::make_shared<const BlobInstant>(blobs);
    return box_slices(low, high, t, exaggeration, force_factor, [=](const dvec3& x) { return instant->sample(x); });
}

Slices surface_slices(const SurfaceSpec& spec, const IndexLaw& law, double t, double exaggeration,
                      double force_factor) {
    const double half = 0.5 * kLayerHeight * spec.dropoff;
    const dvec3 center = spec.origin + half * spec.normal;
    return box_slices(center - dvec3(half), center + dvec3(half), t, exaggeration, force_factor,
                      [layer = SurfaceIndex(spec, law)](const dvec3& x) { return layer.sample(x); });
}

/// A screen is one slice: n and F averaged over its slab, in the lateral axes of the camera (F.z = 0), at the strength
/// that it has before any falloff: where a falloff lies on a screen depends on the ray that meets it.
Slices screen_slices(const TurbulenceSpec& spec, double t, const Scene& scene, double exaggeration,
                     double force_factor) {
    const std::array<int, 2> resolution = scene.camera.resolution.value_or(kDefaultResolution);
    const Camera camera = CameraPath(scene.camera, resolution[0], resolution[1]).reference();
    const ShotView view = screen_view(camera, resolution[0], resolution[1], scene.optics.aperture,
                                      DepthInput({}, scene).far(), scene.time.fps.value_or(kDefaultFps));
    const std::vector<ScreenGeometry> geometry = layout_screens(spec, view);
    check_screens(spec, geometry, memory_limit());
    auto screens =
        std::make_shared<const std::vector<ScreenInstant>>(ScreenField(spec, geometry, camera.right, camera.up).at(t));
    int width = 0, height = 0;
    for (const ScreenGeometry& g : geometry) {
        width = std::max(width, g.nx);
        height = std::max(height, g.ny);
    }
    Slices slices{static_cast<int>(geometry.size()), width, height, {}, {}, [geometry](int m) {
                      return geometry[static_cast<std::size_t>(m)].w;
                  }};
    slices.fill = [=](int m, std::vector<float>& out) {
        const ScreenGeometry& g = geometry[static_cast<std::size_t>(m)];
        tbb::parallel_for(0, height, [&](int row) {
            for (int x = 0; x < width; ++x) {
                const auto s =
                    (*screens)[static_cast<std::size_t>(m)].sample(x * g.Lx / g.nx, (height - 1 - row) * g.Ly / g.ny);
                float* pixel = &out[kChannels * (static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                                                 static_cast<std::size_t>(x))];
                pixel[0] = static_cast<float>(exaggeration * double{s.value} / g.thickness);
                pixel[1] = static_cast<float>(force_factor * double{s.dx} / g.thickness);
                pixel[2] = static_cast<float>(force_factor * double{s.dy} / g.thickness);
                pixel[3] = 0;
            }
        });
    };
    const ScreenGeometry& g = geometry.front();
    describe(slices, {g.Lx, g.Ly, 0, g.T}, {g.Lx / g.nx, g.Ly / g.ny, g.thickness}, t);
    return slices;
}

Slices make_slices(const FieldOptions& options, const Scene& scene) {
    if (static_cast<std::size_t>(options.medium) >= scene.media.size())
        throw UserError(fmt::format("--medium {}: the scene has {} medi{}, counted from 0", options.medium,
                                    scene.media.size(), scene.media.size() == 1 ? "um" : "a"));
    const double t = (options.frame.value_or(scene.time.first_frame) - scene.time.first_frame) /
                     scene.time.fps.value_or(kDefaultFps);
    const double exaggeration = scene.optics.exaggeration;
    const double force = force_strength(scene.optics);
    const MediumSpec& medium = scene.media[static_cast<std::size_t>(options.medium)];
    const IndexLaw law = index_law(scene.optics);
    if (const auto* blobs = std::get_if<BlobsSpec>(&medium))
        return blob_slices(*blobs, law, fmt::format("medium.{}", options.medium), t, exaggeration, force);
    if (const auto* surface = std::get_if<SurfaceSpec>(&medium))
        return surface_slices(*surface, law, t, exaggeration, force);
    const auto* spec = std::get_if<TurbulenceSpec>(&medium);
    if (spec == nullptr)
        throw UserError(fmt::format(
            "--medium {}: is a profile, which is known in closed form; field writes turbulence, blobs and surfaces",
            options.medium));
    switch (spec->form) {
        case TurbulenceForm::Lattice:
            return lattice_slices(*spec, t, exaggeration, force);
        case TurbulenceForm::GradientNoise:
            return noise_slices(*spec, t, exaggeration, force);
        case TurbulenceForm::Screens:
            break;
    }
    return screen_slices(*spec, t, scene, exaggeration, force);
}

/// UserError: a slice as it is computed, and its copy as it is written, are more than there is memory.
void check_memory(const Slices& slices) {
    const double bytes = 2.0 * sizeof(float) * kChannels * slices.width * slices.height;
    const auto memory = static_cast<double>(memory_limit());
    if (bytes > memory)
        throw UserError(fmt::format(
            "slices of {} x {} samples need {:.3g} GB of memory, {:.3g} GB are available; use a smaller lattice",
            slices.width, slices.height, bytes * 1e-9, memory * 1e-9));
}

}  // namespace

int run(const FieldOptions& options) {
    const ThreadLimit limit(options.run);
    const Scene scene = load_scene(options.scene);
    Outputs outputs;
    outputs.add("-o", options.output, OutputKind::Maps);
    const Slices slices = make_slices(options, scene);
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
    std::vector<float> values(kChannels * window.area());
    if (!options.run.overwrite) outputs.keep_finished(numbers, window);
    if (numbers.empty()) return 0;
    std::size_t made = 0;
    Progress progress(options.run.progress, numbers.size(), "slices");
    for (const int slice : numbers) {
        if (interrupted())
            throw FrameError(
                fmt::format("interrupted after {} of {} slices; the same command goes on", made, numbers.size()));
        slices.fill(slice, values);
        std::vector<Attribute> attributes = slices.attributes;
        attributes.emplace_back("eikonal/z", slices.position(slice));
        write_float_exr(outputs.find("-o")->at(slice), window, window, kNames, values, attributes);
        ++made;
        progress.step();
    }
    return 0;
}

int run(const PresetsOptions&) {
    for (const Preset& preset : list_presets()) fmt::print("{:<14} {}\n", preset.name, preset.description);
    return 0;
}

int run(const Information& information) {
    fmt::print("{}", information.text);
    return 0;
}

}  // namespace eikonal
