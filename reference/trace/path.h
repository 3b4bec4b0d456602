/// One ray as text, for plots: CSV with the columns u,x,y,z,px,py,pz, where p = dx/du. Each row is a point.
///
/// The rows are the ray's origin, the end of every step, and points of the curve between, so that the direction turns
/// by no more than kPathTurn from row to row. For first and second order the path is the perturbed curve itself
/// (perturbation.h), which starts at the origin with the straight ray's p. Its steps are halved until its end moves by
/// less than the tolerance, unless settings.step is given. Numbers have the shortest form that reads back as the same
/// double.
#pragma once

#include <ostream>
#include <string>

#include "reference/trace/bent_ray.h"

namespace eikonal::reference {

inline constexpr double kPathTurn = 0.02;  ///< [rad]
inline constexpr int kMostPointsAStep = 256;

/// Follows the ray to a surface, to settings.u_end or to another end, and writes it. FrameError with `name` if the
/// stream fails.
BentHit write_path(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
                   const TraceSettings& settings, std::ostream& stream, const std::string& name);

}  // namespace eikonal::reference
