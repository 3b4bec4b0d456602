/// Two neighbours of a bent ray, followed to first order by their own equation (*added*; Igehy 1999 for straight rays):
///
///     d²δx/du² = (∂F/∂x) δx + (∂F/∂p) δp,    δp = dδx/du
///
/// Runge-Kutta of order 4 integrates it along the ray's own steps. The relative error is within kBundleError at the
/// longest steps that a field allows, and far less where the ray's own tolerance shortens them. At an edge of unit
/// normal ν F jumps. The neighbour meets the edge later by δu = -(ν·δx)/(ν·p), and δp gains (F_before - F_after) δu. ν
/// is found from the ways to the edge in neighbouring directions.
///
/// Magnification: how many times larger in area than with straight rays a distant thing appears. It is the
/// cross-section that a pixel's bundle would have, straight, after the same length of path, divided by the
/// cross-section that it has. Above 1, the pixel sees less of its source. Negative, the bundle has folded an odd number
/// of times, and the picture is mirrored there. At a caustic the cross-section is zero, and the magnification is
/// limited to ±kLargestMagnification. Radiance does not change. The irradiance of light sent along the rays is
/// multiplied by the magnification's magnitude.
/// Theory: PHYSICS.md#ray-differential.
#pragma once

#include <array>

#include "reference/trace/integrator.h"

namespace eikonal::reference {

inline constexpr double kBundleError = 1e-4;
inline constexpr double kLargestMagnification = 1e6;

/// The change of position [m] and of p from one pixel to the next.
struct Differential {
    dvec3 x{0}, p{0};
};
/// One for each axis of the picture.
using Bundle = std::array<Differential, 2>;

/// The bundle at the start of a ray. pixels: its p are changes of the unit direction, of which the part along the
/// direction does not count. The p of the result are changes of dx/du.
Bundle launch(const Bundle& pixels, const RayState& start, const dvec3& force);

/// Follows a bundle along `step` from the step's start to its part theta.
void advance(const AirInstant& field, const Step& step, double theta, Bundle& bundle);

/// Takes a bundle over an edge at `state`, where F jumps from `before` to `after`. reach: the distance within which
/// there is no other edge [m]. Does nothing if AirInstant::way_to_edge knows of no edge there.
void pass_edge(const AirInstant& field, const RayState& state, double reach, const dvec3& before, const dvec3& after,
               Bundle& bundle);

/// The bundle at the points where its rays meet the plane of this normal, which is what the pixel covers of a surface.
/// Unchanged for a ray along the plane.
Bundle on_surface(const Bundle& bundle, const RayState& state, const dvec3& normal);

/// The magnification of a bundle. pixels: as for `launch`. direction: unit, at the start. state, bundle: at the end.
/// length: of the path [m].
double magnification(const Bundle& pixels, const dvec3& direction, const RayState& state, const Bundle& bundle,
                     double length);

}  // namespace eikonal::reference
