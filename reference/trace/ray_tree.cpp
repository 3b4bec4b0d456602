#include "reference/trace/ray_tree.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace eikonal::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The settings of a ray that starts after `distance` metres of path.
TraceSettings at_distance(TraceSettings trace, double distance) {
    trace.distance = distance;
    return trace;
}

}  // namespace

double fresnel_reflectance(double n1, double cos1, double n2, double cos2) {
    const double s = (n1 * cos1 - n2 * cos2) / (n1 * cos1 + n2 * cos2);
    const double p = (n1 * cos2 - n2 * cos1) / (n1 * cos2 + n2 * cos1);
    return 0.5 * (s * s + p * p);
}

std::optional<dvec3> RayTree::radiance(const dvec3& origin, const dvec3& direction, const TraceSettings& trace,
                                       const LightSample& sample) const {
    return follow({origin, direction, 1, 0, 0, -1}, trace, sample);
}

/// The first surface on a branch's way, with p and the path length there. dark: the ray has no end.
std::optional<Hit> RayTree::meet(const Branch& branch, const TraceSettings& trace, dvec3& p, double& length,
                                 bool& dark) const {
    p = branch.p;
    dark = false;
    check_stop(stop_);
    if (!field_ || branch.inside >= 0) {
        const auto hit = geometry_.intersect(branch.origin, p, 0, kInfinity);
        length = branch.distance + (hit ? hit->t * glm::length(p) : 0.0);
        return hit;
    }
    const auto follow_with = [&](const TraceSettings& settings) {
        return reference::trace(*field_, &geometry_, branch.origin, glm::normalize(p), settings, nullptr, watch(stop_));
    };
    const BentHit end = branch.distance == 0 ? follow_with(trace) : follow_with(at_distance(trace, branch.distance));
    p = end.at.p;
    length = branch.distance + end.length;
    dark = !end.ended();
    if (!end.hit) return std::nullopt;
    return end.surface;
}

/// The radiance of a branch. Nothing if its ray has no end.
std::optional<dvec3> RayTree::follow(const Branch& branch, const TraceSettings& trace,
                                     const LightSample& sample) const {
    dvec3 p;
    double length;
    bool dark;
    const std::optional<Hit> hit = meet(branch, trace, p, length, dark);
    if (dark) return {};
    if (!hit) return shading_.background(p);
    const Material& material = geometry_.materials()[static_cast<std::size_t>(hit->material)];
    if (material.mirror <= 0 && !material.refractive_index) return shading_.surface(*hit, sample, sunlight_);

    const double cosine = -glm::dot(p, hit->normal) / glm::length(p);  // > 0, since the normal is on the ray's side
    const dvec3 reflected = p - 2 * glm::dot(p, hit->normal) * hit->normal;
    const auto branch_off = [&](const dvec3& direction, double part, bool across, int inside) -> dvec3 {
        const double weight = branch.weight * part;
        if (branch.depth + 1 >= kDeepestBranch || weight < kFaintest) return dvec3(0);
        Hit side = *hit;
        if (across) side.normal = -side.normal;
        const Branch next{geometry_.leave(side), direction, weight, length, branch.depth + 1, inside};
        return part * follow(next, trace, sample).value_or(dvec3(0));
    };
    if (!material.refractive_index) {
        dvec3 light = branch_off(reflected, material.mirror, false, branch.inside);
        if (material.mirror < 1) light += (1 - material.mirror) * shading_.surface(*hit, sample, sunlight_);
        return light;
    }
    const bool leaving = branch.inside == hit->object;
    const double n1 = leaving ? *material.refractive_index : index(hit->point);
    const double n2 = leaving ? index(hit->point) : *material.refractive_index;
    const double sine2 = (n1 / n2) * (n1 / n2) * (1 - cosine * cosine);
    if (!(sine2 < 1)) return branch_off(reflected, 1, false, branch.inside);  // total reflection
    const double cosine2 = std::sqrt(1 - sine2);
    const dvec3 along = p / glm::length(p) + cosine * hit->normal;  // the part of the unit direction along the surface
    const dvec3 refracted = (n1 / n2) * along - cosine2 * hit->normal;
    const double R = fresnel_reflectance(n1, cosine, n2, cosine2);
    return branch_off(reflected, R, false, branch.inside) +
           branch_off(refracted, 1 - R, true, leaving ? -1 : hit->object);
}

}  // namespace eikonal::reference
