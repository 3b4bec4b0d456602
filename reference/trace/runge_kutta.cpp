#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "reference/trace/integrator.h"

namespace eikonal::reference {
namespace {

/// Dormand and Prince, "A family of embedded Runge-Kutta formulae", 1980: RK5(4)7M. The last stage is the end.
constexpr int kStages = 7;
using Tableau = std::array<std::array<double, kStages>, kStages>;
constexpr Tableau kA = {{{},
                         {1.0 / 5},
                         {3.0 / 40, 9.0 / 40},
                         {44.0 / 45, -56.0 / 15, 32.0 / 9},
                         {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
                         {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
                         {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}}};
constexpr double kC[kStages] = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
/// The weights of fifth order minus those of fourth order.
constexpr std::array<double, kStages> kE = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                            -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

/// dx/du of a stage is p plus the turn by the earlier forces. Hence x_i = x + c_i h p + h² Σ (A²)_ij F_j, and the error
/// of x is h² Σ (E A)_j F_j.
constexpr std::array<double, kStages> times_A(const std::array<double, kStages>& row) {
    std::array<double, kStages> product{};
    for (std::size_t j = 0; j < kStages; ++j)
        for (std::size_t k = j + 1; k < kStages; ++k) product[j] += row[k] * kA[k][j];
    return product;
}
constexpr Tableau kA2 = [] {
    Tableau square{};
    for (std::size_t i = 0; i < kStages; ++i) square[i] = times_A(kA[i]);
    return square;
}();
constexpr std::array<double, kStages> kEA = times_A(kE);

/// F of one stage.
template <std::size_t i>
void stage(const AirInstant& field, Step& step, dvec3* F) {
    const double h = step.h;
    dvec3 shift(0), turn(0);
    for (std::size_t j = 0; j < i; ++j) {
        if (kA2[i][j] != 0) shift += kA2[i][j] * F[j];
        if (kA[i][j] != 0) turn += kA[i][j] * F[j];
    }
    step.shift = h * (kC[i] * step.from.p + h * shift);
    step.turn = h * turn;
    F[i] = field.force(step.from.x + step.shift, step.from.p + step.turn);
}

void dormand_prince(const AirInstant& field, Step& step) {
    dvec3 F[kStages];
    F[0] = step.force_from;
    [&]<std::size_t... i>(std::index_sequence<i...>) {
        (stage<i + 1>(field, step, F), ...);
    }
    (std::make_index_sequence<kStages - 1>());
    step.force_to = F[kStages - 1];
    dvec3 x(0), p(0);
    for (std::size_t i = 0; i < kStages; ++i) {
        x += kEA[i] * F[i];
        p += kE[i] * F[i];
    }
    step.error_x = step.h * step.h * x;
    step.error_p = step.h * p;
}

void classical(const AirInstant& field, Step& step) {
    const dvec3 x = step.from.x, p1 = step.from.p, F1 = step.force_from;
    const double h = step.h;
    const dvec3 p2 = p1 + 0.5 * h * F1, F2 = field.force(x + 0.5 * h * p1, p2);
    const dvec3 p3 = p1 + 0.5 * h * F2, F3 = field.force(x + 0.5 * h * p2, p3);
    const dvec3 p4 = p1 + h * F3, F4 = field.force(x + h * p3, p4);
    step.shift = h / 6 * (p1 + 2.0 * p2 + 2.0 * p3 + p4);
    step.turn = h / 6 * (F1 + 2.0 * F2 + 2.0 * F3 + F4);
}

void leapfrog(const AirInstant& field, Step& step) {
    const double h = step.h;
    const dvec3 p = step.from.p;
    step.turn = h * field.force(step.from.x + 0.5 * h * p, p + 0.5 * h * step.force_from);
    step.shift = h * (p + 0.5 * step.turn);
}

void euler(Step& step) {
    step.shift = step.h * step.from.p;
    step.turn = step.h * step.force_from;
}

/// Length of a piece of curve over du, from its chord and from dx/du at its start, middle and end.
double length_of(const dvec3& chord, double du, const std::array<dvec3, 3>& p) {
    const double length = glm::length(chord);
    if (!(length > 0)) return 0;
    const auto longer = [&](const dvec3& v) { return glm::length(v) - glm::dot(v, chord) / length; };
    return length + du / 6 * (longer(p[0]) + 4 * longer(p[1]) + longer(p[2]));
}

/// Sets the force at the end, and the local error by comparison with Simpson's rule.
void finish(const AirInstant& field, Step& step) {
    const double h = step.h;
    const RayState end = step.to();
    step.force_to = field.force(end.x, end.p);
    const RayState middle = step.at(0.5);
    const dvec3 F = field.force(middle.x, middle.p);
    step.error_p = h / 6 * (step.force_from + 4.0 * F + step.force_to) - step.turn;
    step.error_x = h * step.from.p + h * h / 6 * (step.force_from + 2.0 * F) - step.shift;
}

}  // namespace

// The quintic: x(θ) = x0 + θ h p0 + θ² h² F0/2 + θ³(10 D - 4 V + A/2) + θ⁴(-15 D + 7 V - A) + θ⁵(6 D - 3 V + A/2).
// D, V and A are the differences of x1, h p1 and h² F1 from the parabola.
dvec3 Step::excess_shift() const {
    return shift - h * from.p - 0.5 * h * h * force_from;
}
dvec3 Step::excess_turn() const {
    return h * (turn - h * force_from);
}
dvec3 Step::excess_force() const {
    return h * h * (force_to - force_from);
}

dvec3 Step::offset(double theta) const {
    const dvec3 D = excess_shift(), V = excess_turn(), A = excess_force();
    const double t = theta * h;
    return t * (from.p + 0.5 * t * force_from) +
           theta * theta * theta *
               (10.0 * D - 4.0 * V + 0.5 * A +
                theta * (-15.0 * D + 7.0 * V - A + theta * (6.0 * D - 3.0 * V + 0.5 * A)));
}

std::array<double, 5> Step::along(const dvec3& n) const {
    const double p = h * glm::dot(n, from.p), F = h * h * glm::dot(n, force_from);
    const double D = glm::dot(n, shift) - p - 0.5 * F, V = h * glm::dot(n, turn) - F;
    const double A = h * h * glm::dot(n, force_to) - F;
    return {p, 0.5 * F, 10 * D - 4 * V + 0.5 * A, -15 * D + 7 * V - A, 6 * D - 3 * V + 0.5 * A};
}

dvec3 Step::position(double theta) const {
    if (straight || theta == 1) return from.x + theta * shift;
    if (theta == 0) return from.x;
    return from.x + offset(theta);
}

dvec3 Step::direction(double theta) const {
    if (straight || h == 0) return from.p;
    const dvec3 D = excess_shift(), V = excess_turn(), A = excess_force();
    return from.p + theta * h * force_from +
           theta * theta / h *
               (30.0 * D - 12.0 * V + 1.5 * A +
                theta * (-60.0 * D + 28.0 * V - 4.0 * A + theta * (30.0 * D - 15.0 * V + 2.5 * A)));
}

dvec3 Step::force(double theta) const {
    if (h == 0) return force_from;
    const dvec3 D = excess_shift(), V = excess_turn(), A = excess_force();
    return force_from + theta / (h * h) *
                            (60.0 * D - 24.0 * V + 3.0 * A +
                             theta * (-180.0 * D + 84.0 * V - 12.0 * A + theta * (120.0 * D - 60.0 * V + 10.0 * A)));
}

// The chord is as exact as the step. Simpson's rule gives the excess of the curve over the chord. The integral of |p|
// would not do: |p| may rise and fall within a step, which changes neither length.
double Step::length(double theta) const {
    return length_of(offset(theta), theta * h, {from.p, direction(0.5 * theta), direction(theta)});
}

// The curve's direction at its middle, by the quintic above.
double Step::length() const {
    if (straight || h == 0) return h * glm::length(from.p);
    const dvec3 middle = 1.875 / h * shift - 0.875 * from.p - 0.4375 * turn + h / 32 * (force_to - force_from);
    return length_of(shift, h, {from.p, middle, from.p + turn});
}

double Step::bend() const {
    if (straight || h == 0) return 0;
    const dvec3 end = from.p + turn, mean = turn / h, middle = 1.5 * mean - 0.25 * (force_from + force_to);
    const double force2 = std::max({glm::dot(force_from, force_from), glm::dot(force_to, force_to),
                                    glm::dot(middle, middle), glm::dot(mean, mean)});
    return h * std::sqrt(force2 / std::min(glm::dot(from.p, from.p), glm::dot(end, end)));
}

Step straight_step(const RayState& from, double length) {
    Step step;
    step.from = from;
    step.h = length / glm::length(from.p);
    step.straight = true;
    step.shift = step.h * from.p;
    return step;
}

Step parabolic_step(const RayState& from, const dvec3& force, double h) {
    Step step;
    step.from = from;
    step.h = h;
    step.turn = h * force;
    step.shift = h * (from.p + 0.5 * step.turn);
    step.force_from = step.force_to = force;
    return step;
}

Step bent_step(Integrator method, const AirInstant& field, const RayState& from, const dvec3& force, double h) {
    Step step;
    step.from = from;
    step.h = h;
    step.force_from = force;
    switch (method) {
        case Integrator::Adaptive:
            dormand_prince(field, step);
            return step;
        case Integrator::Rk4:
            classical(field, step);
            break;
        case Integrator::Leapfrog:
            leapfrog(field, step);
            break;
        default:
            euler(step);
            break;
    }
    finish(field, step);
    return step;
}

}  // namespace eikonal::reference
