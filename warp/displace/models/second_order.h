/// Model `second-order`: the ray equation itself, along every node's ray through the sum of all media but surfaces.
///
///     x1'' = L² F(P(z) + x1, d + x1')/|dx/du|₀²,   P(z) = origin + z d the straight ray by axial depth
///
/// (|dx/du|₀ at the camera: u is L/|dx/du|₀ a metre of depth, all along the ray)
/// to which Eq. 7 is the first approximation, F at P alone; second order adds ∫(u - w)(x1·∇)F dw
/// (PHYSICS.md#first-order). Taking F where the bent ray is holds that term and those of higher order. Steps of
/// Nyström's fourth-order method, at most `step` times as long as the field says (AirInstant::longest_step) and ending
/// where it jumps. The shift is the exact projection of the bent ray's point at each depth, not the first-order one.
///
/// An aperture is a bundle as in first_order.h, whose bends are averaged. Thin screens are averaged over it already.
///
/// A ray that has turned by more than kSteepestBend goes on straight from there, and one that has turned back is not
/// moved: that far no warp holds. It is lost to those whom it should judge. Where rays come to no index (n <= 0) there
/// is no map.
/// Theory: PHYSICS.md#second-order.
#pragma once

#include <stop_token>

#include "noise/air/air.h"
#include "warp/displace/grid/displacement_grid.h"
#include "warp/displace/grid/ray_frame.h"

namespace eikonal {

/// Tangent of the bend against the straight ray beyond which it is not followed.
inline constexpr double kSteepestBend = 1;
/// Steps of a ray at most; what is left is then crossed straight.
inline constexpr int kMostRaySteps = 20000;
/// A tracer's step is a part of the smallest feature; a warp's is so many of them.
inline constexpr double kStep = 2;
/// The same where there is gradient noise, whose cells are no smoother than they must.
inline constexpr double kNoiseStep = 0.5;
/// The step by which second-order itself is judged.
inline constexpr double kFineStep = 0.5;
/// What longest steps over surfaces are multiplied by besides: the closed form that they judge is exact.
inline constexpr double kSurfaceStep = 1.0 / 16;
/// Where its blobs end [σ]: e^{-16} of each is left out.
inline constexpr double kRayBlobReach = 4;
/// The same of the rays that judge the closed form: e^{-12}, much less than the second order that they are there to
/// find.
inline constexpr double kJudgedBlobReach = 3.5;
/// Rms error of a lattice's force that its spline is made finer for, relative to the rms, where memory permits.
inline constexpr double kSecondOrderSplineError = 0.003;
/// Rms error of shifts with kStep against kFineStep, relative to the rms shift.
/// (tests/warp/displace/second_order_test.cpp)
inline constexpr double kSecondOrderError = 2e-3;

struct BentRays {
    AirInstant field;            ///< gain included
    double step;                 ///< in longest steps of the field
    int spacing;                 ///< of nodes [px]
    std::vector<double> depths;  ///< of a grid's layers [m]
    double aperture = 0;         ///< diameter [m]; 0: a point
    double cell = 1;             ///< finest of the media that it averages over [m]
    double focus = 1;            ///< axial depth on which a perspective aperture's rays converge [m]
    std::stop_token stop = {};   ///< as DisplacerSettings

    /// A grid without nodes, to be covered and filled.
    DisplacementGrid grid(const Camera& camera) const;
    /// Adds X and S at every node and depth. FrameError once a stop is requested, and where a ray comes to n <= 0.
    void fill(DisplacementGrid& grid, const Camera& camera) const;
};

/// The ray of one pixel alone, without interpolation from nodes.
struct BentPixel {
    DisplacementGrid grid;  ///< filled, covers the pixel; its layers are the ray's own steps
    double lost_at;         ///< axial depth from which on there is no telling where the ray is; infinite: nowhere [m]
};
/// Up to axial depth `farthest` [m]. What the other models are measured by.
BentPixel bent_pixel(const BentRays& model, const Camera& camera, int x, int y, double farthest);

}  // namespace eikonal
