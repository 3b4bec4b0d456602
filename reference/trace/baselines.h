/// The mirages of Berger et al. 1990 and of Musgrave 1990, as the paper names them. They are here for comparison and
/// are not exact. Both know one heated surface and nothing else (baseline_surface refuses other scenes). They take the
/// index from the field.
///
/// layers. The air above the surface is cut into slices of constant index, parallel to the surface. A slice has the
/// index of its middle. Rays are straight within a slice. At each boundary Snell's law holds, or the ray is totally
/// reflected. So the tangential part of p never changes, and the normal part follows from p_ν² + |p_t|² = n². The error
/// is of order 2 in the slices' thickness for rays that cross them. It is of order 1/2 for a ray that turns back: the
/// ray turns at a boundary, while the bent ray turns anywhere in the slice. This is the worst case of many thicknesses.
/// Single thicknesses scatter below it, so halving the slice need not help. (From 0.2 m over asphalt of 305 K with d0 =
/// 1 cm, seen 60 m away, slices of 16 µm are off by up to 16 mm.)
///
/// mirror. Rays are straight. The surface's plane reflects them perfectly at angles below the critical one, where |p_t|
/// exceeds the index at the surface. The error is of order 0: it grows with the dropoff. An object that is closer to
/// the plane than Embree can tell lies under the mirror.
///
/// Conventions, ends and errors are those of bent_ray.h. error_px is 0, since there is no estimate.
/// Theory: PHYSICS.md#baselines.
#pragma once

#include "noise/medium/medium_spec.h"
#include "noise/surface/surface_spec.h"
#include "reference/trace/bent_ray.h"

namespace eikonal::reference {

/// Slices in a dropoff, unless TraceSettings::step gives their thickness.
inline constexpr double kSlicesPerDropoff = 20;
/// Dropoffs above the surface that are sliced; beyond lies the air at that height.
inline constexpr double kSlicedDropoffs = 37;

/// The surface that `layers` and `mirror` need. UserError, naming the integrator and the medium, unless the media are
/// one of type "surface". Nothing for other integrators.
std::optional<SurfaceSpec> baseline_surface(Integrator integrator, const std::vector<MediumSpec>& media);

/// settings.surface must be set.
BentHit trace_layers(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
                     const TraceSettings& settings, const StepRecorder& recorder);
BentHit trace_mirror(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
                     const TraceSettings& settings, const StepRecorder& recorder);

}  // namespace eikonal::reference
