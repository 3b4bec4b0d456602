/// Model `screens`: thin screens across a perspective or orthographic view (PHYSICS 6, *added*):
///
///     angle(θ; D) = Σ_m (1 - w_m/D) ∇⊥ψ_m(w_m θ),   w_m < D
///
/// The screens are planes fixed in the world, perpendicular to the axis of the shot's reference camera and placed from
/// its position, so that displacement is consistent when the camera moves: each ray is cut with the planes where it
/// really meets them. A slab that the camera has partly passed keeps the part ahead of it: its kick is scaled by the
/// root of that part (the variance of a slab is proportional to its thickness) and acts from that part's middle, so
/// that nothing jumps when the camera flies through.
///
/// Range: the view axis within kWidestTurn of the reference axis; UserError beyond.
#pragma once

#include <optional>
#include <vector>

#include "noise/screens.h"
#include "warp/displace/band.h"
#include "warp/displace/ray_frame.h"

namespace eikonal {

/// Cosine of the largest angle between a frame's view axis and the reference axis: 60 degrees.
inline constexpr double kWidestTurn = 0.5;

struct ScreensInstant {
    std::vector<ScreenSnapshot> screens;
    Camera reference;
    double strength;  ///< multiplies ∇ψ: ray equation and exaggeration
    std::optional<Falloff> falloff;

    /// Bands, empty as yet, for the depths nearest … farthest: screens whose pattern allows the same node spacing share
    /// one, and its layers are the planes at which X has a kink. Screens beyond `farthest` are left out.
    std::vector<Band> bands(const Camera& camera, double nearest, double farthest) const;

    /// Adds X and S of the screens that `band` stands for.
    void fill(Band& band, const Camera& camera) const;
};

}  // namespace eikonal
