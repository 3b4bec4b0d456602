/// Models `table`, `tables` and `spectral`: displacement tables of a lattice, for rays along a lattice axis
/// (PHYSICS.md#displacement-tables).
///
///  - table:    one slice of F times c·u, as the paper renders; c makes its rms right at the far distance, and only
///  there.
///  - tables:   exact tables at kTables path lengths, linearly interpolated in u: the paper's suggestion.
///  - spectral: exact tables at the depths a frame needs, at most kMostSpectralDepths, Hermite-interpolated with
///  dx1/du.
///
/// Orthographic rays start at the pixel's own place. In perspective (table and tables only) each pixel's ray is taken
/// for one parallel to the axis through the point at kCentroid of its depth, the centroid of the weight 1 - w/D.
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
    struct Layer {
        double depth;                                               ///< u [m]
        std::array<PeriodicSpline2, 2> displacement;                ///< x1 [m] along the lateral axes (or c u F)
        std::optional<std::array<PeriodicSpline2, 2>> slope;        ///< dx1/du; Hermite only
        std::optional<PeriodicSpline2> potential, potential_slope;  ///< with falloff only
    };
    std::vector<Layer> layers;  ///< ascending depth
    DepthInterpolation interpolation;
    PathRays rays;
    std::array<double, 2> lateral_period;  ///< [m]
    double cell;                           ///< finest lateral cell [m], padding included
    double strength;                       ///< multiplies ∇n: ray equation and exaggeration
    std::optional<Falloff> falloff;

    DisplacementGrid grid(const Camera& camera) const;
    void fill(DisplacementGrid& grid, const Camera& camera) const;
};

/// The lattice axis nearest to a camera's view, with the camera's place on it.
PathRays nearest_axis(const Camera& camera, double aperture);
/// Cosine between the view and that axis.
double axis_alignment(const Camera& camera, const PathRays& rays);

/// table: `constant` is c, so that x1 = c u F. padding: that of path_padding, found once a shot.
DisplacementTables slice_instant(const LatticeField& field, double t, const PathRays& rays, double far, double constant,
                                 double strength, int padding);
/// tables and spectral: exact tables at `depths`.
DisplacementTables exact_instant(const LatticeField& field, double t, const PathRays& rays,
                                 const std::vector<double>& depths, DepthInterpolation interpolation, double strength,
                                 int padding);

/// Depths of `spectral` for objects between nearest and farthest: evenly spaced, a lattice cell apart where that takes
/// no more than kMostSpectralDepths; one where they are equal.
std::vector<double> spectral_depths(const LatticeField& field, const PathRays& rays, double nearest, double farthest);

}  // namespace eikonal
