#include "reference/trace/path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "noise/base/error.h"
#include "reference/trace/perturbation.h"

namespace eikonal::reference {
namespace {

/// A ray that ends within this part of its length of u_end has reached it.
constexpr double kSameEnd = 1e-11;

/// The perturbed curve in steps so short that halving them moves its end by less than the tolerance, or by less than
/// rounding. A curve whose budget is used up is returned as it is.
BentHit converged_curve(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
                        TraceSettings settings, std::vector<Step>& steps) {
    const auto curve = [&] {
        steps.clear();
        return perturbed_curve(field, geometry, origin, direction, settings,
                               [&](const Step& step) { steps.push_back(step); });
    };
    BentHit result = curve();
    if (settings.step > 0) return result;
    for (const Step& step : steps)
        if (!step.straight) settings.step = std::max(settings.step, step.h * field.speed(origin));
    while (settings.step > 0 && result.ended()) {
        settings.step *= 0.5;
        const BentHit finer = curve();
        const double moved = glm::distance(finer.at.x, result.at.x);
        const double nothing = kSameEnd * 1e-2 * (glm::length(origin) + finer.length);
        const bool same = finer.end == result.end && moved <= std::max(settings.tolerance_px * settings.pixel, nothing);
        result = finer;
        if (same) break;
    }
    return result;
}

void write_row(std::ostream& stream, const RayState& at) {
    stream << fmt::format("{},{},{},{},{},{},{}\n", at.u, at.x.x, at.x.y, at.x.z, at.p.x, at.p.y, at.p.z);
}

}  // namespace

BentHit write_path(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
                   const TraceSettings& settings, std::ostream& stream, const std::string& name) {
    std::vector<Step> steps;
    const auto record = [&](const Step& step) {
        if (step.from.u == 0) steps.clear();
        if (step.h > 0) steps.push_back(step);
    };
    const bool perturbed =
        settings.integrator == Integrator::FirstOrder || settings.integrator == Integrator::SecondOrder;
    BentHit result = perturbed ? converged_curve(field, geometry, origin, direction, settings, steps)
                               : trace(field, geometry, origin, direction, settings, nullptr, record);
    // Up to rounding, the steps add up to the length that is asked for.
    if (result.end == BentHit::End::Escaped && std::abs(result.at.u - settings.u_end) <= kSameEnd * (1 + result.at.u))
        result.at.u = settings.u_end;
    // The last step ends early if it meets a surface. Steps beyond it do not count.
    while (!steps.empty() && steps.back().from.u >= result.at.u) steps.pop_back();
    stream << "u,x,y,z,px,py,pz\n";
    write_row(stream, steps.empty() ? result.at : steps.front().from);
    for (const Step& step : steps) {
        const bool last = &step == &steps.back();
        const double end = last ? std::min(1.0, (result.at.u - step.from.u) / step.h) : 1;
        const double points = std::ceil(std::min(step.bend() / kPathTurn, static_cast<double>(kMostPointsAStep)));
        for (int i = 1; i < static_cast<int>(points); ++i) write_row(stream, step.at(i / points * end));
        write_row(stream, last ? result.at : step.to());
    }
    if (!stream.flush()) throw FrameError(fmt::format("{}: cannot be written", name));
    return result;
}

}  // namespace eikonal::reference
