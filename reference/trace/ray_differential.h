/// Two neighbours of a bent ray, followed to first order by their own equation (*added*; Igehy 1999 for straight rays):
///
///     d²δx/du² = (∂F/∂x) δx + (∂F/∂p) δp,    δp = dδx/du
///
/// integrated along the ray's own steps by Runge-Kutta of order 4: within kBundleError, relative, at the longest steps
/// a field allows, and far less where the ray's own tolerance rules. Where F jumps, at an edge of unit normal ν that is
/// met by the neighbour δu = -(ν·δx)/(ν·p) later, δp gains (F_before - F_after) δu; ν is found from the ways to the
/// edge in neighbouring directions.
///
/// Magnification: how many times larger than with straight rays a distant thing appears, in area. It is the
/// cross-section that the bundle of one pixel would have had, straight, after the same length of path, over the one it
/// has. Above 1: the pixel sees less of its source. Negative: the bundle has folded an odd number of times, the picture
/// is mirrored there. At a caustic the cross-section is nothing: limited to ±kLargestMagnification. So radiance is
/// unchanged and irradiance of light sent along the rays is multiplied by its magnitude.
#pragma once

#include <array>

#include "reference/trace/integrator.h"

namespace eikonal::reference {

inline constexpr double kBundleError = 1e-4;
inline constexpr double kLargestMagnification = 1e6;

/// Change of position [m] and of p, for a step of one pixel.
struct Differential {
    dvec3 x{0}, p{0};
};
/// One for each axis of the picture.
using Bundle = std::array<Differential, 2>;

/// How a bundle leaves a point: the p of `pixels` are changes of the unit direction (what of them lies along it does
/// not count). Returns those of dx/du at `start`.
Bundle launch(const Bundle& pixels, const RayState& start, const dvec3& force);

/// Follows a bundle along `step` from its start to part theta.
void advance(const AirInstant& field, const Step& step, double theta, Bundle& bundle);

/// At `state`, where F jumps from `before` to `after` at an edge that AirInstant::way_to_edge knows, up to `reach`
/// [m] from any other. Nothing happens where it knows of none.
void pass_edge(const AirInstant& field, const RayState& state, double reach, const dvec3& before, const dvec3& after,
               Bundle& bundle);

/// The bundle where its rays meet the plane of this normal: what the pixel covers of the surface. Unchanged for a ray
/// along the plane.
Bundle on_surface(const Bundle& bundle, const RayState& state, const dvec3& normal);

/// pixels: as given to `launch`; direction: unit, at the start; state, bundle: at the end, `length` of path [m] on.
double magnification(const Bundle& pixels, const dvec3& direction, const RayState& state, const Bundle& bundle,
                     double length);

}  // namespace eikonal::reference
