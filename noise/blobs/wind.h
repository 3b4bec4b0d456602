/// The turbulent wind that carries blobs: a mean velocity `rise` and, carried along with it (Taylor), divergence-free
/// eddies of the von Kármán spectrum (noise/blobs/eddies.h; Stam & Fiume 1993).
///
///     v(x, t) = rise + rms · R⁻¹ e(R (x - rise t)/(kEddyPeriod L0) - drift t/T, t rms/L0)
///
/// R is a fixed rotation that turns the vertical to a direction along which the periodic lattice does not come near
/// itself for long: a plume that rises through it sees no repetition. Metres, seconds.
///
/// Time grid. The eddies exist at t_k = kΔ, whole k, and linearly between, as seen in the frame that goes with them:
/// everything is then a pure function of x and t, and few instants suffice. Δ is a part 1/kWindStepsPerTurnover of
/// L0/rms; a particle that is carried for more than kMostWindSteps of those gets a longer Δ, so that its cost is
/// bounded, and follows the eddies less exactly. rms is exact at t_k, and less by at most kWindBlendLoss between.
/// Particles follow by one Runge-Kutta step of fourth order each interval, from and to any times: after half a turnover
/// they are within kWindTrackError of the exact path through that wind, in rms.
///
/// Range: |t| <= 1e9 s. Failures: std::bad_alloc. Immutable but for a bounded cache that no result depends on;
/// thread-safe; same bits for any number of threads and any processor.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "noise/base/bounded_cache.h"
#include "noise/blobs/eddies.h"
#include "noise/medium/media.h"

namespace eikonal {

inline constexpr double kWindStepsPerTurnover = 12;
inline constexpr double kMostWindSteps = 1024;
/// Part of the rms that is missing halfway between two grid times of the full density, at most.
inline constexpr double kWindBlendLoss = 0.05;
/// Rms distance from the exact path, in L0, after half a turnover.
inline constexpr double kWindTrackError = 0.07;

/// The wind between two neighbouring grid times; f = t/Δ - k is the place in between, 0 … 1. Immutable.
class WindInterval {
  public:
    /// [m/s]
    dvec3 velocity(const dvec3& x, double f) const;
    /// Where a particle at x at f0 is at f1 >= f0, both in 0 … 1.
    dvec3 carry(const dvec3& x, double f0, double f1) const;

  private:
    friend class Wind;
    WindSpec spec_;
    double k_ = 0, step_ = 0;
    std::shared_ptr<const EddyInstant> begin_, end_;
};

class Wind {
  public:
    /// longest: time for which particles will be carried [s] > 0. rms > 0, outer_scale > 0.
    Wind(const WindSpec& spec, double longest);

    /// Δ [s].
    double step() const { return step_; }
    /// Of each component of the eddies [m/s].
    double rms() const { return spec_.rms; }
    /// `count` intervals from t_first on. Instants that are not at hand are made in parallel.
    std::vector<WindInterval> intervals(std::int64_t first, int count) const;
    /// [m/s]
    dvec3 velocity(const dvec3& x, double t) const;

  private:
    WindSpec spec_;
    double step_;
    EddyField eddies_;
    BoundedCache<EddyInstant> instants_;
};

}  // namespace eikonal
