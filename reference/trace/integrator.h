/// One step of the ray equation d²x/du² = F(x, p), p = dx/du, and the curve between its ends.
///
/// u [m] is the parameter of PHYSICS.md#ray-equation: ds = |p| du, and |p| = n in the physical convention. Positions
/// are world metres. All numbers are double precision. Every method gives the state at the step's end and the force
/// there. The same curve between the ends serves all methods: the quintic with the position, direction and force of
/// both ends. Its own error is of order h^6 in position and h^5 in direction, so it is never worse than a method's
/// error.
///
///   method           order   evaluations of F a step (that at the end serves the next step too)
///   adaptive         5       6    Dormand and Prince 1980, 5(4), with their error estimate
///   rk4              4       4
///   leapfrog         2       2    drift, kick, drift: symplectic where F depends on position only
///   euler            1       1    explicit
/// Theory: PHYSICS.md#tracer.
#pragma once

#include <array>
#include <functional>
#include <glm/vec3.hpp>
#include <string_view>
#include <utility>

#include "noise/air/air.h"

namespace eikonal::reference {

/// The methods of `eikonal-trace --integrator`. The last four do not follow a bent ray: see baselines.h and
/// perturbation.h.
enum class Integrator { Adaptive, Rk4, Leapfrog, Euler, Layers, Mirror, FirstOrder, SecondOrder };

inline constexpr std::array<std::pair<std::string_view, Integrator>, 8> kIntegratorNames{
    {{"adaptive", Integrator::Adaptive},
     {"rk4", Integrator::Rk4},
     {"leapfrog", Integrator::Leapfrog},
     {"euler", Integrator::Euler},
     {"layers", Integrator::Layers},
     {"mirror", Integrator::Mirror},
     {"first-order", Integrator::FirstOrder},
     {"second-order", Integrator::SecondOrder}}};
constexpr std::string_view name_of(Integrator integrator) {
    for (const auto& [name, value] : kIntegratorNames)
        if (value == integrator) return name;
    return "";
}

/// A point of a ray.
struct RayState {
    dvec3 x{0, 0, 0};   ///< [m]
    dvec3 p{0, 0, -1};  ///< dx/du
    double u = 0;       ///< [m]
};

/// A piece of a ray. Increments are kept apart from the position, which may be too large to hold them exactly.
struct Step {
    RayState from;
    double h = 0;             ///< du
    bool straight = false;    ///< the step lies outside every medium
    dvec3 shift{0}, turn{0};  ///< increments of x and p
    dvec3 force_from{0};      ///< F at the start
    dvec3 force_to{0};        ///< F at the end, seen from within the step if F jumps there
    dvec3 error_x{0};         ///< estimate of the local error of x [m]
    dvec3 error_p{0};         ///< estimate of the local error of p

    RayState to() const { return {from.x + shift, from.p + turn, from.u + h}; }

    /// The curve at the part theta of the step, 0 … 1.
    dvec3 position(double theta) const;
    dvec3 direction(double theta) const;  ///< dx/du
    dvec3 force(double theta) const;      ///< the curve's d²x/du²
    RayState at(double theta) const { return {from.x + offset(theta), direction(theta), from.u + theta * h}; }

    /// The coefficients of theta … theta^5 in the quintic n·(position(theta) - from.x).
    std::array<double, 5> along(const dvec3& n) const;

    /// Arc length [m] of the whole step, and of the part from its start to theta. Never less than the chord.
    double length() const;
    double length(double theta) const;
    /// The angle by which the direction turns within the step [rad]. A bound, if the step resolves F.
    double bend() const;

  private:
    dvec3 offset(double theta) const;
    dvec3 excess_shift() const;
    dvec3 excess_turn() const;
    dvec3 excess_force() const;
};

/// A straight step of `length` [m].
Step straight_step(const RayState& from, double length);

/// The exact curve for a constant force.
Step parabolic_step(const RayState& from, const dvec3& force, double h);

/// One step h of adaptive, rk4, leapfrog or euler. force: F at its start. Every method fills the error estimates.
/// Adaptive has its own. The others compare their step with Simpson's rule along their own curve, for one more
/// evaluation of F. This estimate has the right order for all of them.
Step bent_step(Integrator method, const AirInstant& field, const RayState& from, const dvec3& force, double h);

}  // namespace eikonal::reference
