/// The mirages of Berger et al. 1990 and Musgrave 1990, as the paper names them: to compare with, not to trust. Both
/// know one heated surface and nothing else (baseline_surface refuses the rest), and take the index from the field.
///
/// layers: the air above the surface is cut into slices of constant index parallel to it, each having the index of its
/// middle. Rays are straight within a slice; at each boundary Snell's law holds or they are totally reflected. So the
/// tangential part of p never changes and the normal part follows from p_ν² + |p_t|² = n². Error of order 2 in the
/// slices' thickness for rays that cross them; of order 1/2 for one that turns back, which it does at a boundary,
/// anywhere in the slice where the bent ray would: that is the worst of many thicknesses, and single ones jump about
/// below it, so halving the slice need not help (from 0.2 m over asphalt of 305 K and d0 = 1 cm, seen 60 m away: up to
/// 16 mm off with slices of 16 µm).
///
/// mirror: straight rays, which the surface's plane reflects perfectly at angles below the critical one, where
/// |p_t| exceeds the index at the surface. Order 0: its error goes with the dropoff. An object closer to that plane
/// than Embree can tell lies under the mirror.
///
/// Conventions, ends and errors as in bent_ray.h; error_px is 0: they have no estimate.
#pragma once

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
