/// Models `table`, `tables` and `spectral`: displacement tables of a lattice for rays along a lattice axis
/// (PHYSICS.md#displacement-tables).
///
///  - table:    one slice of F times c·u, as in the paper. The constant c makes the rms right at the far distance, and
///              only there.
///  - tables:   exact tables at kTables path lengths, linearly interpolated in u. The paper suggests this.
///  - spectral: exact tables at the depths that a frame needs, at most kMostSpectralDepths, with Hermite interpolation
///              from dx1/du.
///
/// In an orthographic view a ray starts at the pixel's own position. In perspective (table and tables only) each ray is
/// replaced by a ray parallel to the axis. That ray goes through the point of the pixel's ray at kCentroid times its
/// depth, which is the centroid of the weight 1 - w/D.
#pragma once

#include <vector>

#include "noise/turbulence/lattice/path_tables.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "warp/displace/grid/displacement_grid.h"
#include "warp/displace/grid/ray_frame.h"

namespace eikonal {

inline constexpr int kTables = 8;
inline constexpr int kMostSpectralDepths = 33;
/// ∫ w (1 - w/D) dw / ∫ (1 - w/D) dw = D/3.
inline constexpr double kCentroid = 1.0 / 3;

/// Tables of one medium at one instant.
struct DisplacementTables {
    struct Table {
        double depth;                                               ///< u [m]
        std::array<PeriodicSpline2, 2> displacement;                ///< x1 [m] along the lateral axes (or c u F)
        std::optional<std::array<PeriodicSpline2, 2>> slope;        ///< dx1/du; Hermite only
        std::optional<PeriodicSpline2> potential, potential_slope;  ///< with falloff only
    };
    std::vector<Table> tables;  ///< ascending depth
    DepthInterpolation interpolation;
    PathRays rays;
    std::array<double, 2> lateral_period;  ///< [m]
    double cell;                           ///< finest lateral cell [m], padding included
    double strength;                       ///< multiplies ∇n: ray equation and exaggeration
    std::optional<Falloff> falloff;

    DisplacementGrid grid(const Camera& camera) const;
    void fill(DisplacementGrid& grid, const Camera& camera) const;
};

/// The lattice axis that is nearest to the direction of a camera's view, and the camera's position on it.
PathRays nearest_axis(const Camera& camera, double aperture);
/// Cosine of the angle between the view and that axis.
double axis_alignment(const Camera& camera, const PathRays& rays);

/// Tables of the model table. `constant` is c in x1 = c u F. padding: the result of path_padding, found once a shot.
DisplacementTables slice_instant(const LatticeField& field, double t, const PathRays& rays, double far, double constant,
                                 double strength, int padding);
/// Tables of the models tables and spectral: exact ones at `depths` [m].
DisplacementTables exact_instant(const LatticeField& field, double t, const PathRays& rays,
                                 const std::vector<double>& depths, DepthInterpolation interpolation, double strength,
                                 int padding);

/// Depths of `spectral` for objects between nearest and farthest [m]. They are evenly spaced: one lattice cell apart,
/// or more if that takes more than kMostSpectralDepths. One depth if nearest and farthest are equal.
std::vector<double> spectral_depths(const LatticeField& field, const PathRays& rays, double nearest, double farthest);

}  // namespace eikonal
