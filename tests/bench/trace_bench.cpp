// Cost of a bent ray compared with that of a straight ray through the same objects, in one run. The scene is a road
// seen through a long lens, with signs along it, and each kind of air over it. One call is one ray through a pixel's
// centre, on one thread.
//
// `straight` is one Embree ray with all the results that the tracer needs of it, from the same list of rays. `frame` is
// a whole picture with colour, as `eikonal-trace render` makes it. Take ratios of medians of one run:
// --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true.
#include <benchmark/benchmark.h>
#include <oneapi/tbb/global_control.h>

#include <glm/geometric.hpp>
#include <memory>

#include "noise/blobs/blobs_spec.h"
#include "noise/medium/medium_spec.h"
#include "noise/surface/surface_spec.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "reference/trace/bent_ray.h"
#include "reference/trace/render.h"
#include "warp/scene/background.h"

namespace {

using namespace eikonal;
using namespace eikonal::reference;

constexpr int kWidth = 96, kHeight = 54;
/// Rays are those of a picture of 1080p.
constexpr double kPixels = 1920.0 / kWidth;

ObjectSpec ground() {
    ObjectSpec plane;
    plane.size = {10, 10};
    return plane;
}

ObjectSpec sign(double x, double z) {
    ObjectSpec quad;
    quad.shape = ObjectShape::Quad;
    quad.origin = {x, 1, z};
    quad.normal = {0, 0, 1};
    quad.size = {2, 2};
    return quad;
}

Scene road() {
    Scene scene;
    scene.file = "road.toml";
    scene.camera.resolution = {kWidth, kHeight};
    scene.camera.position = {0, 1.5, 0};
    scene.camera.look_at = {0, 1.2, -100};
    scene.camera.horizontal_fov = 8;
    scene.plate.far = 500;
    scene.objects.push_back(ground());
    for (int i = 0; i < 12; ++i) scene.objects.push_back(sign(i % 2 ? 2.5 : -2.5, -30.0 * (i + 1)));
    // A hill behind, so that every ray ends.
    ObjectSpec hill = sign(0, -500);
    hill.size = {400, 400};
    scene.objects.push_back(hill);
    return scene;
}

enum AirKind { kMirage, kBlobs, kLattice, kScreens };

MediumSpec medium(AirKind kind) {
    switch (kind) {
        case kMirage: {
            SurfaceSpec surface;
            surface.surface_temperature = 330;
            surface.dropoff = 0.05;
            return surface;
        }
        case kBlobs: {
            BlobsSpec blobs;
            for (int i = 0; i < 200; ++i) {
                const auto spread = [i](double step) { return i * step - static_cast<int>(i * step); };
                blobs.blobs.push_back({{4 * spread(0.618034) - 2, 2 * spread(0.754878), -10 - 80 * spread(0.569840)},
                                       0.1 + 0.1 * spread(0.414214),
                                       600});
            }
            return blobs;
        }
        case kLattice: {
            TurbulenceSpec turbulence;
            turbulence.form = TurbulenceForm::Lattice;
            turbulence.lattice = {{64, 64, 64, 1}};
            turbulence.period = {{16, 16, 16, 1}};
            turbulence.alpha = 0;
            turbulence.inner_scale = 0.5;
            turbulence.outer_scale = 4;
            return turbulence;
        }
        case kScreens:
            break;
    }
    return TurbulenceSpec{};
}

struct Case {
    Scene scene;
    std::unique_ptr<SceneAir> air;
    std::unique_ptr<AirInstant> field;
    std::unique_ptr<Geometry> geometry;
    TraceSettings settings;
    std::vector<CameraRay> rays;

    Case(AirKind kind, Integrator integrator, double tolerance_px) : scene(road()) {
        scene.media = {medium(kind)};
        const double f_px = kPixels * CameraPath(scene.camera, kWidth, kHeight).reference().f_px;
        air = std::make_unique<SceneAir>(scene, RaySettings{.integrator = integrator, .tolerance_px = tolerance_px},
                                         RayEnds{far_of_scene(scene), tolerance_px / f_px, true});
        field = std::make_unique<AirInstant>(air->at(scene.time.first_frame));
        const Camera camera = air->path().reference();
        geometry = std::make_unique<Geometry>(scene, camera.position);
        settings = air->trace_settings(camera);
        settings.pixel /= kPixels;
        settings.start_at(*field, camera.position);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                CameraRay ray = camera_ray(camera, x + 0.5, y + 0.5);
                ray.direction = glm::normalize(ray.direction);
                rays.push_back(ray);
            }
    }
};

void straight(benchmark::State& state) {
    const Case c(kMirage, Integrator::Adaptive, 0.01);
    for (auto _ : state)
        for (const CameraRay& ray : c.rays)
            benchmark::DoNotOptimize(c.geometry->intersect(ray.origin, ray.direction, 0, c.settings.far));
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(c.rays.size()));
}

void bent(benchmark::State& state, AirKind kind, Integrator integrator, double tolerance_px) {
    const Case c(kind, integrator, tolerance_px);
    double steps = 0, error = 0;
    for (auto _ : state) {
        steps = error = 0;
        for (const CameraRay& ray : c.rays) {
            const BentHit end = trace(*c.field, c.geometry.get(), ray.origin, ray.direction, c.settings);
            steps += end.steps;
            error += end.error_px;
        }
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(c.rays.size()));
    state.counters["steps"] = steps / static_cast<double>(c.rays.size());
    state.counters["error_px"] = error / static_cast<double>(c.rays.size());
}

/// A picture of 16 samples a pixel, one thread.
void frame(benchmark::State& state, bool straight, Integrator integrator) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    Scene scene = road();
    scene.media = {medium(kMirage)};
    RenderSettings settings;
    settings.straight = straight;
    settings.rays.integrator = integrator;
    settings.rays.tolerance_px = 0.01 / kPixels;
    const Renderer renderer(scene, settings);
    for (auto _ : state) benchmark::DoNotOptimize(renderer.render(1));
}

const int kRegistered = [] {
    const auto unit = benchmark::kMicrosecond;
    benchmark::RegisterBenchmark("straight", straight)->Unit(unit);
    const std::pair<const char*, AirKind> airs[] = {
        {"mirage", kMirage}, {"blobs", kBlobs}, {"lattice", kLattice}, {"screens", kScreens}};
    const std::pair<const char*, Integrator> integrators[] = {{"first-order", Integrator::FirstOrder},
                                                              {"adaptive", Integrator::Adaptive}};
    for (const auto& [air, kind] : airs)
        for (const auto& [name, integrator] : integrators)
            benchmark::RegisterBenchmark((std::string(air) + "/" + name).c_str(), bent, kind, integrator, 0.01)
                ->Unit(unit);
    for (const double tolerance : {1.0, 0.1, 0.01, 1e-3, 1e-4, 1e-5, 1e-6})
        for (const auto& [air, kind] : airs)
            benchmark::RegisterBenchmark(("tolerance/" + std::string(air) + "/" + std::to_string(tolerance)).c_str(),
                                         bent, kind, Integrator::Adaptive, tolerance)
                ->Unit(unit);
    benchmark::RegisterBenchmark("frame/straight", frame, true, Integrator::Adaptive)->Unit(benchmark::kMillisecond);
    for (const auto& [name, integrator] : integrators)
        benchmark::RegisterBenchmark((std::string("frame/mirage/") + name).c_str(), frame, false, integrator)
            ->Unit(benchmark::kMillisecond);
    return 0;
}();

}  // namespace
