/// The turbulent wind that carries blobs: a mean velocity `rise`, and eddies of the von Kármán spectrum without
/// divergence (noise/blobs/eddies.h; Stam & Fiume 1993), which the mean velocity carries along (Taylor's hypothesis).
///
///     v(x, t) = rise + rms · R⁻¹ e(R (x - rise t)/(kEddyPeriod L0) - drift t/T, t rms/L0)
///
/// R is a fixed rotation. It turns the vertical to a direction along which the periodic lattice does not come near
/// itself for long, so a plume that rises through it sees no repetition. Units: metres, seconds.
///
/// Time grid. The eddies exist at t_k = kΔ for whole k. Between two grid times they are interpolated linearly, in the
/// frame that moves with them. Everything is therefore a pure function of x and t, and few instants suffice. Δ is
/// L0/rms/kWindStepsPerTurnover. A particle that is carried for more than kMostWindSteps such steps gets a longer Δ:
/// its cost is bounded, and it follows the eddies less exactly. The rms is exact at t_k, and less by at most
/// kWindBlendLoss between. Particles follow by one Runge-Kutta step of fourth order in each interval, from and to any
/// times. After half a turnover their rms distance from the exact path through this wind is within kWindTrackError.
///
/// Range: |t| <= 1e9 s. Failures: std::bad_alloc. Immutable, except for a bounded cache that no result depends on.
/// Thread-safe. The bits are the same for any number of threads and any processor.
/// Theory: PHYSICS.md#wind.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "noise/base/bounded_cache.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/blobs/eddies.h"

namespace eikonal {

inline constexpr double kWindStepsPerTurnover = 12;
inline constexpr double kMostWindSteps = 1024;
/// The largest part of the rms that is missing halfway between two grid times, if Δ was not made longer.
inline constexpr double kWindBlendLoss = 0.05;
/// Rms distance from the exact path after half a turnover [L0].
inline constexpr double kWindTrackError = 0.07;

/// The wind between two neighbouring grid times. f = t/Δ - k is the place between them, 0 … 1. Immutable.
class WindInterval {
  public:
    /// Velocity [m/s] at x [m].
    dvec3 velocity(const dvec3& x, double f) const;
    /// The place at f1 of a particle that is at x at f0. 0 <= f0 <= f1 <= 1.
    dvec3 carry(const dvec3& x, double f0, double f1) const;

  private:
    friend class Wind;
    WindSpec spec_;
    double k_ = 0, step_ = 0;
    std::shared_ptr<const EddyInstant> begin_, end_;
};

class Wind {
  public:
    /// longest: the longest time for which particles will be carried [s] > 0. spec: rms > 0 and outer_scale > 0.
    Wind(const WindSpec& spec, double longest);

    /// Δ [s].
    double step() const { return step_; }
    /// Rms of each component of the eddies [m/s].
    double rms() const { return spec_.rms; }
    /// `count` intervals from t_first on. Instants that the cache lacks are made in parallel.
    std::vector<WindInterval> intervals(std::int64_t first, int count) const;
    /// Velocity [m/s] at x [m] and t [s].
    dvec3 velocity(const dvec3& x, double t) const;

  private:
    WindSpec spec_;
    double step_;
    EddyField eddies_;
    BoundedCache<EddyInstant> instants_;
};

}  // namespace eikonal
