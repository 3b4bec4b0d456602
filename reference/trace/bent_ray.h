/// Follows one ray of light through a field of refractive index until it meets a surface (paper Eq. 2;
/// PHYSICS.md#ray-equation).
///
/// Directions are traced from the camera outwards. Positions in world metres; angles in radians; double throughout. The
/// ray starts with |dx/du| = AirInstant::speed at its origin.
///
/// Steps: a method of fixed steps takes AirInstant::longest_step, `adaptive` at most longest_stride, so that no
/// feature of the index is passed over unseen; they end where F jumps (way_to_edge) and go on beyond, so that each
/// method keeps its order (integrator.h); outside every medium the ray is one straight segment (clear_way). `adaptive`
/// further keeps the local error of every step, as the final displacement it can cause, below 1/kStepShare of the
/// tolerance. For a perspective camera, errors δx at path length s and δp cause at most (|δx|/s + |δp|/|p|) / pixel;
/// for an orthographic one (|δx| + |δp|/|p| (end - s)) / pixel, where end is `sight` or the longest path that settings
/// allow. BentHit::error_px is their sum over all steps: it is about the displacement's error where steps are few to a
/// feature, pessimistic (that of order 4) where they are many, and knows nothing of chords and of a field that spreads
/// rays apart. Against 1e-6 pixels the displacement's error stays below the tolerance (README, How fast). To it come,
/// of adaptive, the part of the tolerance that it may miss unseen (kUnseenShare), and what interpolation in lattices
/// does to 95 % of rays at most (AirInstant::interpolation).
///
/// Surfaces: surface_search.h; chords deviate from the curve by less than half of the tolerance.
///
/// Never hangs, and nothing that is not finite leaves: see BentHit::End.
#pragma once

#include <algorithm>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <optional>

#include "reference/trace/geometry.h"
#include "reference/trace/integrator.h"
#include "reference/trace/lone_surface.h"
#include "reference/trace/ray_differential.h"
#include "reference/trace/surface_search.h"

namespace eikonal::reference {

/// A step of adaptive may err by this part of the tolerance. Over a lone surface the estimate never misses the error,
/// elsewhere steps as long as a feature may be lucky.
inline constexpr double kStepShare = 32, kStepShareOverSurface = 5;
/// What turns a ray by less than this part of the tolerance does not matter: a blob to adaptive's choice of steps (its
/// force counts all the same) and to first order, air over a lone surface, and what first order redirects a ray by.
inline constexpr double kQuietShare = 100;
/// Steps as long as a feature miss some of it by luck, and their estimates with it: among blobs, thin screens and
/// surfaces together 95 % of rays were off by no more than the estimate and this part of the tolerance. Over a lone
/// surface it is kQuietShare's.
inline constexpr double kUnseenShare = 8;
/// The finest tolerance, tolerance_px * pixel, that is of use: tighter ones count as this [rad or m].
inline constexpr double kFinestTolerance = 1e-13;
/// A ray is trapped if it has turned through this angle [rad], every bend counted, on a way whose ends are closer to
/// each other than this part of its length: what gets anywhere turns far less, or gets ahead, as rays do in a guide
/// that are less than 88 degrees from its axis.
inline constexpr double kTrapTurn = 64 * 3.141592653589793, kTrapAdvance = 1.0 / 32;
/// What adaptive reaches at its finest in the closed forms of PHYSICS.md#closed-forms [m, and of p].
inline constexpr double kClosedFormError = 1e-9;

/// A place that many rays start from, as all of a perspective camera's do.
struct KnownOrigin {
    dvec3 place{0, 0, 0};
    double speed = 0;                ///< AirInstant::speed there
    LoneSurface::AtHeight height{};  ///< if there is a lone surface
};

struct TraceSettings {
    Integrator integrator = Integrator::Adaptive;
    double tolerance_px = 0.01;  ///< of the final displacement [pixels] > 0
    bool perspective = true;
    double pixel = 1e-3;  ///< size of a pixel > 0: [rad] (perspective) or [m] (orthographic)
    /// The longest step beside those that the field allows, as du times the speed at the origin, so that a method keeps
    /// one du (leapfrog is symplectic only then) [m]; 0: the field's alone. For `layers` the thickness of a
    /// slice; 0: kSlicesPerDropoff in a dropoff.
    double step = 0;
    int step_budget = 100000;  ///< attempts of steps > 0
    /// For rays that are only tried: what ends them as the budget does, if that is less.
    int tried_steps = std::numeric_limits<int>::max();
    /// Whether a trapped ray ends as soon as it is known to be (kTrapTurn), not only by its budget.
    bool end_trapped = false;
    double far = 1e6;  ///< a ray that met nothing on this length of path ends [m] > 0
    /// Length of path by which an error of direction displaces an orthographic ray, at most: that to the farthest thing
    /// in sight [m] > 0.
    double sight = std::numeric_limits<double>::infinity();
    double u_end = std::numeric_limits<double>::infinity();  ///< it ends at this parameter
    double distance = 0;  ///< path from the camera to the ray's origin, for secondary rays [m] >= 0
    /// For `layers` and `mirror`: baseline_surface() of baselines.h.
    std::optional<SurfaceSpec> surface;
    /// The field's only medium, if that is a surface: for speed, may be left out. Where all that it can bend a ray by
    /// does not matter adaptive goes straight; first-order takes its closed form.
    std::shared_ptr<const LoneSurface> lone;
    /// For speed, may be left out.
    std::optional<KnownOrigin> origin;

