/// First and second order: the bent ray as a perturbation of the straight one (paper, Sections 4 and 5;
/// PHYSICS.md#first-order).
///
/// The straight ray is x0(u) = q0 + u p0, with |p0| the index at the origin. At parameter U, distance D, it meets the
/// geometry. If there is no geometry or nothing is met, D is settings.far. Along it,
///
///     x1(U) = ∫₀^U (U - w) F(x0(w)) dw                                    Eq. 7, *paper*
///     x2(U) = ∫₀^U (U - w) [(x1·∇)F + (x1'·∂/∂p)F] dw                     *added* the last term
///
/// where ' is d/du. The perturbed ray itself is x0 + x1 (+ x2), with dx/du = p0 + x1' (+ x2') (perturbed_curve).
///
/// A picture takes less of it. The ray is redirected as in the paper: it becomes the straight ray from the same origin
/// towards D d + x1⊥(U), or for an orthographic camera the parallel ray shifted by x1⊥(U). Second order takes
/// x1⊥ + x2⊥ - x1'⊥ x1∥/|p0|, which is where the bent ray passes the plane through the straight one's end, across it. A
/// ray whose bend does not matter (kQuietShare) is not redirected.
///
/// Error. In the strength of the field it is quadratic for first order. It is cubic for second order where the surface
/// faces the ray. The redirected ray arrives along its own straight line, so an oblique surface is missed by the
/// quadratic part in either order. Neither order knows rays that turn back. Over a hot road they hold well above the
/// critical angle √(2B), and they are useless below it. (From 0.2 m over asphalt of 305 K, the ray meets the road 0.2 m
/// off at 1.2 times that angle, 9 mm off at twice, and 2 µm off at ten times.)
///
/// First order is in closed form over a lone surface (lone_surface.h) and through blobs and thin screens alone
/// (AirInstant::straight_bend), unless what the closed form leaves out exceeds the tolerance. All other integrals use
/// Simpson's rule, of order 4 in the step. A step samples F no farther apart than AirInstant::longest_step, and twice
/// as often where its error is above 1/kStepShare of the tolerance. A given settings.step is taken as it is. error_px
/// is the error of the integrals only. Nothing beside the straight ray is known.
///
/// Ends and settings are those of bent_ray.h. `at.p` is the redirected direction. A straight ray that comes to n <= 0
/// ends there.
/// Theory: PHYSICS.md#second-order.
#pragma once

#include "reference/trace/bent_ray.h"

namespace eikonal::reference {

/// settings.integrator: FirstOrder or SecondOrder.
BentHit trace_perturbed(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
                        const TraceSettings& settings, const StepRecorder& recorder);

/// Follows the curve x0 + x1 (+ x2) itself, from the origin (u = 0) to a surface that the curve meets, to settings.far
/// or to u_end. It serves paths as numbers. recorder: gets the steps. Settings are otherwise as above.
BentHit perturbed_curve(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
                        const TraceSettings& settings, const StepRecorder& recorder);

}  // namespace eikonal::reference
