/// One 512 x 512 frame in memory: displacement map and warp (cubic, RGBA float), by model. Wall-clock time of one frame
/// on all processors, every frame at another instant, so that nothing is reused. The limit is 5 ms.
#include <benchmark/benchmark.h>

#include <string>

#include "warp/displace/displacer.h"
#include "warp/resample/resample.h"

namespace {

using namespace eikonal;

constexpr int kSize = 512;

/// The paper's lattice of 32⁴ seen by parallel rays, or the default screens in perspective.
Scene scene_of(const std::string& form) {
    const std::string turbulence = "[[medium]]\ntype = \"turbulence\"\ncn2 = 1e-12\n";
    if (form == "screens")
        return parse_scene(
            turbulence + "form = \"screens\"\nouter_scale = 2\ninner_scale = 0.05\n[camera]\nhorizontal_fov = 4\n",
            "bench");
    return parse_scene(turbulence +
                           "form = \"lattice\"\nouter_scale = 1\ninner_scale = 0.3\nlattice = [32, 32, 32, 32]\nperiod "
                           "= [4, 4, 4, 4]\n"
                           "[camera]\nprojection = \"orthographic\"\nwidth = 4\n",
                       "bench");
}

void frame(benchmark::State& state, const std::string& form, Model model, double distance) {
    DisplacerSettings settings;
    settings.width = settings.height = kSize;
    settings.far = distance;
    settings.model = model;
    const Displacer displacer(scene_of(form), settings);
    const Window window{0, 0, kSize, kSize};
    std::vector<float> in(4 * kSize * kSize), out(in.size()), uv(2 * kSize * kSize);
    for (std::size_t i = 0; i < in.size(); ++i) in[i] = static_cast<float>((i * 2654435761U) >> 16 & 255) / 255;
    int f = 0;
    for (auto _ : state) {
        displacer.at(++f, distance, distance).map(window, distance, DepthMeeting::March, uv.data());
        resample({in.data(), window, 4, 4 * kSize}, {uv.data(), window, 2 * kSize}, {out.data(), window, 4, 4 * kSize},
                 {});
        benchmark::DoNotOptimize(out.data());
    }
}

BENCHMARK_CAPTURE(frame, table, "lattice", Model::Table, 4.0)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(frame, spectral, "lattice", Model::Spectral, 4.0)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(frame, screens, "screens", Model::Screens, 300.0)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(frame, first_order, "lattice", Model::FirstOrder, 4.0)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
