/// One step of the ray equation d²x/du² = F(x, p), p = dx/du, and the curve between its ends.
///
/// u is the parameter of PHYSICS.md#ray-equation: ds = |p| du, |p| = n in the physical convention. Positions in world
/// metres, all double; u in metres too. Every method gives the state at the step's end and the force there, so that the
/// same dense output serves all: the quintic that has position, direction and force of both ends. Its own error in
/// position is of order h^6, in direction h^5: never worse than the order of a method.
///
///   method           order   F a step (the one at the end is the next step's first)
///   adaptive         5       6    Dormand and Prince 1980, 5(4), with their error estimate
///   rk4              4       4
///   leapfrog         2       2    drift, kick, drift: symplectic where F depends on position only
///   euler            1       1    explicit
#pragma once

#include <array>
#include <functional>
#include <glm/vec3.hpp>
#include <string_view>
#include <utility>

#include "noise/air/air.h"

namespace eikonal::reference {

/// What `eikonal-trace --integrator` offers. The last four follow no bent ray: see baselines.h and perturbation.h.
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

/// A piece of ray. Increments are kept apart from the position, which may be too large to hold them exactly.
struct Step {
    RayState from;
    double h = 0;             ///< du
    bool straight = false;    ///< outside every medium
    dvec3 shift{0}, turn{0};  ///< increments of x and p
    dvec3 force_from{0};      ///< F at both ends
    dvec3 force_to{0};        ///< as seen from within, if F jumps there
    dvec3 error_x{0};         ///< estimate of the local error of x [m] and p
    dvec3 error_p{0};

    RayState to() const { return {from.x + shift, from.p + turn, from.u + h}; }

    /// The curve at part theta of the step, 0 … 1.
    dvec3 position(double theta) const;
    dvec3 direction(double theta) const;  ///< dx/du
    dvec3 force(double theta) const;      ///< d²x/du² of the curve
    RayState at(double theta) const { return {from.x + offset(theta), direction(theta), from.u + theta * h}; }

    /// Coefficients of the quintic n·(position(theta) - from.x), from that of theta to that of theta^5.
    std::array<double, 5> along(const dvec3& n) const;

    /// Arc length of all of it, and from its start to part theta, no less than the chord's [m].
    double length() const;
    double length(double theta) const;
    /// How far its direction turns within it, a bound for steps that resolve F [rad].
    double bend() const;

  private:
    dvec3 offset(double theta) const;
    dvec3 excess_shift() const;
    dvec3 excess_turn() const;
    dvec3 excess_force() const;
};

/// Straight on for `length` metres.
Step straight_step(const RayState& from, double length);

/// The exact curve for the constant force at its start.
Step parabolic_step(const RayState& from, const dvec3& force, double h);

/// One step h of adaptive, rk4, leapfrog or euler; `force` is F at its start. Adaptive fills the error estimates, the
/// others compare themselves with Simpson's rule along their own curve, for one F more: the right order for all of
/// them.
Step bent_step(Integrator method, const AirInstant& field, const RayState& from, const dvec3& force, double h);

}  // namespace eikonal::reference
