#include "reference/trace/baselines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "noise/base/error.h"
#include "noise/medium/medium_spec.h"
#include "noise/surface/surface_spec.h"

namespace eikonal::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double remaining_way(const TraceSettings& settings, const RayState& state, double length) {
    return std::min(settings.far - length, (settings.u_end - state.u) * glm::length(state.p));
}

/// The air above a surface as slices of constant |p|. Number 0 lies on the surface, -1 below it.
class Slices {
  public:
    Slices(const AirInstant& field, const TraceSettings& settings)
        : field_(field),
          origin_(settings.surface->origin),
          normal_(glm::normalize(settings.surface->normal)),
          thickness_(settings.step > 0 ? settings.step : settings.surface->dropoff / kSlicesPerDropoff),
          count_(std::max(1.0, std::ceil(kSlicedDropoffs * settings.surface->dropoff / thickness_))) {}

    const dvec3& normal() const { return normal_; }
    double number(const dvec3& x) const {
        return std::clamp(std::floor(glm::dot(x - origin_, normal_) / thickness_), -1.0, count_);
    }
    double speed(double number) const {
        const double middle = number < 0 ? 0 : (number + 0.5) * thickness_;
        return field_.speed(origin_ + middle * normal_);
    }
    /// The way along p from x in slice `number` to the next slice [m].
    double way(const dvec3& x, const dvec3& p, double number) const {
        const double rise = glm::dot(p, normal_);
        if (rise == 0 || (rise > 0 && number == count_) || (rise < 0 && number < 0)) return kInfinity;
        const double boundary = (rise > 0 ? number + 1 : number) * thickness_;
        return std::max(0.0, (boundary - glm::dot(x - origin_, normal_)) * glm::length(p) / rise);
    }

  private:
    const AirInstant& field_;
    dvec3 origin_, normal_;
    double thickness_, count_;
};

/// Ends `result` at a meeting on one of its last steps. The speeds of neighbouring slices hardly differ. The length is
/// exact to their difference times the length of a chord.
BentHit end_at(BentHit result, const SurfaceSearch::Met& met) {
    const RayState at = met.step.at(met.theta);
    result.length += (at.u - result.at.u) * glm::length(at.p);
    result.at = at;
    result.meet(met.hit);
    return result;
}

}  // namespace

std::optional<SurfaceSpec> baseline_surface(Integrator integrator, const std::vector<MediumSpec>& media) {
    if (integrator != Integrator::Layers && integrator != Integrator::Mirror) return {};
    const char* name = integrator == Integrator::Layers ? "layers" : "mirror";
    for (std::size_t i = 0; i < media.size(); ++i)
        if (!(media[i].get_if<SurfaceSpec>() != nullptr) || media.size() > 1)
            throw UserError(fmt::format(
                "`integrator` {}: follows rays through a single medium of type \"surface\", but "
                "the scene has {}; remove it or use adaptive",
                name, media.size() > 1 ? fmt::format("{} media", media.size()) : "medium.0 of another type"));
    if (media.empty())
        throw UserError(
            fmt::format("`integrator` {}: needs a medium of type \"surface\", but the scene has no [[medium]]; "
                        "add one or use adaptive",
                        name));
    return (*media.front().get_if<SurfaceSpec>());
}

BentHit trace_layers(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
                     const TraceSettings& settings, const StepRecorder& recorder) {
    const Slices slices(field, settings);
    SurfaceSearch search(geometry, chord_deviation(settings), settings.distance);
    BentHit result;
    double number = slices.number(origin), speed = slices.speed(number), kink = 0;
    result.at = {origin, speed * direction, 0};
    if (!(speed > 0)) {
        result.end = BentHit::End::NoIndex;
        return result;
    }
    while (true) {
        if (++result.steps > settings.most_steps()) {
            result.end = BentHit::End::Unfinished;
            break;
        }
        RayState& ray = result.at;
        const double way = slices.way(ray.x, ray.p, number), remaining = remaining_way(settings, ray, result.length);
        const Step step = straight_step(ray, std::min(way, remaining));
        if (recorder) recorder(step);
        if (const auto met = search.add(step, step.length(), 0, kink)) return end_at(result, *met);
        ray = step.to();
        result.length += std::min(way, remaining);
        if (way >= remaining) break;
        // Snell's law: |p_t| does not change.
        const double rise = glm::dot(ray.p, slices.normal()), next = number + (rise > 0 ? 1 : -1);
        const double next_speed = slices.speed(next);
        const double square = rise * rise + (next_speed - speed) * (next_speed + speed);
        const dvec3 before = ray.p;
        if (square > 0 && next_speed > 0) {
            ray.p += (std::copysign(std::sqrt(square), rise) - rise) * slices.normal();
            number = next;
            speed = next_speed;
        } else {
            ray.p -= 2 * rise * slices.normal();
        }
        kink = glm::length(ray.p - before) / speed;
    }
    if (const auto met = search.finish()) return end_at(result, *met);
    result.steps = std::min(result.steps, settings.most_steps());
    return result;
}

BentHit trace_mirror(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
                     const TraceSettings& settings, const StepRecorder& recorder) {
    const dvec3 normal = glm::normalize(settings.surface->normal), on_plane = settings.surface->origin;
    BentHit result;
    result.at = {origin, field.speed(origin) * direction, 0};
    RayState& ray = result.at;
    if (ray.p == dvec3(0)) {
        result.end = BentHit::End::NoIndex;
        return result;
    }
    // The mirror is flat, so it reflects a ray at most once.
    for (bool may_reflect = true;; may_reflect = false) {
        ++result.steps;
        const double speed = glm::length(ray.p), rise = glm::dot(ray.p, normal) / speed;
        const dvec3 d = ray.p / speed;
        const double remaining = remaining_way(settings, ray, result.length);
        const double height = glm::dot(ray.x - on_plane, normal);
        const double at_plane = may_reflect && height > 0 && rise < 0 ? -height / rise : kInfinity;
        const double tangential2 = speed * speed * (1 - rise * rise), surface_speed = field.speed(on_plane);
        const double mirror = tangential2 > surface_speed * surface_speed ? at_plane : kInfinity;
        const double slack = kFloatSlack * (settings.distance + result.length + std::min(mirror, settings.far));
        std::optional<Hit> hit;
        // An object within rounding of the mirror counts as lying under it, even if it comes first.
        if (geometry) hit = geometry->intersect(ray.x, d, 0, remaining);
        const bool reflects =
            mirror < remaining && (!hit || hit->t > mirror || glm::dot(hit->point - on_plane, normal) < slack);
        const double way = reflects ? mirror : hit ? hit->t : remaining;
        const Step step = straight_step(ray, way);
        if (recorder) recorder(step);
        result.length += way;
        ray = step.to();
        if (reflects) {
            ray.x -= glm::dot(ray.x - on_plane, normal) * normal;
            ray.p -= 2 * glm::dot(ray.p, normal) * normal;
            if (!hit || std::abs(glm::dot(hit->point - on_plane, normal)) < slack) ray.x += slack * normal;
            continue;
        }
        if (hit) result.meet(*hit);
        return result;
    }
}

}  // namespace eikonal::reference
