#include "reference/perturbation.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace eikonal::reference {
namespace {

/// A step evaluates F at its ends and its middle: this many of a field's longest steps leave no wider gap between.
/// Where that errs by more than 1/kStepShare of the tolerance, half of it.
constexpr double kStretch = 2;

/// For second order: the further force on a perturbed ray.
dvec3 further(const ForceJet& jet, const dvec3& x1, const dvec3& dx1) {
    return jet.by_position * x1 + jet.by_direction * dx1;
}

struct Perturbed {
    dvec3 x1{0}, dx1{0}, x2{0}, dx2{0};
    double error = 0;  ///< of x1⊥/D by the quadrature [rad]
    int steps = 0;
    bool no_index = false, trapped = false;
};

class Quadrature {
  public:
    Quadrature(const FieldInstant& field, const TraceSettings& settings, const dvec3& origin, const dvec3& direction,
               double speed)
        : field_(field),
          settings_(settings),
          second_(settings.integrator == Integrator::SecondOrder),
          origin_(origin),
          direction_(direction),
          speed_(speed) {}

    /// Over 0 … distance [m].
    Perturbed over(double distance);

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
    bool closed_form(double distance);
    void straight(double length);
    double off(const ForceJet& from, const ForceJet& middle, const ForceJet& to, double length) const;
    void bent(const ForceJet& from, const ForceJet& middle, const ForceJet& to, double length);

    const FieldInstant& field_;
    const TraceSettings& settings_;
    bool second_;
    dvec3 origin_, direction_;
    double speed_;
    Perturbed sum_;
};

void Quadrature::straight(double length) {
    const double h = length / speed_;
    sum_.x1 += h * sum_.dx1;
    sum_.x2 += h * sum_.dx2;
}

/// A part of what the trapezoidal rule is wrong by: enough at the longest steps, too much at shorter ones.
double Quadrature::off(const ForceJet& from, const ForceJet& middle, const ForceJet& to, double length) const {
    return glm::length(from.force - 2.0 * middle.force + to.force) * length / (90 * speed_ * speed_);
}

void Quadrature::bent(const ForceJet& from, const ForceJet& middle, const ForceJet& to, double length) {
    const double h = length / speed_;
    const dvec3 &Fa = from.force, &Fm = middle.force, &Fb = to.force, x1 = sum_.x1, dx1 = sum_.dx1;
    sum_.x1 += h * dx1 + h * h / 6 * (Fa + 2.0 * Fm);
    sum_.dx1 += h / 6 * (Fa + 4.0 * Fm + Fb);
    sum_.error += off(from, middle, to, length);
    if (!second_) return;
    // The middle, through the parabola that has these three forces.
    const dvec3 x1m = x1 + 0.5 * h * dx1 + h * h / 96 * (7.0 * Fa + 6.0 * Fm - Fb);
    const dvec3 dx1m = dx1 + h / 24 * (5.0 * Fa + 8.0 * Fm - Fb);
    const dvec3 Ga = further(from, x1, dx1), Gm = further(middle, x1m, dx1m), Gb = further(to, sum_.x1, sum_.dx1);
    sum_.x2 += h * sum_.dx2 + h * h / 6 * (Ga + 2.0 * Gm);
    sum_.dx2 += h / 6 * (Ga + 4.0 * Gm + Gb);
}

/// |p|² = |p0|² + 2 ∫ F·dx holds along the straight ray too: there is an index unless that comes near nothing.
bool Quadrature::without_index(double w) const {
    return speed_ + 2 * glm::dot(sum_.dx1, direction_) < 0.25 * speed_ && !(field_.speed(at(w)) > 0);
}

/// First order without steps, where there is a form for it that is within the tolerance.
bool Quadrature::closed_form(double distance) {
    if (!std::isfinite(distance)) return false;
    const double tolerance = settings_.tolerance_px * settings_.pixel / (settings_.perspective ? 1 : distance);
    const double quiet = tolerance / kQuietShare;
    dvec3 pull(0);
    if (settings_.lone) {
        if (!settings_.lone->is_quiet(origin_, direction_, distance, 2 * quiet / distance)) {
            const auto bent = settings_.lone->pull(origin_, direction_, distance);
            if (!bent) return false;
            pull = *bent;
        }
    } else {
        const auto bent = field_.pull(origin_, direction_, distance, quiet);
        if (!bent) return false;
        const double error = bent->error * glm::length(bent->value) / (speed_ * speed_ * distance);
        if (!(error <= tolerance)) return false;
        sum_.error = error;
        pull = bent->value;
    }
    sum_.x1 = pull / (speed_ * speed_);
    sum_.steps = 1;
    return true;
}

Perturbed Quadrature::over(double distance) {
    if (!second_ && settings_.step == 0 && closed_form(distance)) return sum_;
    const double place = 1e-12 * (1 + glm::length(origin_) + std::min(distance, 1e6));
    const double allowed =
        settings_.tolerance_px * settings_.pixel / kStepShare / (settings_.perspective ? 1 : distance);
    double w = 0;
    ForceJet here = sample(0);
    while (distance - w > place) {
        if (++sum_.steps > settings_.step_budget) {
            sum_.trapped = true;
            break;
        }
        if (without_index(w)) {
            sum_.no_index = true;
            break;
        }
        const double clear = here.force == dvec3(0) ? std::min(field_.clear_way(at(w), direction_), distance - w) : 0;
        double length = distance - w, edge = clear;
        if (!(clear > 0)) {
            const double longest = field_.longest_step(at(w), direction_);
            length = std::min(length, settings_.step > 0 ? std::min(longest, settings_.step) : kStretch * longest);
            edge = field_.way_to_edge(at(w), direction_);
        }
        if (clear > 0 || edge <= place) {
            // On, and beyond what ends there.
            const double way = std::min(std::max(edge, 0.0) + place, distance - w);
            straight(way);
            w += way;
            here = sample(w);
            continue;
        }
        // An end that lies on the edge itself might be taken for its other side.
        if (edge <= length) length = edge - 0.5 * place;
        ForceJet there = sample(w + length), middle = sample(w + 0.5 * length);
        if (settings_.step == 0 && !(off(here, middle, there, length) <= allowed)) {
            length *= 0.5;
            there = middle;
            middle = sample(w + 0.5 * length);
        }
        bent(here, middle, there, length);
        here = there;
        w += length;
    }
    return sum_;
}

}  // namespace

