/// Follows one ray of light through a field of refractive index until it meets a surface (paper Eq. 2;
/// PHYSICS.md#ray-equation).
///
/// Rays are traced from the camera outwards. Positions are world metres, angles are radians, and all numbers are double
/// precision. A ray starts with |dx/du| = AirInstant::speed at its origin.
///
/// Steps. A method of fixed steps takes AirInstant::longest_step. `adaptive` takes at most longest_stride. Neither
/// passes over a feature of the index unseen. A step ends where F jumps (way_to_edge), and the next one begins beyond,
/// so each method keeps its order (integrator.h). Outside every medium the ray is one straight segment (clear_way).
///
/// Error. `adaptive` keeps the local error of every step below 1/kStepShare of the tolerance, as the final displacement
/// that it can cause. Errors δx at path length s and δp cause at most (|δx|/s + |δp|/|p|) / pixel for a perspective
/// camera, and (|δx| + |δp|/|p| (end - s)) / pixel for an orthographic one. There, end is `sight` or the longest path
/// that the settings allow. BentHit::error_px is the sum over all steps. Where a feature takes few steps, it is about
/// the displacement's error. Where a feature takes many, it is pessimistic, being the error of order 4. It does not
/// know of chords, nor of a field that spreads rays apart. Against a tolerance of 1e-6 pixels, the displacement's error
/// stays below the tolerance (README, How fast). Two terms are added: for adaptive, the part of the tolerance that it
/// may miss unseen (kUnseenShare); and the effect of interpolation in lattices, which 95 % of rays do not exceed
/// (AirInstant::interpolation).
///
/// Surfaces are met as surface_search.h says. Chords deviate from the curve by less than half of the tolerance.
///
/// No ray runs for ever. A ray whose numbers overflow ends as trapped (BentHit::End).
#pragma once

#include <algorithm>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <optional>

#include "noise/surface/surface_spec.h"
#include "reference/trace/geometry.h"
#include "reference/trace/integrator.h"
#include "reference/trace/lone_surface.h"
#include "reference/trace/ray_differential.h"
#include "reference/trace/surface_search.h"

namespace eikonal::reference {

/// A step of adaptive may err by one of these parts of the tolerance. Over a lone surface the estimate never misses the
/// error. Elsewhere, a step as long as a feature may seem more exact than it is.
inline constexpr double kStepShare = 32, kStepShareOverSurface = 5;
/// A turn by less than this part of the tolerance does not matter. The limit applies to a blob in adaptive's choice of
/// steps (its force always counts) and in first order, to the air over a lone surface, and to the angle by which first
/// order redirects a ray.
inline constexpr double kQuietShare = 100;
/// A step as long as a feature may miss part of it, and its error estimate then misses it too. Among blobs, thin
/// screens and surfaces together, 95 % of rays were off by no more than the estimate plus this part of the tolerance.
/// Over a lone surface kQuietShare takes its place.
inline constexpr double kUnseenShare = 8;
/// The finest useful tolerance, tolerance_px * pixel [rad or m]. Tighter ones count as this.
inline constexpr double kFinestTolerance = 1e-13;
/// A ray is trapped if it has turned through this angle [rad], all bends added, on a way whose ends are closer to each
/// other than this part of its length. A ray that gets anywhere turns far less, or it makes headway as a ray in a guide
/// does at less than 88 degrees from the axis.
inline constexpr double kTrapTurn = 64 * 3.141592653589793, kTrapAdvance = 1.0 / 32;
/// Error of adaptive at its finest tolerance in the closed forms of PHYSICS.md#closed-forms, in x [m] and in p.
inline constexpr double kClosedFormError = 1e-9;

/// A place from which many rays start, such as a perspective camera.
struct KnownOrigin {
    dvec3 place{0, 0, 0};
    double speed = 0;                ///< AirInstant::speed there
    LoneSurface::AtHeight height{};  ///< valid if there is a lone surface
};

struct TraceSettings {
    Integrator integrator = Integrator::Adaptive;
    double tolerance_px = 0.01;  ///< of the final displacement [pixels] > 0
    bool perspective = true;
    double pixel = 1e-3;  ///< size of a pixel > 0: [rad] (perspective) or [m] (orthographic)
    /// A further limit of the step, as du times the speed at the origin [m]. A method then keeps one du, and leapfrog
    /// is symplectic only then. 0: only the field limits the step. For `layers` it is the thickness of a slice, and 0
    /// means kSlicesPerDropoff slices in a dropoff.
    double step = 0;
    int step_budget = 100000;  ///< attempts of steps > 0
    /// A smaller budget for rays that are only tried.
    int tried_steps = std::numeric_limits<int>::max();
    /// Whether a trapped ray ends as soon as it is known to be trapped (kTrapTurn), and not only by its budget.
    bool end_trapped = false;
    double far = 1e6;  ///< length of path after which a ray that met nothing ends [m] > 0
    /// The longest path along which an error of direction can displace an orthographic ray [m] > 0: that to the
    /// farthest thing in sight.
    double sight = std::numeric_limits<double>::infinity();
    double u_end = std::numeric_limits<double>::infinity();  ///< the ray ends at this parameter
    double distance = 0;  ///< path from the camera to the ray's origin, for secondary rays [m] >= 0
    /// For `layers` and `mirror`: baseline_surface() of baselines.h.
    std::optional<SurfaceSpec> surface;
    /// The field's only medium, if that is a surface. It only saves time. Adaptive goes straight where no bend matters.
    /// First order takes the closed form.
    std::shared_ptr<const LoneSurface> lone;
    /// The place where rays start. It only saves time.
    std::optional<KnownOrigin> origin;

