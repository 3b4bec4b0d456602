/// Model `second-order`: integrates the full ray equation along the ray of every node, through the sum of all media but
/// surfaces.
///
///     x1'' = L² F(P(z) + x1, d + x1')/|dx/du|₀²,   P(z) = origin + z d
///
/// P(z) is the straight ray by axial depth z. |dx/du|₀ is taken at the camera, and one metre of depth is L/|dx/du|₀ of
/// u all along the ray. The first order (Eq. 7) takes F at P. The second order adds ∫(u - w)(x1·∇)F dw
/// (PHYSICS.md#first-order). F at the bent ray contains this term and all higher ones.
///
/// The equation is integrated by Nyström's fourth-order method. A step is at most `step` times as long as the field
/// says is safe (AirInstant::longest_step), and it ends where the force jumps. The shift is the exact projection of the
/// bent ray's point at each depth, not its first-order approximation.
///
/// An aperture is a bundle as in first_order.h, whose bends are averaged. Thin screens are averaged over the aperture
/// already.
///
/// A ray that has turned by more than kSteepestBend goes on straight from there. A ray that has turned back is not
/// displaced. No warp holds for such rays. Where they should judge another model they count as lost. If a ray reaches a
/// point with n <= 0, there is no map.
/// Theory: PHYSICS.md#second-order.
#pragma once

#include <stop_token>

#include "noise/air/air.h"
#include "warp/displace/grid/displacement_grid.h"
#include "warp/displace/grid/ray_frame.h"

namespace eikonal {

/// A ray is followed until the tangent of its bend against the straight ray exceeds this.
inline constexpr double kSteepestBend = 1;
/// Largest number of steps of a ray. The rest of its path is then straight.
inline constexpr int kMostRaySteps = 20000;
/// Length of a step of a map's rays, as a multiple of the longest safe step.
inline constexpr double kStep = 2;
/// The same in gradient noise, which is less smooth: only its first two derivatives are continuous.
inline constexpr double kNoiseStep = 0.5;
/// The same of the rays that judge the model second-order.
inline constexpr double kFineStep = 0.5;
/// Another factor on the longest safe step over surfaces. Their closed form is exact, so the rays that judge it must be
/// very exact too.
inline constexpr double kSurfaceStep = 1.0 / 16;
/// Distance from a blob's centre beyond which its force is left out [σ]. There it has fallen to e^{-16}.
inline constexpr double kRayBlobReach = 4;
/// The same of the rays that judge the closed form of blobs. There the force has fallen to e^{-12}, which is much less
/// than the second order that these rays have to find.
inline constexpr double kJudgedBlobReach = 3.5;
/// Allowed rms error of a lattice's force, relative to its rms. The spline is refined until its error is below, where
/// memory permits.
inline constexpr double kSecondOrderSplineError = 0.003;
/// Rms difference of the shifts with kStep from those with kFineStep, relative to the rms shift.
/// (tests/warp/displace/second_order_test.cpp)
inline constexpr double kSecondOrderError = 2e-3;

struct BentRays {
    AirInstant field;            ///< gain included
    double step;                 ///< factor on the longest safe step of the field
    int spacing;                 ///< spacing of nodes [px]
    std::vector<double> depths;  ///< depths of a grid [m]
    double aperture = 0;         ///< diameter [m]; 0: a point
    double cell = 1;             ///< finest cell of the media that the aperture averages over [m]
    double focus = 1;            ///< axial depth on which a perspective aperture's rays converge [m]
    std::stop_token stop = {};   ///< as DisplacerSettings

    /// A grid without nodes. DisplacementGrid::cover and fill() add them.
    DisplacementGrid grid(const Camera& camera) const;
    /// Adds X and S at every node and depth. FrameError once a stop is requested, and if a ray reaches n <= 0.
    void fill(DisplacementGrid& grid, const Camera& camera) const;
};

/// The ray of one pixel alone, without interpolation from nodes.
struct BentPixel {
    DisplacementGrid grid;  ///< filled, covers the pixel; its depths are the ends of the ray's steps
    double lost_at;         ///< axial depth from which on the ray is not known; infinite if it is known everywhere [m]
};
/// The ray of pixel (x, y) up to axial depth `farthest` [m]. The other models are judged by it.
BentPixel bent_pixel(const BentRays& model, const Camera& camera, int x, int y, double farthest);

}  // namespace eikonal
