#include "reference/explain.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>

namespace eikonal::reference {
namespace {

using Clock = std::chrono::steady_clock;

struct Probe {
    double pixels = 0, seconds = 0;
    double steps = 0, error = 0, rms = 0, largest = 0;  ///< means, but for the last
    double unanswered = 0;
};

Probe measure(const Renderer& renderer, int frame) {
    Probe p;
    const auto start = Clock::now();
    const RenderedFrame f = renderer.probe(frame, std::max(1, renderer.tile_count() / kExplainedTiles));
    p.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    for (std::size_t i = 0; i < f.depth.size(); ++i) {
        if (f.depth[i] == 0) continue;
        ++p.pixels;
        if (f.u.empty()) continue;
        const double d2 = double{f.u[i]} * f.u[i] + double{f.v[i]} * f.v[i];
        p.steps += f.steps[i];
        p.error += f.error[i];
        p.rms += d2;
        p.largest = std::max(p.largest, std::sqrt(d2));
        if (f.id[i] < 0) ++p.unanswered;
    }
    p.steps /= p.pixels;
    p.error /= p.pixels;
    p.rms = std::sqrt(p.rms / p.pixels);
    return p;
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
    const Probe p = measure(renderer, frames.front());
    if (!settings.straight) {
        fmt::print("rays: {}, tolerance {:g} px; {:.3g} steps each, {:.2g} % end without an answer\n",
                   name_of(settings.rays.integrator), settings.rays.tolerance_px, p.steps,
                   100 * p.unanswered / p.pixels);
        fmt::print("displacement: {:.3g} px rms, {:.3g} px at most, in {:.0f} pixels of frame {}\n", p.rms, p.largest,
                   p.pixels, frames.front());
        fmt::print("error: {:.2g} px on average, as the rays estimate it\n", p.error);
    }
    const double frame_seconds = p.seconds * area / p.pixels;
    fmt::print("time: about {:.3g} s a frame on {} thread{} ({:.3g} µs of processor time a pixel), {:.3g} s in all\n",
               frame_seconds, threads, threads == 1 ? "" : "s", 1e6 * threads * p.seconds / p.pixels,
               frame_seconds * static_cast<double>(frames.size()));
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    fmt::print("memory: {:.0f} MB\n", static_cast<double>(usage.ru_maxrss) / 1e3);
}

}  // namespace eikonal::reference