BentHit trace_perturbed(const FieldInstant& field, const Geometry* geometry, const dvec3& origin,
                        const dvec3& direction, const TraceSettings& settings, const StepRecorder& recorder) {
    BentHit result;
    const double speed = field.speed(origin);
    result.at = {origin, speed * direction, 0};
    const double far = std::min(settings.far, settings.u_end * speed);
    std::optional<Hit> hit;
    if (geometry) hit = geometry->intersect(origin, direction, 0, far);
    const double distance = hit ? hit->t : far;
    const Perturbed sum = Quadrature(field, settings, origin, direction, speed).over(distance);
    result.steps = std::min(sum.steps, settings.step_budget);
    result.error_px = sum.error / settings.pixel * (settings.perspective ? 1 : distance);
    if (!(speed > 0) || sum.no_index || sum.trapped) {
        result.end = sum.trapped ? BentHit::End::Trapped : BentHit::End::NoIndex;
        return result;
    }
    const auto across = [&](const dvec3& v) { return v - glm::dot(v, direction) * direction; };
    dvec3 shift = across(sum.x1);
    if (settings.integrator == Integrator::SecondOrder)
        shift += across(sum.x2) - glm::dot(sum.x1, direction) / speed * across(sum.dx1);
    RayState& ray = result.at;
    // Where it is bent by nothing that matters the straight ray has found what there is.
    const double room = settings.step > 0 ? 0 : settings.tolerance_px * settings.pixel / kQuietShare;
    if (glm::length(shift) > room * (settings.perspective ? distance : 1)) {
        if (settings.perspective)
            ray.p = speed * glm::normalize(distance * direction + shift);
        else
            ray.x += shift;
        if (geometry) hit = geometry->intersect(ray.x, ray.p / speed, 0, far);
    }
    result.length = hit ? hit->t : far;
    if (recorder) recorder(straight_step(ray, result.length));
    ray.u += result.length / speed;
    ray.x += result.length / speed * ray.p;
    if (hit) result.meet(*hit);
    return result;
}

}  // namespace eikonal::reference
