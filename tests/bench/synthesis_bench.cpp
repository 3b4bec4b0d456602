// Synthesis of the 4-D force field (n, F.x, F.y, F.z on 32⁴), compared with the same four transforms alone.
//
// Synthesis = drawing every amplitude + four spectra + four inverse transforms, memory included. The peers are the four
// transforms of a spectrum that is filled already. One peer uses our own plans (portable codelets, noise/math/fft.h).
// The other uses the plan that FFTW makes by default, whose SIMD codelets are faster but round differently from one
// processor to the next. All three run in turn within one iteration, on one thread, and their processor time is
// measured. A busy machine therefore slows all alike. The results are medians of the ratios.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <ctime>

#include "noise/turbulence/lattice/lattice.h"
#include "noise/turbulence/lattice/lattice_instant.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {
namespace {

constexpr std::array kComponents{Component::Index, Component::ForceX, Component::ForceY, Component::ForceZ};

template <class F>
double seconds(F&& f) {
    const auto now = [] {
        timespec t{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
        return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
    };
    const double start = now();
    f();
    return now() - start;
}

double median(std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
}

void BM_SynthesisAgainstTransforms(benchmark::State& state) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    TurbulenceSpec spec;
    spec.alpha = 1;
    const LatticeGeometry g{{32, 32, 32, 32}, {2, 2, 2, 4}};
    const std::array dims{32, 32, 32, 32};
    const FftPlan ours(FftPlan::Kind::ComplexToReal, dims);
    FftVector<complex32> in(ours.spectrum_size());
    FftVector<float> out(ours.sample_size());
    fftwf_plan simd = fftwf_plan_dft_c2r(4, dims.data(), reinterpret_cast<fftwf_complex*>(in.data()), out.data(),
                                         FFTW_ESTIMATE | FFTW_DESTROY_INPUT);
    const LatticeField filled(spec, g);
    std::vector<double> against_ours, against_simd, synthesis, transforms;
    for (auto _ : state) {
        double own = 0, default_plan = 0;
        for (const Component c : kComponents) {
            filled.period_spectrum(c, in.data());
            own += seconds([&] { ours.execute(in.data(), out.data()); });
            filled.period_spectrum(c, in.data());
            default_plan += seconds([&] { fftwf_execute(simd); });
        }
        const double all = seconds([&] {
            const LatticeField field(spec, g);
            PeriodSynthesis synthesis_of(field);
            for (const Component c : kComponents) benchmark::DoNotOptimize(synthesis_of(c).data());
        });
        state.SetIterationTime(all);
        synthesis.push_back(all);
        transforms.push_back(own);
        against_ours.push_back(all / own);
        against_simd.push_back(all / default_plan);
    }
    fftwf_destroy_plan(simd);
    state.counters["ratio_to_same_plans"] = median(against_ours);
    state.counters["ratio_to_default_plans"] = median(against_simd);
    state.counters["synthesis_ms"] = median(synthesis) * 1e3;
    state.counters["transforms_ms"] = median(transforms) * 1e3;
}
BENCHMARK(BM_SynthesisAgainstTransforms)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(31);

/// An instant of 64³ × 32: what every frame costs before its displacement.
void BM_SpectrumAt(benchmark::State& state) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    TurbulenceSpec spec;
    spec.alpha = 1;
    spec.velocity = {0, 0.3, 0};
    const LatticeField field(spec, {{64, 64, 64, 32}, {2, 2, 2, 4}});
    const auto frame = static_cast<double>(state.range(0));
    for (auto _ : state) benchmark::DoNotOptimize(field.spectrum_at(frame / 24).data());
}
BENCHMARK(BM_SpectrumAt)->Arg(1)->Arg(5000)->Unit(benchmark::kMillisecond);

void BM_Instant(benchmark::State& state) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    TurbulenceSpec spec;
    spec.alpha = 1;
    const LatticeField field(spec, {{64, 64, 64, 32}, {2, 2, 2, 4}});
    for (auto _ : state) benchmark::DoNotOptimize(LatticeInstant(field, 1.0).upper_bound());
}
BENCHMARK(BM_Instant)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace eikonal

BENCHMARK_MAIN();
