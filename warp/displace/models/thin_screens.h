/// Model `screens`: thin screens across a perspective or orthographic view (PHYSICS.md#thin-screens, *added*):
///
///     X(z) = f_px Σ_m lever_m(z) √L³ M ∇⊥ψ_m,      lever_m(z) = z - w_m behind slab m
///     (noise/turbulence/screens/screen_layout.h)
///
/// so that d = X(D)/D is f_px Σ (1 - w_m/D) ∇⊥ψ_m on the axis. A slanted ray has L times the lever, and crosses L times
/// the air, whose bend is √L times as large; and what turns it in its plane of slant shows L times as large again: M
/// (noise/turbulence/screens/screen_force.h).
///
/// The screens are planes fixed in the world, perpendicular to the axis of the shot's reference camera and placed from
/// its position, so that displacement is consistent when the camera moves: each ray is cut with the planes where it
/// really meets them. A slab that the camera has partly passed keeps the part ahead: its bend is scaled by the root of
/// that part (the variance of a slab is proportional to its thickness) and comes from that part's middle, so that
/// nothing jumps when the camera flies through. The air ends at the far distance of the reference camera, and begins at
/// its place: a camera that backs away has none before the first slab, one that advances is left with less.
///
/// Under a camera that has turned, each ray's levers are its own; between the layers of a grid they are then a cubic
/// through those at the axis' slabs, which errs by a few per cent of one screen's part at most.
///
/// Range: the view axis within kWidestTurn of the reference axis; FrameError beyond.
#pragma once

#include <optional>
#include <vector>

#include "noise/turbulence/parameters/turbulence_spec.h"
#include "noise/turbulence/screens/screens.h"
#include "warp/displace/grid/displacement_grid.h"
#include "warp/displace/grid/ray_frame.h"

namespace eikonal {

/// Cosine of the largest angle between a frame's view axis and the reference axis: 60 degrees.
inline constexpr double kWidestTurn = 0.5;

struct ThinScreens {
    std::vector<ScreenInstant> screens;
    Camera reference;
    double strength;  ///< multiplies ∇ψ: ray equation and exaggeration
    std::optional<Falloff> falloff;

    /// Bands, empty as yet, for the depths nearest … farthest: screens whose pattern allows the same node spacing share
    /// one, and its layers are the ends of their slabs, between which X is a parabola at most. Screens beyond
    /// `farthest` are left out.
    std::vector<DisplacementGrid> grids(const Camera& camera, double nearest, double farthest) const;

    /// Sets X and S of the screens that `grid` stands for. Its nodes are zero.
    void fill(DisplacementGrid& grid, const Camera& camera) const;
};

}  // namespace eikonal
