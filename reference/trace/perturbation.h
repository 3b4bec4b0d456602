/// First and second order: the bent ray as a perturbation of the straight one (paper, Sections 4 and 5;
/// PHYSICS.md#first-order).
///
/// Along the straight ray x0(u) = q0 + u p0, |p0| the index at the origin, to parameter U at distance D, where it meets
/// the geometry (without it, or where it meets nothing: at settings.far),
///
///     x1(U) = ∫₀^U (U - w) F(x0(w)) dw                                                            Eq. 7, *paper*
///     x2(U) = ∫₀^U (U - w) [(x1·∇)F + (x1'·∂/∂p)F] dw                                              *added* the last
///     term
///
/// where ' is d/du. The perturbed ray itself is x0 + x1 (+ x2), with dx/du = p0 + x1' (+ x2'): perturbed_curve. A
/// picture takes less of it. The ray is redirected, as the paper renders: a straight one from the same origin towards D
/// d + x1⊥(U), or, for an orthographic camera, a parallel one shifted by x1⊥(U). Second order takes x1⊥ + x2⊥ - x1'⊥
/// x1∥/|p0|, which is where the bent ray passes the plane through the straight one's end, across it. Error in the
/// strength of the field: quadratic, and cubic where what is met faces the ray: the redirected ray arrives along its
/// own straight line, so a surface that it meets obliquely is missed by the quadratic part in either order. Neither
/// knows rays that turn back: over a hot road they hold well above the critical angle √(2B) and are worth nothing below
/// it (from 0.2 m over asphalt of 305 K: 0.2 m off where the ray meets it at 1.2 times that angle, 9 mm at twice, 2 µm
/// at ten times). A ray that is not bent by what matters (kQuietShare) is not shot again.
///
/// First order over nothing but a surface (lone_surface.h) and through nothing but blobs and thin screens
/// (AirInstant::pull) is closed form, unless what that leaves out is above the tolerance. Else the integrals are
/// Simpson's, of order 4 in the step; a step evaluates F no further apart than AirInstant::longest_step, and twice as
/// often where its error is above 1/kStepShare of the tolerance. A given settings.step is taken as it is. error_px is
/// the integrals' alone. Nothing is known of what lies beside the straight ray.
///
/// Ends, settings as in bent_ray.h; `at.p` is the redirected direction. A straight ray that comes to where n <= 0 ends
/// there.
#pragma once

#include "reference/trace/bent_ray.h"

namespace eikonal::reference {

/// settings.integrator: FirstOrder or SecondOrder.
BentHit trace_perturbed(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
                        const TraceSettings& settings, const StepRecorder& recorder);

/// The curve x0 + x1 (+ x2) from the origin on, u = 0, to a surface that it meets itself, to settings.far or u_end;
/// recorder gets its steps, settings otherwise as above. For a path as numbers.
BentHit perturbed_curve(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
                        const TraceSettings& settings, const StepRecorder& recorder);

}  // namespace eikonal::reference