    /// Sets `origin`. `lone` must be set before, if at all.
    void start_at(const AirInstant& field, const dvec3& place) {
        origin = {place, field.speed(place), lone ? lone->at(place) : LoneSurface::AtHeight{}};
    }
    int most_steps() const { return std::min(step_budget, tried_steps); }
    double launch_speed(const AirInstant& field, const dvec3& place) const {
        return origin && origin->place == place ? origin->speed : field.speed(place);
    }
};

struct BentHit {
    enum class End {
        Surface,     ///< it met `surface`
        Escaped,     ///< it went on for `far` metres or to u_end. `at.p` tells which background it sees.
        Trapped,     ///< it goes round and round (kTrapTurn), or its numbers overflow
        Unfinished,  ///< its step budget is used up
        NoIndex      ///< it came to a place with n <= 0
    };
    End end = End::Escaped;
    bool hit = false;  ///< end == Surface
    Hit surface;
    RayState at;          ///< the ray's end. For a hit, at.x is surface.point.
    double length = 0;    ///< length of the path from the origin [m]
    int steps = 0;        ///< attempts of steps
    double error_px = 0;  ///< estimated error, see above [pixels]

    /// Whether the ray ended where there is something to see.
    bool ended() const { return end == End::Surface || end == End::Escaped; }
    /// Ends the ray on the surface at `there`.
    void meet(const Hit& there) {
        end = End::Surface;
        hit = true;
        surface = there;
        at.x = there.point;
    }
};

/// About how many times larger than the error adaptive's estimate is.
inline constexpr double kPessimism = 2;
/// How often a ray that is too_far_off is followed again in finer steps.
inline constexpr int kMostRetries = 2;
/// Whether a ray that came to an end has an estimated error above kPessimism times the tolerance.
bool too_far_off(const BentHit& end, double tolerance_px);

/// The sum of two independent errors of equal rms along two axes is less than this times the rms of both in 95 % of all
/// cases: √(-ln 0.05).
inline constexpr double kMostOfRms = 1.731;

/// Called with every step of the ray. It may also get steps beyond the ray's end. A ray that is followed again begins
/// at u = 0 again.
using StepRecorder = std::function<void(const Step&)>;

/// Follows a ray. geometry: null if there is nothing to meet. direction: of unit length. bundle: null, or the bundle as
/// its pixels leave the origin (x: change of the origin, p: change of the unit direction). It returns as it arrives at
/// the ray's end, not yet moved onto the surface (on_surface). Only integrators that follow a bent ray change it.
BentHit trace(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
              const TraceSettings& settings, Bundle* bundle = nullptr, const StepRecorder& recorder = {});

/// Whether a clear way is possible where F is `force` [1/m]. A larger F means that the point lies within a medium's
/// bounds. The limit is above zero, because the tails of a medium have no end.
inline bool may_be_clear(const dvec3& force) {
    constexpr double kTail = 1e-12;
    return glm::dot(force, force) <= kTail * kTail;
}

/// How far chords may deviate from the curve.
SurfaceSearch::Deviation chord_deviation(const TraceSettings& settings);

/// Whether this integrator follows bundles.
constexpr bool follows_bundles(Integrator integrator) {
    return integrator <= Integrator::Euler;
}

}  // namespace eikonal::reference
