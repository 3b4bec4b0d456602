/// What a frame will cost and how exact it will be, found by tracing a few rays that are spread over it.
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>

#include "reference/trace/frame_air.h"
#include "reference/trace/render.h"
#include "reference/trace/sampler.h"

namespace eikonal::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// A ray counts as wandering if it ends nearer to its start than this part of its length.
constexpr double kStraightEnough = 0.8;
/// The way ahead of a ray is sampled at steps of at least 1/kStrides of the distance covered.
constexpr double kStrides = 16;

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// How many of the field's longest steps a straight ray takes between the distances `from` and `to` [m].
double longest_steps(const AirInstant& field, const dvec3& origin, const dvec3& direction, double from, double to) {
    const double crossing = 1e-9 * (to + glm::length(origin));
    double count = 0;
    for (double w = from; w < to;) {
        const dvec3 at = origin + w * direction;
        double way = field.clear_way(at, direction);
        if (way > 0) {
            count += 1;
        } else {
            const double longest = field.longest_step(at, direction);
            way = std::min({std::max(longest, (w - from) / kStrides), field.way_to_edge(at, direction), to - w});
            count += way / longest;
        }
        w += way + crossing;
    }
    return count;
}

}  // namespace

Probe Renderer::probe(int frame, const ProbeLimits& limits) const {
    const auto start = Clock::now();
    const Camera camera = path_.at(frame);
    std::optional<FrameAir> air = air_at(frame, camera);
    const double setup = since(start);
    Probe probe = try_rays(camera, frame, air ? &*air : nullptr, limits);
    probe.setup = setup;
    return probe;
}

Probe Renderer::try_rays(const Camera& camera, int frame, FrameAir* air, const ProbeLimits& limits) const {
    Probe probe;
    probe.samples = std::min(settings_.colour ? settings_.samples : 0, limits.samples);
    probe.pixels = planes(limits.most, 1, probe.samples > 0);
    if (air) air->trace.tried_steps = limits.steps;
    if (air) probe.step_limit = air->trace.most_steps();
    std::vector<double> to_come(static_cast<std::size_t>(limits.most), 0.0);
    const auto start = Clock::now();
    int done = 0;
    for (int until = limits.first; done < until; until = std::min(2 * until, limits.most)) {
        tbb::parallel_for(done, until, [&](int i) {
            const dvec2 place = spread_point(static_cast<std::uint32_t>(i), 0);
            const int x = static_cast<int>(place.x * width_), y = static_cast<int>(place.y * height_);
            const auto at = static_cast<std::size_t>(i);
            const BentHit end = render_pixel(camera, frame, x, y, air, probe.samples, at, probe.pixels);
            if (end.end == BentHit::End::Unfinished) to_come[at] = steps_to_come(camera, x, y, *air, end);
        });
        done = until;
        probe.seconds = since(start);
        if (probe.seconds > limits.seconds) break;
    }
    if (air) air->trace.tried_steps = TraceSettings().tried_steps;
    for (const double steps : to_come) {
        const double most = air ? air->trace.step_budget - probe.step_limit : 0;
        probe.steps_to_come += std::min(steps, most);
        if (steps > most) ++probe.beyond;
    }
    probe.pixels.width = done;
    RenderedFrame& p = probe.pixels;
    for (auto* plane : {&p.depth, &p.length, &p.u, &p.v, &p.id, &p.steps, &p.error, &p.magnification})
        if (!plane->empty()) plane->resize(static_cast<std::size_t>(done));
    return probe;
}

/// Traces the rays of a probe that came to an end again, with a finer tolerance, and compares the results.
void Renderer::try_again(const Camera& camera, int frame, FrameAir& air, Probe& probe) const {
    const double tolerance = air.trace.tolerance_px;
    air.trace.tolerance_px *= kFinerTried;
    ProbeLimits limits;
    limits.first = limits.most = probe.pixels.width;
    const Probe finer = try_rays(camera, frame, &air, limits);
    air.trace.tolerance_px = tolerance;
    for (std::size_t i = 0; i < probe.pixels.u.size(); ++i) {
        const RenderedFrame &a = probe.pixels, &b = finer.pixels;
        if (a.id[i] < 0 || a.id[i] != b.id[i]) continue;  // the two rays see different surfaces
        const double off = std::hypot(double{a.u[i]} - b.u[i], double{a.v[i]} - b.v[i]);
        ++probe.again;
        if (off > kPessimism * tolerance) ++probe.off;
        probe.farthest_off = std::max(probe.farthest_off, off);
    }
}

/// Estimates the steps that a ray would still take which was given up. It is assumed to go on along the straight ray to
/// that ray's end, with the same number of steps for each longest step of the field. A wandering ray needs four times
/// the steps to get twice as far. A ray that is beyond the straight ray's end is assumed to go on to `far`.
double Renderer::steps_to_come(const Camera& camera, int x, int y, const FrameAir& air, const BentHit& tried) const {
    const CameraRay ray = camera_ray(camera, x + 0.5, y + 0.5);
    const dvec3 direction = glm::normalize(ray.direction);
    const auto hit = geometry_.nearest(ray.origin, direction, 0, air.trace.far);
    const double way = glm::distance(tried.at.x, ray.origin);
    const bool wanders = way < kStraightEnough * tried.length;
    const double come = wanders ? way : tried.length;
    const double end = hit && hit->t > come ? hit->t : air.trace.far;
    const double taken = longest_steps(air.field, ray.origin, direction, 0, come);
    const double ahead = longest_steps(air.field, ray.origin, direction, come, end);
    if (!(taken > 0)) return kInfinity;
    const double times = 1 + ahead / taken;
    return tried.steps * ((wanders ? times * times : times) - 1);
}

double Probe::time(double area, int samples_each) const {
    const double steps = std::accumulate(pixels.steps.begin(), pixels.steps.end(), 0.0);
    return seconds * area / pixels.width * (1 + samples_each) / (1 + samples) *
           (steps > 0 ? 1 + steps_to_come / steps : 1);
}

}  // namespace eikonal::reference
