#include "reference/trace/bent_ray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "reference/trace/baselines.h"
#include "reference/trace/perturbation.h"

namespace eikonal::reference {
namespace {

/// Places count as the same if they are closer together than this, relative to 1 m plus their coordinates.
constexpr double kSamePlace = 1e-12;
/// F counts as constant up to an edge if this changes the direction by less [rad].
constexpr double kEdgeTurn = 1e-12;

/// A step may grow to this many times the last one if its error is below this part of the allowed error.
constexpr double kMostGrowth = 2, kMostGrowthError = 0.018;
/// How far before an edge the edge's direction is probed [longest steps].
constexpr double kProbe = 1e-3;

bool finite(const dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// x^(1/5) of a positive normal x, at most 1 % too small, along the chord from one power of two to the next.
double fifth_root(double x) {
    constexpr std::array<double, 5> kRoots = {1, 1.148698354997035, 1.3195079107728942, 1.5157165665103982,
                                              1.7411011265922482};
    const int exponent = std::ilogb(x), fifth = (exponent + 5 * 1000) / 5 - 1000;
    const double chord = 1 + (kRoots[1] - 1) * (std::scalbn(x, -exponent) - 1);
    return std::scalbn(chord * kRoots[static_cast<std::size_t>(exponent - 5 * fifth)], fifth);
}

class Tracer {
  public:
    Tracer(const AirInstant& field, const Geometry* geometry, const TraceSettings& settings, Bundle* bundle,
           const StepRecorder& recorder)
        : field_(field),
          settings_(settings),
          tolerance_(std::max(settings.tolerance_px * settings.pixel, kFinestTolerance)),
          adaptive_(settings.integrator == Integrator::Adaptive),
          bundle_(bundle),
          recorder_(recorder),
          search_(geometry, chord_deviation(settings), settings.distance) {
        if (bundle) bundles_.emplace();
        if (settings.lone && adaptive_) lone_ = settings.lone.get();
    }

    BentHit run(const dvec3& origin, const dvec3& direction);

  private:
    using End = BentHit::End;

    bool go_straight(double way);
    std::optional<End> go_bent();
    bool accept(const Step& step);
    double error(const Step& step, double speed) const;
    double same_place() const;
    double clear_way() const;
    bool trapped();
    double nudge(double way);
    void enter(double reach, const dvec3& before);
    void finish(const SurfaceSearch::Met& met);

    /// The state at the start of one of the last steps. It is restored if a surface is met on that step.
    struct Mark {
        double u, length, error;
        int steps;
    };

    const AirInstant& field_;
    const TraceSettings& settings_;
    double tolerance_;       ///< [rad or m]
    double longest_ = 0;     ///< way [m]
    double quiet_turn_ = 0;  ///< turn that does not matter [rad]
    bool adaptive_, bent_ = false;
    const LoneSurface* lone_ = nullptr;
    Bundle* bundle_;
    const StepRecorder& recorder_;
    SurfaceSearch search_;
    RayState state_;
    dvec3 force_{0};
    double proposed_ = std::numeric_limits<double>::infinity();  ///< length of the next step, by the last error [m]
    double launch_speed_ = 1;
    double nudge_ = 0;  ///< of the last step, if it only went over an edge, else 0 [m]
    double error_ = 0;  ///< [rad or m]
    /// The angle turned since the ray last made headway, and the path length and place of that moment.
    double turned_ = 0, turned_from_ = 0;
    dvec3 turned_at_{0};
    BentHit result_;
    std::array<Mark, SurfaceSearch::kMostPieces> marks_;                     ///< of the last accepted steps
    std::optional<std::array<Bundle, SurfaceSearch::kMostPieces>> bundles_;  ///< beside the marks
    std::size_t accepted_ = 0;
};

double Tracer::same_place() const {
    const dvec3 size = glm::abs(state_.x);
    return kSamePlace * (1 + std::max(size.x, std::max(size.y, size.z)));
}

/// The final displacement that the local errors of a step may cause [rad or m].
double Tracer::error(const Step& step, double speed) const {
    const double x = glm::length(step.error_x), p = glm::length(step.error_p) / speed;
    const double s = result_.length + step.h * speed;
    if (settings_.perspective) return x / (settings_.distance + s) + p;
    const double ahead =
        std::min(std::min(settings_.far, settings_.sight) - s, (settings_.u_end - step.from.u - step.h) * speed);
    return x + p * std::max(ahead, 0.0);
}

/// Length of the way ahead that is straight [m].
double Tracer::clear_way() const {
    if (lone_) {
        const double way = lone_->clear_way(state_.x, glm::normalize(state_.p), quiet_turn_, longest_);
        if (way > 0) return way;
    }
    return may_be_clear(force_) ? field_.clear_way(state_.x, glm::normalize(state_.p)) : 0;
}

/// Whether the ray is trapped.
bool Tracer::trapped() {
    if (!settings_.end_trapped) return false;
    if (!(turned_ > kTrapTurn)) return false;
    if (glm::length(state_.x - turned_at_) < kTrapAdvance * (result_.length - turned_from_)) return true;
    turned_ = 0;
    turned_from_ = result_.length;
    turned_at_ = state_.x;
    return false;
}

/// Appends a step to the ray. True if a surface ends the ray.
bool Tracer::accept(const Step& step) {
    const std::size_t slot = accepted_++ % marks_.size();
    marks_[slot] = {step.from.u, result_.length, error_, result_.steps};
    if (bundle_) {
        (*bundles_)[slot] = *bundle_;
        advance(field_, step, 1, *bundle_);
    }
    if (recorder_) recorder_(step);
    const double length = step.length(), bend = step.bend();
    result_.length += length;
    turned_ += bend;
    state_ = step.to();
    if (const auto met = search_.add(step, length, bend)) {
        finish(*met);
        return true;
    }
    return false;
}

void Tracer::finish(const SurfaceSearch::Met& met) {
    for (std::size_t slot = 0; slot < std::min(accepted_, marks_.size()); ++slot) {
        const Mark& mark = marks_[slot];
        if (mark.u != met.step.from.u) continue;
        result_.length = mark.length + met.step.length(met.theta);
        error_ = mark.error;
        result_.steps = mark.steps;
        if (bundle_) {
            *bundle_ = (*bundles_)[slot];
            advance(field_, met.step, met.theta, *bundle_);
        }
    }
    error_ += error(met.step, glm::length(met.step.from.p));
    result_.end = End::Surface;
    result_.hit = true;
    result_.surface = met.hit;
    state_ = met.step.at(met.theta);
    state_.x = met.hit.point;
}

/// How far beyond an edge `way` ahead the ray goes on [m]. The distance doubles each time that rounding has left the
/// ray on the near side of an edge that it grazes.
double Tracer::nudge(double way) {
    nudge_ = way <= 2 * nudge_ ? 2 * nudge_ : same_place();
    return nudge_;
}

/// Called just beyond an edge. F was `before`. No other edge lies within `reach` [m] before it.
void Tracer::enter(double reach, const dvec3& before) {
    force_ = field_.force(state_.x, state_.p);
    if (bundle_)
        pass_edge(field_, state_, std::min(reach, kProbe * field_.longest_step(state_.x)), before, force_, *bundle_);
}

/// Crosses a way without any medium and enters the next medium. True if a surface ends the ray.
bool Tracer::go_straight(double way) {
    const double speed = glm::length(state_.p);
    const double remaining = std::min(settings_.far - result_.length, (settings_.u_end - state_.u) * speed);
    ++result_.steps;
    if (way >= remaining) return accept(straight_step(state_, remaining));
    if (accept(straight_step(state_, std::min(way + nudge(way), remaining)))) return true;
    enter(0.5 * way, dvec3(0));
    return false;
}

/// Takes one step, as long as the field and the error allow. Returns what ends the ray, if anything.
std::optional<BentHit::End> Tracer::go_bent() {
    bent_ = true;
    const double speed = glm::length(state_.p);
    const dvec3 d = state_.p / speed;
    const double feature =
        adaptive_ ? field_.longest_stride(state_.x, d, quiet_turn_) : field_.longest_step(state_.x, d);
    const double remaining = std::min(settings_.far - result_.length, (settings_.u_end - state_.u) * speed);
    double length = std::min(feature, remaining);
    if (settings_.step > 0) length = std::min(length, settings_.step * (speed / launch_speed_));
    if (adaptive_) length = std::min(length, proposed_);
    const double place = same_place(), edge = field_.way_to_edge(state_.x, d);
    const bool cut = edge <= length + place;
    if (cut) {
        const double bend = glm::length(force_) / (speed * speed) * edge;
        if (edge <= std::max(place, 2 * nudge_) || bend * edge <= kEdgeTurn * feature) {
            ++result_.steps;
            const dvec3 before = force_;
            const double way = std::min(edge + nudge(edge), remaining);
            if (accept(parabolic_step(state_, force_, way / speed))) return End::Surface;
            enter(kProbe * feature, before);
            return {};
        }
        // The ray may bend towards the edge, so the step stays short of it.
        length = edge * (1 - std::min(0.5, bend));
    }
    nudge_ = 0;
    double h = length / speed, off = 0;
    Step step;
    while (true) {
        if (++result_.steps > settings_.most_steps()) return End::Unfinished;
        step = bent_step(settings_.integrator, field_, state_, force_, h);
        off = error(step, speed);
        if (!adaptive_) break;
        // The error of order 4 grows with h^5.
        const double allowed = tolerance_ / (lone_ ? kStepShareOverSurface : kStepShare);
        double factor = kMostGrowth;
        if (!(off <= kMostGrowthError * allowed)) factor = std::isfinite(off) ? 0.9 * fifth_root(allowed / off) : 0;
        if (off <= allowed || h * speed <= place) {
            const double next = h * speed * std::max(factor, 0.2);
            proposed_ = cut && factor > 1 ? std::max(next, proposed_) : next;
            break;
        }
        h *= std::clamp(factor, 0.1, 0.9);
    }
    const dvec3 p = state_.p + step.turn;
    if (!finite(step.shift) || !finite(p) || !finite(step.force_to) || p == dvec3(0)) return End::Trapped;
    error_ += off;
    if (accept(step)) return End::Surface;
    force_ = step.force_to;
    // A ray has |p| = n. If the steps are exact, it slows down before it comes to a place with n <= 0.
    if ((!adaptive_ || glm::length(p) < 0.5 * launch_speed_) && !(field_.speed(state_.x) > 0)) return End::NoIndex;
    return {};
}

BentHit Tracer::run(const dvec3& origin, const dvec3& direction) {
    launch_speed_ = settings_.launch_speed(field_, origin);
    state_ = {origin, direction, 0};
    if (!(launch_speed_ > 0)) {
        result_.end = End::NoIndex;
        result_.at = state_;
        return result_;
    }
    state_.p = launch_speed_ * direction;
    turned_at_ = origin;
    longest_ = std::min(settings_.far, settings_.u_end * launch_speed_);
    quiet_turn_ = tolerance_ / kQuietShare / (settings_.perspective ? 1 : std::min(longest_, settings_.sight));
    if (bundle_ || !(clear_way() > 0)) force_ = field_.force(state_.x, state_.p);
    if (bundle_) *bundle_ = launch(*bundle_, state_, force_);
    std::optional<End> end;
    while (!end) {
        const double place = same_place();
        if (settings_.far - result_.length <= place || settings_.u_end - state_.u <= place) {
            end = End::Escaped;
        } else if (result_.steps >= settings_.most_steps()) {
            end = End::Unfinished;
        } else if (trapped()) {
            end = End::Trapped;
        } else {
            if (const double way = clear_way(); way > 0) {
                if (go_straight(way)) end = End::Surface;
            } else {
                end = go_bent();
            }
        }
    }
    result_.end = *end;
    if (*end != End::Surface)
        if (const auto met = search_.finish()) finish(*met);
    result_.steps = std::min(result_.steps, settings_.most_steps());
    if (adaptive_ && (lone_ || bent_)) error_ += tolerance_ / (lone_ ? kQuietShare : kUnseenShare);
    result_.error_px = std::min(error_ / settings_.pixel, std::numeric_limits<double>::max());
    result_.at = state_;
    return result_;
}

/// trace() without the error of interpolation.
BentHit follow(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
               const TraceSettings& settings, Bundle* bundle, const StepRecorder& recorder) {
    switch (settings.integrator) {
        case Integrator::Layers:
            return trace_layers(field, geometry, origin, direction, settings, recorder);
        case Integrator::Mirror:
            return trace_mirror(field, geometry, origin, direction, settings, recorder);
        case Integrator::FirstOrder:
        case Integrator::SecondOrder:
            return trace_perturbed(field, geometry, origin, direction, settings, recorder);
        default:
            break;
    }
    const std::optional<Bundle> launched = bundle ? std::optional(*bundle) : std::nullopt;
    BentHit result = Tracer(field, geometry, settings, bundle, recorder).run(origin, direction);
    if (settings.integrator != Integrator::Adaptive || !too_far_off(result, settings.tolerance_px)) return result;
    // The errors of the steps have added up. Follow the ray again with a tolerance that is smaller by as much.
    TraceSettings finer = settings;
    for (int i = 0; i < kMostRetries && too_far_off(result, settings.tolerance_px); ++i) {
        finer.tolerance_px *= settings.tolerance_px / result.error_px;
        if (bundle) *bundle = *launched;
        result = Tracer(field, geometry, finer, bundle, recorder).run(origin, direction);
    }
    return result;
}

}  // namespace

bool too_far_off(const BentHit& end, double tolerance_px) {
    return end.ended() && end.error_px > kPessimism * tolerance_px;
}

SurfaceSearch::Deviation chord_deviation(const TraceSettings& settings) {
    const double half = 0.5 * settings.tolerance_px * settings.pixel;
    return settings.perspective ? SurfaceSearch::Deviation{half, 0} : SurfaceSearch::Deviation{0, half};
}

BentHit trace(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
              const TraceSettings& settings, Bundle* bundle, const StepRecorder& recorder) {
    BentHit result = follow(field, geometry, origin, direction, settings, bundle, recorder);
    if (settings.integrator == Integrator::Layers || settings.integrator == Integrator::Mirror) return result;
    const AirInstant::Interpolation off = field.interpolation(origin, result.at.x);
    const double way = glm::distance(origin, result.at.x);
    double seen = off.shift;
    if (settings.perspective) seen = result.hit ? off.shift / (way + settings.distance) : off.turn;
    result.error_px += kMostOfRms * seen / settings.pixel;
    result.error_px = std::min(result.error_px, std::numeric_limits<double>::max());
    return result;
}

}  // namespace eikonal::reference
