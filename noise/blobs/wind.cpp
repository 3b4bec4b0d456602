#include "noise/blobs/wind.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "noise/blobs/blobs_spec.h"

namespace eikonal {
namespace {

constexpr std::size_t kInstantsKept = 6;  ///< 1 MB

/// Rotation from world to lattice. The vertical becomes (1, 1/ρ, 1/ρ²) with ρ³ = ρ + 1, a direction that rational ones
/// approximate badly.
const glm::dmat3& rotation() {
    static const glm::dmat3 matrix = [] {
        constexpr double a = 0.754877666246693, b = 0.569840290998053;
        const dvec3 up = glm::normalize(dvec3(1, a, b));
        const dvec3 right = glm::normalize(glm::cross(up, dvec3(b, 1, a)));
        return glm::dmat3(right, up, glm::cross(right, up));
    }();
    return matrix;
}

}  // namespace

dvec3 WindInterval::velocity(const dvec3& x, double f) const {
    const double t = (k_ + f) * step_;
    const double turnovers = t * (spec_.rms / spec_.outer_scale) / kEddyLoop;
    const dvec3 drift(kEddyDrift[0], kEddyDrift[1], kEddyDrift[2]);
    const dvec3 place = rotation() * (x - spec_.rise * t) / (kEddyPeriod * spec_.outer_scale) - drift * turnovers;
    dvec3 eddies;
    if (f == 0)
        eddies = begin_->velocity(place);
    else if (f == 1)
        eddies = end_->velocity(place);
    else
        eddies = (1 - f) * begin_->velocity(place) + f * end_->velocity(place);
    return spec_.rise + spec_.rms * (eddies * rotation());  // the transpose is the inverse rotation
}

dvec3 WindInterval::carry(const dvec3& x, double f0, double f1) const {
    const double h = (f1 - f0) * step_, middle = 0.5 * (f0 + f1);
    const dvec3 v1 = velocity(x, f0);
    const dvec3 v2 = velocity(x + 0.5 * h * v1, middle);
    const dvec3 v3 = velocity(x + 0.5 * h * v2, middle);
    const dvec3 v4 = velocity(x + h * v3, f1);
    return x + h / 6 * (v1 + 2.0 * (v2 + v3) + v4);
}

Wind::Wind(const WindSpec& spec, double longest)
    : spec_(spec),
      step_(std::max(spec.outer_scale / spec.rms / kWindStepsPerTurnover, longest / kMostWindSteps)),
      eddies_(spec.seed),
      instants_(kInstantsKept) {}

std::vector<WindInterval> Wind::intervals(std::int64_t first, int count) const {
    std::vector<std::shared_ptr<const EddyInstant>> instants(static_cast<std::size_t>(count) + 1);
    tbb::enumerable_thread_specific<EddyWorkspace> room;
    tbb::parallel_for(std::size_t{0}, instants.size(), [&](std::size_t i) {
        const std::int64_t k = first + static_cast<std::int64_t>(i);
        instants[i] = instants_.latest(k, k).value;
        if (instants[i]) return;
        const double turnovers = static_cast<double>(k) * step_ * (spec_.rms / spec_.outer_scale);
        instants[i] = std::make_shared<const EddyInstant>(eddies_.at(turnovers, room.local()));
        instants_.keep(k, instants[i]);
    });
    std::vector<WindInterval> intervals(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < intervals.size(); ++i) {
        intervals[i].spec_ = spec_;
        intervals[i].k_ = static_cast<double>(first + static_cast<std::int64_t>(i));
        intervals[i].step_ = step_;
        intervals[i].begin_ = instants[i];
        intervals[i].end_ = instants[i + 1];
    }
    return intervals;
}

dvec3 Wind::velocity(const dvec3& x, double t) const {
    const double k = std::floor(t / step_);
    return intervals(static_cast<std::int64_t>(k), 1).front().velocity(x, t / step_ - k);
}

}  // namespace eikonal
