#include "reference/trace/ray_differential.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "reference/trace/direction.h"

namespace eikonal::reference {
namespace {

dvec3 bend(const ForceJet& jet, const Differential& d) {
    return jet.by_position * d.x + jet.by_direction * d.p;
}

/// The signed cross-section of a bundle across `along`.
double cross_section(const dvec3& a, const dvec3& b, const dvec3& along) {
    return glm::dot(glm::cross(a, b), along) / glm::length(along);
}

}  // namespace

Bundle launch(const Bundle& pixels, const RayState& start, const dvec3& force) {
    const double speed = glm::length(start.p);
    Bundle bundle;
    for (std::size_t i = 0; i < 2; ++i) {
        const dvec3 d = start.p / speed, across = pixels[i].p - glm::dot(pixels[i].p, d) * d;
        bundle[i].x = pixels[i].x;
        // |p|² = n² gives δ|p| = F·δx/|p|, in either convention.
        bundle[i].p = speed * across + glm::dot(force, pixels[i].x) / (speed * speed) * start.p;
    }
    return bundle;
}

void advance(const AirInstant& field, const Step& step, double theta, Bundle& bundle) {
    if (step.straight) {
        for (Differential& d : bundle) d.x += theta * step.h * d.p;
        return;
    }
    // In two halves, since a step of the ray may be long.
    const double h = 0.5 * theta * step.h;
    ForceJet first = field.force_jet(step.from.x, step.from.p);
    for (const double part : {0.0, 0.5}) {
        const double at_middle = (part + 0.25) * theta, at_end = (part + 0.5) * theta;
        const ForceJet middle = field.force_jet(step.position(at_middle), step.direction(at_middle));
        const ForceJet last = field.force_jet(step.position(at_end), step.direction(at_end));
        for (Differential& d : bundle) {
            const dvec3 f1 = bend(first, d);
            const Differential d2{d.x + 0.5 * h * d.p, d.p + 0.5 * h * f1};
            const dvec3 f2 = bend(middle, d2);
            const Differential d3{d.x + 0.5 * h * d2.p, d.p + 0.5 * h * f2};
            const dvec3 f3 = bend(middle, d3);
            const Differential d4{d.x + h * d3.p, d.p + h * f3};
            const dvec3 f4 = bend(last, d4);
            d.x += h / 6 * (d.p + 2.0 * d2.p + 2.0 * d3.p + d4.p);
            d.p += h / 6 * (f1 + 2.0 * f2 + 2.0 * f3 + f4);
        }
        first = last;
    }
}

void pass_edge(const AirInstant& field, const RayState& state, double reach, const dvec3& before, const dvec3& after,
               Bundle& bundle) {
    if (before == after) return;
    const double speed = glm::length(state.p);
    const dvec3 d = state.p / speed;
    const dvec3 back = state.x - reach * d;
    const double way = field.way_to_edge(back, d);
    if (!(std::abs(way - reach) < 1e-3 * reach)) return;
    // The way to a plane of normal ν is proportional to 1/(ν·d).
    dvec3 right, up;
    perpendicular_axes(d, {}, right, up);
    constexpr double kTilt = 1e-3;
    const double longer = std::sqrt(1 + kTilt * kTilt);
    dvec3 normal = d;
    for (const dvec3& across : {right, up}) {
        const double plus = field.way_to_edge(back, (d + kTilt * across) / longer);
        const double minus = field.way_to_edge(back, (d - kTilt * across) / longer);
        normal += way * longer * (1 / plus - 1 / minus) / (2 * kTilt) * across;
    }
    for (Differential& one : bundle) one.p -= glm::dot(normal, one.x) / speed * (before - after);
}

Bundle on_surface(const Bundle& bundle, const RayState& state, const dvec3& normal) {
    const double approach = glm::dot(normal, state.p);
    Bundle result = bundle;
    if (std::abs(approach) < 1e-12 * glm::length(state.p)) return result;
    for (Differential& d : result) d.x -= glm::dot(normal, d.x) / approach * state.p;
    return result;
}

double magnification(const Bundle& pixels, const dvec3& direction, const RayState& state, const Bundle& bundle,
                     double length) {
    const double straight =
        cross_section(pixels[0].x + length * pixels[0].p, pixels[1].x + length * pixels[1].p, direction);
    const double bent = cross_section(bundle[0].x, bundle[1].x, state.p);
    if (straight == 0) return 1;
    const double inverse = bent / straight;
    if (!(std::abs(inverse) > 1 / kLargestMagnification))
        return inverse < 0 ? -kLargestMagnification : kLargestMagnification;
    return 1 / inverse;
}

}  // namespace eikonal::reference
