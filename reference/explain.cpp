#include "reference/explain.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>

namespace eikonal::reference {
namespace {

struct Figures {
    double steps = 0, error = 0, rms = 0;  ///< means
    double largest = 0;
};

Figures figures(const RenderedFrame& f) {
    Figures r;
    for (std::size_t i = 0; i < f.u.size(); ++i) {
        const double d2 = double{f.u[i]} * f.u[i] + double{f.v[i]} * f.v[i];
        r.steps += f.steps[i];
        r.error += f.error[i];
        r.rms += d2;
        r.largest = std::max(r.largest, std::sqrt(d2));
    }
    r.steps /= f.width;
    r.error /= f.width;
    r.rms = std::sqrt(r.rms / f.width);
    return r;
}

/// "2.5", or "2.5 to 80" where what is known leaves that open.
std::string between(double low, double high) {
    return high > 1.01 * low ? fmt::format("{:.3g} to {:.3g}", low, high) : fmt::format("{:.3g}", low);
}

}  // namespace

void explain(const Renderer& renderer, const Scene& scene, const RenderSettings& settings,
             const std::vector<int>& frames, int threads) {
    const double area = static_cast<double>(renderer.width()) * renderer.height();
    fmt::print("picture: {} x {} pixels, {} sample{} a pixel, {} frame{} from {}\n", renderer.width(),
               renderer.height(), settings.samples, settings.samples == 1 ? "" : "s", frames.size(),
               frames.size() == 1 ? "" : "s", frames.front());
    fmt::print("scene: {} object{}, {}\n", scene.objects.size(), scene.objects.size() == 1 ? "" : "s",
               scene.light ? "lit by its sun" : "which show their own colour");
    if (settings.straight)
        fmt::print("air: none, rays are straight\n");
    else if (scene.media.empty())
        fmt::print("air: the scene has no medium, nothing bends\n");
    for (const std::string& note : renderer.notes()) fmt::print("{}\n", note);
    ProbeLimits limits;
    limits.first = 16;
    limits.most = static_cast<int>(std::min<double>(kMostExplained, std::max<double>(area, limits.first)));
    limits.seconds = kExplainedSeconds;
    limits.samples = kExplainedSamples;
    const Probe p = renderer.probe(frames.front(), limits);
    const int budget = settings.rays.step_budget;
    if (!settings.straight) {
        const Figures f = figures(p.pixels);
        fmt::print("rays: {}, tolerance {:g} px; {:.3g} steps each\n", name_of(settings.rays.integrator),
                   settings.rays.tolerance_px, f.steps);
        if (const std::size_t n = p.pixels.trapped())
            fmt::print(
                "rays: {} of {} tried did not end within {} steps: they are trapped, curl up, or have a long "
                "way to go; --step-budget ends them at {}\n",
                n, p.pixels.width, p.step_limit, budget);
        if (const std::size_t n = p.pixels.without_index())
            fmt::print("rays: {} of {} tried came to where n <= 0\n", n, p.pixels.width);
        fmt::print("displacement: {:.3g} px rms, {:.3g} px at most, in {} pixels of frame {}\n", f.rms, f.largest,
                   p.pixels.width, frames.front());
        fmt::print("error: {:.2g} px on average, as the rays estimate it\n", f.error);
    }
    const auto frame_seconds = [&](double pixels) {
        std::array<double, 2> time = p.time(pixels, settings.samples, budget);
        for (double& t : time) t += p.setup;
        return time;
    };
    const auto [low, high] = frame_seconds(area);
    const auto [least, most] = p.time(1, settings.samples, budget);
    const auto count = static_cast<double>(frames.size());
    fmt::print("time: about {} s a frame on {} thread{} ({} µs of processor time a pixel), {} s in all{}\n",
               between(low, high), threads, threads == 1 ? "" : "s",
               between(1e6 * threads * least, 1e6 * threads * most), between(count * low, count * high),
               settings.light_rays > 0 ? ", and what --light-rays take" : "");
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    fmt::print("memory: {:.0f} MB\n", static_cast<double>(usage.ru_maxrss) / 1e3);
}

}  // namespace eikonal::reference
