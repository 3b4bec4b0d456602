/// eikonal::resample against cv::remap of the same kind, 1920 x 1080 RGBA float, a smooth shimmer of rms 2 px.
///
/// Estimator. Other load on the machine changes over seconds, so absolute times of two separate benchmarks cannot be
/// compared. Each iteration here times one call of ours and one of the peer, back to back and in alternating order. The
/// counter "ratio" is the median over iterations of (ours / peer); ours_ms and peer_ms are medians likewise.
/// "cpu_ratio" is the same of processor time. Other programs do not count in it, so it is the one to read on a busy
/// machine with one thread. With more threads the waiting of the schedulers counts as work. Both write into buffers
/// that were touched before, with equal numbers of threads. The peer gets its absolute positions (CV_32FC2) ready made.
/// It rounds them to 1/32 pixel; ours does not. Filters without a peer report ours_ms only. Targets: ratio <= 0.5 for
/// cubic, <= 0.6 for bilinear.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "warp/resample/resample.h"

namespace {

using namespace eikonal;

constexpr int width = 1920, height = 1080;
constexpr Window window{0, 0, width, height};

/// Picture, displacement and the peer's positions, made once.
struct Plate {
    std::vector<float> pixels = std::vector<float>(std::size_t{width} * height * 4);
    std::vector<float> displacement = std::vector<float>(std::size_t{width} * height * 2);
    cv::Mat positions = cv::Mat(height, width, CV_32FC2);

    Plate() {
        std::mt19937 random(1);
        std::uniform_real_distribution<float> uniform;
        for (float& p : pixels) p = uniform(random);

        // Gradient of a potential of 24 random waves with wavelengths of 24 ... 400 px, rms 2 px of |d|.
        const std::size_t n = std::size_t{width} * height;
        std::vector<double> phase(n);
        double sum = 0;
        for (int m = 0; m < 24; ++m) {
            const double wavelength = 24 * std::pow(400.0 / 24, m / 23.0),
                         angle = 2 * std::numbers::pi * uniform(random);
            const double k = 2 * std::numbers::pi / wavelength, kx = k * std::cos(angle), ky = k * std::sin(angle);
            const double offset = 2 * std::numbers::pi * uniform(random), amplitude = std::pow(wavelength, 0.8) / k;
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const double c = amplitude * std::cos(kx * x + ky * y + offset);
                    float* d = &displacement[2 * (std::size_t{width} * y + x)];
                    d[0] += static_cast<float>(c * kx);
                    d[1] += static_cast<float>(c * ky);
                }
        }
        for (float v : displacement) sum += double{v} * v;
        const double gain = 2 / std::sqrt(sum / static_cast<double>(n));
        for (float& v : displacement) v = static_cast<float>(v * gain);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const float* d = &displacement[2 * (std::size_t{width} * y + x)];
                positions.at<cv::Vec2f>(y, x) = {static_cast<float>(x) + d[0], static_cast<float>(y) + d[1]};
            }
    }
};

Plate& plate() {
    static Plate p;
    return p;
}

/// Milliseconds on the clock and of the processor.
struct Time {
    double wall = 0, cpu = 0;
};

Time measure(auto&& call) {
    const std::clock_t cpu = std::clock();
    const auto start = std::chrono::steady_clock::now();
    call();
    const double wall = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return {wall, 1000.0 * static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC};
}

double median(std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
}

constexpr int no_peer = -1;

void compare(benchmark::State& state, ResampleOptions options, int interpolation) {
    const int threads = static_cast<int>(state.range(0));
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    cv::setNumThreads(threads);
    Plate& p = plate();
    std::vector<float> result(p.pixels.size());
    const ImageView in{p.pixels.data(), window, 4, width * 4};
    const MapView map{p.displacement.data(), window, width * 2};
    const MutableImageView out{result.data(), window, 4, width * 4};
    const cv::Mat source(height, width, CV_32FC4, p.pixels.data());
    cv::Mat target(height, width, CV_32FC4, cv::Scalar::all(0));

    const auto run_ours = [&] { resample(in, map, out, options); };
    const auto run_peer = [&] {
        if (interpolation != no_peer)
            cv::remap(source, target, p.positions, cv::noArray(), interpolation, cv::BORDER_REFLECT);
    };
    run_ours();
    run_peer();
    std::vector<double> ours, peer, ratio, cpu_ratio;
    bool ours_first = true;
    for (auto _ : state) {
        Time mine, theirs;
        if (ours_first) mine = measure(run_ours);
        theirs = measure(run_peer);
        if (!ours_first) mine = measure(run_ours);
        ours_first = !ours_first;
        ours.push_back(mine.wall);
        peer.push_back(theirs.wall);
        ratio.push_back(mine.wall / theirs.wall);
        cpu_ratio.push_back(mine.cpu / theirs.cpu);
        state.SetIterationTime(mine.wall / 1000);
    }
    state.counters["ours_ms"] = median(ours);
    if (interpolation == no_peer) return;
    state.counters["peer_ms"] = median(peer);
    state.counters["ratio"] = median(ratio);
    state.counters["cpu_ratio"] = median(cpu_ratio);
}

void threads(benchmark::internal::Benchmark* b) {
    b->Arg(1)->Arg(2)->ArgName("threads")->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(31);
}

BENCHMARK_CAPTURE(compare, bilinear, ResampleOptions{Filter::Bilinear}, cv::INTER_LINEAR)->Apply(threads);
BENCHMARK_CAPTURE(compare, cubic, ResampleOptions{Filter::Cubic}, cv::INTER_CUBIC)->Apply(threads);
BENCHMARK_CAPTURE(compare, lanczos3, ResampleOptions{Filter::Lanczos3}, no_peer)->Apply(threads);
BENCHMARK_CAPTURE(compare, area, ResampleOptions{Filter::Area}, no_peer)->Apply(threads);
BENCHMARK_CAPTURE(compare, cubic_dispersed,
                  ResampleOptions{Filter::Cubic, Edge::Mirror, {0.9945f, 1.0f, 1.0097f, 1.0f}}, no_peer)
    ->Apply(threads);

}  // namespace

BENCHMARK_MAIN();
