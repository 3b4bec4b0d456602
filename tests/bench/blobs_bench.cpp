/// Time of the displacement map of one 1080p frame through hot blobs, in memory. The question is whether it is
/// proportional to the screen area that blobs cover. It is wall-clock time on all processors. Blobs of one size stand
/// at random in the middle part of the picture, at many depths, in front of a wall. `covered` is the part of the
/// picture's pixels that they move. `discs` is the sum of the areas that each covers alone, in pictures, which is the
/// work. Plot: noise/blobs/blob_cost.gp.
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>

#include "noise/blobs/blobs.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/math/random.h"
#include "warp/displace/displacer.h"
#include "warp/displace/media/blobs/seen_blobs.h"

namespace {

using namespace eikonal;

constexpr int kWidth = 1920, kHeight = 1080;
constexpr double kWall = 30, kFocal = 2400;  // [m], [px]

/// Arguments: number of blobs; σ in thousandths of a metre; part of the picture, in percent of its width and height.
void blobs(benchmark::State& state) {
    const auto count = static_cast<std::uint64_t>(state.range(0));
    const double sigma = 1e-3 * static_cast<double>(state.range(1)), part = 1e-2 * static_cast<double>(state.range(2));
    Scene scene;
    scene.camera.horizontal_fov = 2 * std::atan(kWidth / (2 * kFocal)) * 57.29577951308232;
    const dvec3 eye = scene.camera.position;
    const RandomStream random(7, "blobs_bench");
    BlobsSpec spec;
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto uniform = [&](std::uint64_t k) { return random.uniform(3 * i + k); };
        const double distance = 10 + 10 * uniform(2);
        const double x = part * kWidth * (uniform(0) - 0.5), y = part * kHeight * (uniform(1) - 0.5);
        spec.blobs.push_back({eye + distance * dvec3(x / kFocal, y / kFocal, -1), sigma, 700});
    }
    scene.media.push_back(spec);
    DisplacerSettings settings;
    settings.width = kWidth;
    settings.height = kHeight;
    settings.far = kWall;
    const Displacer displacer(scene, settings);
    const PixelWindow window{0, 0, kWidth, kHeight};
    std::vector<float> uv(2 * window.area());
    const Displacer::Instant instant = displacer.at(1, kWall, kWall);
    for (auto _ : state) {
        instant.map(window, kWall, DepthMeeting::March, uv.data());
        benchmark::DoNotOptimize(uv.data());
    }
    std::size_t moved = 0;
    for (std::size_t i = 0; i < window.area(); ++i) moved += uv[2 * i] != 0 || uv[2 * i + 1] != 0;
    double discs = 0;
    const SeenBlobs bends(BlobCloud(spec, index_law(scene.optics), "blobs").at(0), 1, displacer.camera(1), kWall, 1);
    for (const SeenBlob& b : bends.seen()) {
        const double radius = b.reach * kFocal / b.forward;
        discs += 3.141592653589793 * radius * radius;
    }
    state.counters["covered"] = static_cast<double>(moved) / static_cast<double>(window.area());
    state.counters["discs"] = discs / static_cast<double>(window.area());
}

BENCHMARK(blobs)
    ->ArgNames({"blobs", "sigma_mm", "part"})
    ->ArgsProduct({{10000}, {5}, {6, 12, 25, 50, 75, 100}})
    ->ArgsProduct({{10000}, {10, 20, 40, 80}, {100}})
    ->ArgsProduct({{100, 300, 1000, 3000}, {20}, {100}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
