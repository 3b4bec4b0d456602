/// One ray written as text, for plots: CSV with the columns u,x,y,z,px,py,pz, p = dx/du, a row a point.
///
/// Rows: the ray's origin, the end of every step, and as many points of the curve between as keep the direction from
/// turning by more than kPathTurn from row to row. Of first and second order it is the perturbed curve itself
/// (perturbation.h), which starts at the origin with the straight ray's p as all do, integrated until halving its steps
/// moves its end by less than the tolerance (unless settings.step is given). Numbers have the shortest form that reads
/// back as the same double.
#pragma once

#include <ostream>
#include <string>

#include "reference/trace/bent_ray.h"

namespace eikonal::reference {

inline constexpr double kPathTurn = 0.02;  ///< [rad]
inline constexpr int kMostPointsAStep = 256;

/// Follows the ray to a surface, to settings.u_end or its other ends, and writes it up to there. FrameError, naming
/// `name`, when the stream does not take it.
BentHit write_path(const AirInstant& field, const Geometry* geometry, const dvec3& origin, const dvec3& direction,
                   const TraceSettings& settings, std::ostream& stream, const std::string& name);

}  // namespace eikonal::reference
