#include "reference/trace/perturbation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <vector>

namespace eikonal::reference {
namespace {

/// Length of a step in a field's longest steps. A step samples F at its ends and its middle, so samples are no farther
/// apart than one longest step. A step that errs by more than 1/kStepShare of the tolerance is halved.
constexpr double kStretch = 2;

/// The further force on a perturbed ray, for second order.
dvec3 further(const ForceJet& jet, const dvec3& x1, const dvec3& dx1) {
    return jet.by_position * x1 + jet.by_direction * dx1;
}

struct Perturbed {
    dvec3 x1{0}, dx1{0}, x2{0}, dx2{0};
    double error = 0;  ///< error of x1⊥/D by the quadrature [rad]
    int steps = 0;
    double way = 0;  ///< distance that the quadrature has covered [m]
    bool no_index = false, unfinished = false;
};

class Quadrature {
  public:
    Quadrature(const AirInstant& field, const TraceSettings& settings, const dvec3& origin, const dvec3& direction,
               double speed)
        : field_(field),
          settings_(settings),
          second_(settings.integrator == Integrator::SecondOrder),
          origin_(origin),
          direction_(direction),
          speed_(speed) {}

    /// Integrates over 0 … distance [m]. Ends earlier if `walk`, which gets every step of the perturbed ray, returns
    /// true.
    Perturbed over(double distance, const std::function<bool(const Step&)>& walk = {});

  private:
    dvec3 at(double w) const { return origin_ + w * direction_; }
    ForceJet sample(double w) const {
        ForceJet jet;
        if (second_)
            jet = field_.force_jet(at(w), speed_ * direction_);
        else
            jet.force = field_.force(at(w), speed_ * direction_);
        return jet;
    }
    bool without_index(double w) const;
    void straight(double length);
    double off(const ForceJet& from, const ForceJet& middle, const ForceJet& to, double length) const;
    void bent(const ForceJet& from, const ForceJet& middle, const ForceJet& to, double length);
    dvec3 shift() const { return sum_.x1 + sum_.x2; }
    dvec3 turn() const { return sum_.dx1 + sum_.dx2; }

