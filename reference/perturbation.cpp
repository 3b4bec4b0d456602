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

Perturbed Quadrature::over(double distance) {
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
        const double clear = may_be_clear(here.force) ? std::min(field_.clear_way(at(w), direction_), distance - w) : 0;
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

/// First order without steps, where there is a form for it that is within the tolerance.
std::optional<Perturbed> closed_form(const FieldInstant& field, const TraceSettings& settings, const dvec3& origin,
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
    const auto pull = field.pull(origin, direction, distance, quiet);
    if (!pull) return {};
    result.error = pull->error * glm::length(pull->value) * inverse_square / distance;
    if (!(result.error <= tolerance)) return {};
    result.x1 = inverse_square * pull->value;
    return result;
}

}  // namespace

BentHit trace_perturbed(const FieldInstant& field, const Geometry* geometry, const dvec3& origin,
                        const dvec3& direction, const TraceSettings& settings, const StepRecorder& recorder) {
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

}  // namespace eikonal::reference
