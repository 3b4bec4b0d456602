#include "reference/app/explain.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>

namespace eikonal::reference {
namespace {

struct Figures {
    std::size_t ended = 0;                 ///< number of rays that ended; error and displacement are theirs
    double steps = 0, error = 0, rms = 0;  ///< means over the rays
    double largest = 0;
};

Figures figures(const RenderedFrame& f) {
    Figures r;
    for (std::size_t i = 0; i < f.u.size(); ++i) {
        const double d2 = double{f.u[i]} * f.u[i] + double{f.v[i]} * f.v[i];
        r.steps += f.steps[i];
        if (f.id[i] < 0) continue;
        ++r.ended;
        r.error += f.error[i];
        r.rms += d2;
        r.largest = std::max(r.largest, std::sqrt(d2));
    }
    r.steps /= f.width;
    if (r.ended == 0) return r;
    const auto count = static_cast<double>(r.ended);
    r.error /= count;
    r.rms = std::sqrt(r.rms / count);
    return r;
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
    limits.steps = kExplainedSteps;
    const Probe p = renderer.probe(frames.front(), limits);
    if (!settings.straight) {
        const Figures f = figures(p.pixels);
        fmt::print("rays: {}, tolerance {:g} px; {:.3g} steps each\n", name_of(settings.rays.integrator),
                   settings.rays.tolerance_px, f.steps);
        if (const std::size_t n = p.pixels.trapped() - p.pixels.unfinished())
            fmt::print("rays: {} of {} tried go round and round: they are ended, their pixels black\n", n,
                       p.pixels.width);
        if (const std::size_t n = p.pixels.unfinished())
            fmt::print(
                "rays: {} of {} tried have a way to go that takes more than {} steps, {} of them maybe more than the "
                "{} of --step-budget\n",
                n, p.pixels.width, p.step_limit, p.beyond, settings.rays.step_budget);
        if (const std::size_t n = p.pixels.without_index())
            fmt::print("rays: {} of {} tried came to where n <= 0\n", n, p.pixels.width);
        if (f.ended == 0) {
            fmt::print("displacement: unknown, none of the {} rays tried in frame {} came to an end\n", p.pixels.width,
                       frames.front());
        } else {
            fmt::print("displacement: {:.3g} px rms, {:.3g} px at most, in {} pixels of frame {}\n", f.rms, f.largest,
                       f.ended, frames.front());
            fmt::print("error: {:.2g} px on average, as the rays estimate it\n", f.error);
        }
    }
    const double seconds = p.setup + p.time(area, settings.samples);
    fmt::print("time: about {:.3g} s a frame on {} thread{} ({:.3g} µs of processor time a pixel), {:.3g} s in all{}\n",
               seconds, threads, threads == 1 ? "" : "s", 1e6 * threads * p.time(1, settings.samples),
               static_cast<double>(frames.size()) * seconds,
               settings.light_rays > 0 ? ", and what --light-rays take" : "");
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    fmt::print("memory: {:.0f} MB\n", static_cast<double>(usage.ru_maxrss) / 1e3);
}

}  // namespace eikonal::reference