    /// From where the rays start: makes `origin` known, `lone` being set if it ever is.
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
        Surface,     ///< met `surface`
        Escaped,     ///< went on for `far` metres, or to u_end: `at.p` tells which background it sees
        Trapped,     ///< goes round and round (kTrapTurn), or bends by more than numbers hold
        Unfinished,  ///< its step budget ended it
        NoIndex      ///< came to where n <= 0
    };
    End end = End::Escaped;
    bool hit = false;  ///< end == Surface
    Hit surface;
    RayState at;          ///< the ray's end; at.x is surface.point for a hit
    double length = 0;    ///< of path from the origin [m]
    int steps = 0;        ///< attempted
    double error_px = 0;  ///< estimate, see above [pixels]

    /// Whether it came to an end where there is something to see.
    bool ended() const { return end == End::Surface || end == End::Escaped; }
    /// Ends the ray on a surface.
    void meet(const Hit& there) {
        end = End::Surface;
        hit = true;
        surface = there;
        at.x = there.point;
    }
};

/// What adaptive's estimate of its error is more than the error, about; and how often a ray is followed anew, in finer
/// steps, whose estimate is that much above its tolerance.
inline constexpr double kPessimism = 2;
inline constexpr int kMostRetries = 2;
/// Whether it is, of a ray that came to an end.
bool too_far_off(const BentHit& end, double tolerance_px);

/// What is off by two independent errors of equal rms, one along each of two axes, is off by less than this times the
/// rms of both in 95 % of all cases: √(-ln 0.05).
inline constexpr double kMostOfRms = 1.731;

/// Called with every step that the ray takes. Those after its end may be among them, and a ray that is followed anew
/// begins at u = 0 again.
using StepRecorder = std::function<void(const Step&)>;

/// geometry may be null: nothing is met. direction: unit. bundle, if given, comes as its pixels leave the origin (x
/// change of the origin, p of the unit direction) and is left as it arrives at the end, not yet moved onto the surface
/// (on_surface). Only the four true integrators follow it.
BentHit trace(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
              const TraceSettings& settings, Bundle* bundle = nullptr, const StepRecorder& recorder = {});

/// Whether it is worth asking for the clear way where F is this [1/m]: anything larger is within a medium's bounds, and
/// beyond them the tail of one goes on for ever.
inline bool may_be_clear(const dvec3& force) {
    constexpr double kTail = 1e-12;
    return glm::dot(force, force) <= kTail * kTail;
}

/// How far chords may leave the curve.
SurfaceSearch::Deviation chord_deviation(const TraceSettings& settings);

/// Whether this integrator follows bundles.
constexpr bool follows_bundles(Integrator integrator) {
    return integrator <= Integrator::Euler;
}

}  // namespace eikonal::reference
