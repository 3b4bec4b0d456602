// Cost of a frame of evolving thin screens and of sampling them, compared with FFTW's transforms of the same sizes.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <array>
#include <vector>

#include "noise/turbulence/gradient_noise/gradient_noise.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "noise/turbulence/screens/screens.h"

namespace {

using namespace eikonal;

/// A 1080p view of 40 degrees over 100 m of the default medium.
const ShotView kView{true, 100, 0.364, 0.205, 0.728 / 1920, 0.02, 24};

void screens_frame(benchmark::State& state) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const TurbulenceSpec spec;
    const ScreenField field(spec, layout_screens(spec, kView), {1, 0, 0}, {0, 1, 0});
    double t = 0;
    for (auto _ : state) benchmark::DoNotOptimize(field.at(t += 1.0 / 24));
}
BENCHMARK(screens_frame)->Unit(benchmark::kMillisecond);

void screens_transforms_alone(benchmark::State& state) {
    const TurbulenceSpec spec;
    const auto screens = layout_screens(spec, kView);
    for (auto _ : state)
        for (const ScreenGeometry& s : screens) {
            state.PauseTiming();
            const FftPlan plan(FftPlan::Kind::ComplexToReal, std::array{s.nx, s.ny});
            FftVector<complex32> in(plan.spectrum_size());
            FftVector<float> out(plan.sample_size());
            state.ResumeTiming();
            plan.execute(in.data(), out.data());
            benchmark::DoNotOptimize(out.data());
        }
}
BENCHMARK(screens_transforms_alone)->Unit(benchmark::kMillisecond);

void screens_build(benchmark::State& state) {
    const TurbulenceSpec spec;
    for (auto _ : state) benchmark::DoNotOptimize(ScreenField(spec, layout_screens(spec, kView), {1, 0, 0}, {0, 1, 0}));
}
BENCHMARK(screens_build)->Unit(benchmark::kMillisecond);

/// Nanoseconds per point on one lattice of 512². Argument: points per cell, in hundredths.
void spline_gradients(benchmark::State& state) {
    FftVector<complex32> spectrum(512 * 257);
    spectrum[3 * 257 + 5] = 1;
    const PeriodicSpline2 spline(std::move(spectrum), 512, 512);
    const double step = 100.0 / (512.0 * static_cast<double>(state.range(0)));
    std::vector<float> uv(2 * 1920);
    const auto columns = spline.columns(0.1, step, 1920);
    double y = 0;
    for (auto _ : state) {
        spline.add_row_gradients(columns, y += 0.002, 1, uv.data());
        benchmark::DoNotOptimize(uv.data());
    }
    state.SetItemsProcessed(state.iterations() * 1920);
}
BENCHMARK(spline_gradients)->Arg(70)->Arg(400)->Arg(10000);

void gradient_noise_sample(benchmark::State& state) {
    const GradientNoiseField field(TurbulenceSpec{});
    double x = 0;
    for (auto _ : state) benchmark::DoNotOptimize(field.sample({x += 0.01, 0.2, 0.3}, 1));
}
BENCHMARK(gradient_noise_sample);

}  // namespace
