/// Model `screens`: thin screens across a perspective or orthographic view (PHYSICS.md#thin-screens, *added*):
///
///     X(z) = f_px Σ_m lever_m(z) √L³ M ∇⊥ψ_m,      lever_m(z) = z - w_m behind slab m
///     (noise/turbulence/screens/screen_layout.h)
///
/// On the axis d = X(D)/D is therefore f_px Σ (1 - w_m/D) ∇⊥ψ_m. A slanted ray differs in three ways. Its lever is L
/// times as long. It crosses L times as much air, whose bend is √L times as large. A bend in the plane of the slant
/// shows L times as large again, which the matrix M expresses (noise/turbulence/screens/screen_force.h).
///
/// The screens are planes fixed in the world. They are perpendicular to the axis of the shot's reference camera and
/// placed from its position. Each ray is intersected with these planes, so that displacement is consistent when the
/// camera moves. A slab that the camera has partly passed keeps the part ahead. The variance of a slab is proportional
/// to its thickness, so its bend is scaled by the root of that part. The bend acts in the middle of that part. Nothing
/// jumps when the camera flies through a slab. The air begins at the reference camera and ends at its far distance. A
/// camera behind the reference position has no air before the first slab, and one that has advanced has less air ahead.
///
/// Under a camera that has turned, each ray has levers of its own. Between the depths of a grid they are interpolated
/// by a cubic through the levers at the ends of the axis' slabs. The error is a few per cent of one screen's part at
/// most.
///
/// Range: the view axis lies within kWidestTurn of the reference axis; FrameError beyond.
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

    /// Grids without nodes for the depths nearest … farthest [m]. Screens whose pattern allows the same node spacing
    /// share one grid. Its depths are the ends of their slabs; between these X is at most a parabola. Screens beyond
    /// `farthest` are left out.
    std::vector<DisplacementGrid> grids(const Camera& camera, double nearest, double farthest) const;

    /// Sets X and S of the screens that `grid` stands for. Its nodes must be zero.
    void fill(DisplacementGrid& grid, const Camera& camera) const;
};

}  // namespace eikonal
