#include "reference/perturbation.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace eikonal::reference {
namespace {

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
    void bent(const ForceJet& from, double w, double length, const ForceJet& to);

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

void Quadrature::bent(const ForceJet& from, double w, double length, const ForceJet& to) {
    const double h = length / speed_;
    const ForceJet middle = sample(w + 0.5 * length);
    const dvec3 &Fa = from.force, &Fm = middle.force, &Fb = to.force, x1 = sum_.x1, dx1 = sum_.dx1;
    sum_.x1 += h * dx1 + h * h / 6 * (Fa + 2.0 * Fm);
    sum_.dx1 += h / 6 * (Fa + 4.0 * Fm + Fb);
    // A part of what the trapezoidal rule is wrong by: enough at the longest steps, too much at shorter ones.
    sum_.error += glm::length(h / 90 * (Fa - 2.0 * Fm + Fb)) / speed_;
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
    if (settings_.lone && !second_ && settings_.step == 0) {
        if (const auto pull = settings_.lone->pull(origin_, direction_, distance)) {
            sum_.x1 = *pull / (speed_ * speed_);
            sum_.steps = 1;
            return sum_;
        }
    }
    const double place = 1e-12 * (1 + glm::length(origin_) + std::min(distance, 1e6));
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
            length = std::min(length, field_.longest_step(at(w), direction_));
            if (settings_.step > 0) length = std::min(length, settings_.step);
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
        const ForceJet there = sample(w + length);
        bent(here, w, length, there);
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
    double distance = far;
    if (geometry)
        if (const auto straight = geometry->intersect(origin, direction, 0, far)) distance = straight->t;
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
    if (settings.perspective)
        ray.p = speed * glm::normalize(distance * direction + shift);
    else
        ray.x += shift;
    const dvec3 d = ray.p / speed;
    std::optional<Hit> hit;
    if (geometry) hit = geometry->intersect(ray.x, d, 0, far);
    result.length = hit ? hit->t : far;
    const Step step = straight_step(ray, result.length);
    if (recorder) recorder(step);
    ray = step.to();
    if (hit) {
        result.end = BentHit::End::Surface;
        result.hit = true;
        result.surface = *hit;
        ray.x = hit->point;
    }
    return result;
}

}  // namespace eikonal::reference