    const AirInstant& field_;
    const TraceSettings& settings_;
    bool second_;
    dvec3 origin_, direction_;
    double speed_;
    Perturbed sum_;
    dvec3 force_from_{0}, force_to_{0};  ///< on the perturbed ray, at the ends of the last step
};

void Quadrature::straight(double length) {
    const double h = length / speed_;
    sum_.x1 += h * sum_.dx1;
    sum_.x2 += h * sum_.dx2;
    force_from_ = force_to_ = dvec3(0);
}

/// Error estimate: a part of the trapezoidal rule's error. It fits the longest steps and is pessimistic for shorter
/// ones.
double Quadrature::off(const ForceJet& from, const ForceJet& middle, const ForceJet& to, double length) const {
    return glm::length(from.force - 2.0 * middle.force + to.force) * length / (90 * speed_ * speed_);
}

void Quadrature::bent(const ForceJet& from, const ForceJet& middle, const ForceJet& to, double length) {
    const double h = length / speed_;
    const dvec3 &Fa = from.force, &Fm = middle.force, &Fb = to.force, x1 = sum_.x1, dx1 = sum_.dx1;
    sum_.x1 += h * dx1 + h * h / 6 * (Fa + 2.0 * Fm);
    sum_.dx1 += h / 6 * (Fa + 4.0 * Fm + Fb);
    sum_.error += off(from, middle, to, length);
    force_from_ = Fa;
    force_to_ = Fb;
    if (!second_) return;
    // The state at the middle, by the parabola through these three forces.
    const dvec3 x1m = x1 + 0.5 * h * dx1 + h * h / 96 * (7.0 * Fa + 6.0 * Fm - Fb);
    const dvec3 dx1m = dx1 + h / 24 * (5.0 * Fa + 8.0 * Fm - Fb);
    const dvec3 Ga = further(from, x1, dx1), Gm = further(middle, x1m, dx1m), Gb = further(to, sum_.x1, sum_.dx1);
    sum_.x2 += h * sum_.dx2 + h * h / 6 * (Ga + 2.0 * Gm);
    sum_.dx2 += h / 6 * (Ga + 4.0 * Gm + Gb);
    force_from_ += Ga;
    force_to_ += Gb;
}

/// Whether the straight ray has come to n <= 0. |p|² = |p0|² + 2 ∫ F·dx holds along it too, so the field is asked only
/// where |p|² comes near zero.
bool Quadrature::without_index(double w) const {
    return speed_ + 2 * glm::dot(sum_.dx1, direction_) < 0.25 * speed_ && !(field_.speed(at(w)) > 0);
}

Perturbed Quadrature::over(double distance, const std::function<bool(const Step&)>& walk) {
    const double place = 1e-12 * (1 + glm::length(origin_) + std::min(distance, 1e6));
    const double allowed =
        settings_.tolerance_px * settings_.pixel / kStepShare / (settings_.perspective ? 1 : distance);
    double w = 0;
    ForceJet here = sample(0);
    // Takes a step. True if it was the last.
    const auto take = [&](double length, bool straight_on, const auto& integrate) {
        const dvec3 shift_before = shift(), turn_before = turn(), p0 = speed_ * direction_;
        integrate();
        Step step;
        step.from = {at(w) + shift_before, p0 + turn_before, w / speed_};
        w += length;
        if (!walk) return false;
        step.h = length / speed_;
        step.straight = straight_on;
        step.shift = step.h * p0 + (shift() - shift_before);
        step.turn = turn() - turn_before;
        step.force_from = force_from_;
        step.force_to = force_to_;
        return walk(step);
    };
    while (distance - w > place) {
        if (++sum_.steps > settings_.most_steps()) {
            sum_.unfinished = true;
            break;
        }
        if (without_index(w)) {
            sum_.no_index = true;
            break;
        }
        const double clear = may_be_clear(here.force) ? std::min(field_.clear_way(at(w), direction_), distance - w) : 0;
        double length = distance - w, edge = clear;
        if (!(clear > 0)) {
            const double longest = field_.longest_step(at(w), direction_);
            length = std::min(length, settings_.step > 0 ? std::min(longest, settings_.step) : kStretch * longest);
            edge = field_.way_to_edge(at(w), direction_);
        }
        if (clear > 0 || edge <= place) {
            // Go on, just beyond the edge.
            const double way = std::min(std::max(edge, 0.0) + place, distance - w);
            if (take(way, true, [&] { straight(way); })) break;
            here = sample(w);
            continue;
        }
        // A point exactly on the edge might count as its other side.
        if (edge <= length) length = edge - 0.5 * place;
        ForceJet there = sample(w + length), middle = sample(w + 0.5 * length);
        if (settings_.step == 0 && !(off(here, middle, there, length) <= allowed)) {
            length *= 0.5;
            there = middle;
            middle = sample(w + 0.5 * length);
        }
        if (take(length, false, [&] { bent(here, middle, there, length); })) break;
        here = there;
    }
    sum_.way = w;
    return sum_;
}

/// First order in closed form, if there is one within the tolerance.
std::optional<Perturbed> closed_form(const AirInstant& field, const TraceSettings& settings, const dvec3& origin,
                                     const dvec3& direction, double speed, double distance) {
    if (!std::isfinite(distance)) return {};
    const double tolerance = settings.tolerance_px * settings.pixel / (settings.perspective ? 1 : distance);
    const double quiet = tolerance / kQuietShare, inverse_square = 1 / (speed * speed);
    Perturbed result;
    result.steps = 1;
    if (settings.lone) {
        const LoneSurface& lone = *settings.lone;
        const LoneSurface::AtHeight from =
            settings.origin && settings.origin->place == origin ? settings.origin->height : lone.at(origin);
        if (lone.is_quiet(from.height, direction, distance, 2 * quiet / distance)) return result;
        const auto pull = lone.pull(from, direction, distance);
        if (!pull) return {};
        result.x1 = inverse_square * *pull;
        return result;
    }
    const auto bend = field.straight_bend(origin, direction, distance, quiet);
    if (!bend) return {};
    result.error = bend->error * glm::length(bend->value) * inverse_square / distance;
    if (!(result.error <= tolerance)) return {};
    result.x1 = inverse_square * bend->value;
    return result;
}

}  // namespace

BentHit trace_perturbed(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
                        const TraceSettings& settings, const StepRecorder& recorder) {
    BentHit result;
    const double speed = settings.launch_speed(field, origin);
    result.at = {origin, speed * direction, 0};
    const double far = std::min(settings.far, settings.u_end * speed);
    const auto nearest = [&](const dvec3& from, const dvec3& along) {
        return geometry ? geometry->nearest(from, along, 0, far) : std::optional<Contact>();
    };
    const std::optional<Contact> straight = nearest(origin, direction);
    const double distance = straight ? straight->t : far;
    std::optional<Perturbed> closed;
    if (settings.integrator == Integrator::FirstOrder && settings.step == 0)
        closed = closed_form(field, settings, origin, direction, speed, distance);
    const Perturbed sum = closed ? *closed : Quadrature(field, settings, origin, direction, speed).over(distance);
    result.steps = std::min(sum.steps, settings.most_steps());
    result.error_px = sum.error / settings.pixel * (settings.perspective ? 1 : distance);
    if (!(speed > 0) || sum.no_index || sum.unfinished) {
        result.length = sum.way;
        result.end = sum.unfinished ? BentHit::End::Unfinished : BentHit::End::NoIndex;
        return result;
    }
    const auto across = [&](const dvec3& v) { return v - glm::dot(v, direction) * direction; };
    dvec3 shift = across(sum.x1);
    if (settings.integrator == Integrator::SecondOrder)
        shift += across(sum.x2) - glm::dot(sum.x1, direction) / speed * across(sum.dx1);
    RayState& ray = result.at;
    // If no bend matters, the straight ray has already found what is seen.
    const double room = settings.step > 0 ? 0 : settings.tolerance_px * settings.pixel / kQuietShare;
    const double limit = room * (settings.perspective ? distance : 1);
    const auto arrive = [&](const std::optional<Contact>& contact, const dvec3& from, const dvec3& along) {
        result.length = contact ? contact->t : far;
        if (!contact) return;
        geometry->look(*contact, from, along, result.surface);
        result.end = BentHit::End::Surface;
        result.hit = true;
    };
    if (glm::dot(shift, shift) > limit * limit) {
        dvec3 along = direction;
        if (settings.perspective)
            along = glm::normalize(distance * direction + shift);
        else
            ray.x += shift;
        ray.p = speed * along;
        arrive(nearest(ray.x, along), ray.x, along);
    } else {
        arrive(straight, origin, direction);
    }
    if (recorder) recorder(straight_step(ray, result.length));
    ray.u += result.length / speed;
    ray.x = result.hit ? result.surface.point : ray.x + result.length / speed * ray.p;
    return result;
}

BentHit perturbed_curve(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
                        const TraceSettings& settings, const StepRecorder& recorder) {
    BentHit result;
    const double speed = field.speed(origin);
    result.at = {origin, speed * direction, 0};
    if (!(speed > 0)) {
        result.end = BentHit::End::NoIndex;
        return result;
    }
    SurfaceSearch search(geometry, chord_deviation(settings), settings.distance);
    std::vector<double> lengths;  // length of path before each step
    std::vector<double> starts;   // u of each step
    std::optional<SurfaceSearch::Met> met;
    const auto walk = [&](const Step& step) {
        if (recorder) recorder(step);
        const double length = step.length();
        starts.push_back(step.from.u);
        lengths.push_back(result.length);
        result.length += length;
        result.at = step.to();
        met = search.add(step, length, step.bend());
        return met.has_value();
    };
    const double distance = std::min(settings.far, settings.u_end * speed);
    const Perturbed sum = Quadrature(field, settings, origin, direction, speed).over(distance, walk);
    result.steps = std::min(sum.steps, settings.most_steps());
    result.error_px = sum.error / settings.pixel * (settings.perspective ? 1 : distance);
    if (sum.unfinished) result.end = BentHit::End::Unfinished;
    if (sum.no_index) result.end = BentHit::End::NoIndex;
    if (!met) met = search.finish();
    if (!met) return result;
    const auto step = std::lower_bound(starts.begin(), starts.end(), met->step.from.u) - starts.begin();
    result.length = lengths[static_cast<std::size_t>(step)] + met->step.length(met->theta);
    result.at = met->step.at(met->theta);
    result.meet(met->hit);
    return result;
}

}  // namespace eikonal::reference
