/// Model `second-order`: the ray equation itself, along every node's ray through the sum of all media.
///
///     x1'' = L² F(P(z) + x1, d + x1')/|dx/du|²,   P(z) = origin + z d the straight ray by axial depth
///
/// to which Eq. 7 is the first approximation, F at P alone; second order adds ∫(u - w)(x1·∇)F dw (PHYSICS 6). Taking F
/// where the bent ray is holds that term and those of higher order. Steps of Nyström's fourth-order method, no longer
/// than the field allows (FieldInstant::longest_step) and ending where it jumps. The shift is the exact projection of
/// the bent ray's point at each depth, not the first-order one.
///
/// A ray that has turned by more than kSteepestBend, or has met no index, goes on straight from there: that far no warp
/// holds.
#pragma once

#include "noise/field.h"
#include "warp/displace/band.h"
#include "warp/displace/ray_frame.h"

namespace eikonal {

/// Tangent of the bend against the straight ray beyond which it is not followed.
inline constexpr double kSteepestBend = 1;
/// Steps of a ray at most; the longest are then cut.
inline constexpr int kMostSteps = 20000;

struct SecondOrderInstant {
    FieldInstant field;
    double finest;                  ///< smallest cell of the media [m]
    bool (*cancelled)() = nullptr;  ///< as DisplacerSettings

    /// Adds X and S at every node and depth. FrameError once cancelled.
    void fill(Band& band, const Camera& camera) const;
};

}  // namespace eikonal
