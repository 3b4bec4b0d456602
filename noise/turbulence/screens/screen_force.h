/// Thin screens of one medium at one instant, as a force along bent rays (noise/air/air.h): the bend of slab m spread
/// evenly over the way through it, *added*, and taken at the point q where the ray's tangent meets the screen,
///
///     F⊥ = M ∇⊥(g ψ_m)(q)/(√L δ),   q = x⊥ + (w_m - z) s,   s = p⊥/p_z,   L = |p|/|p_z|,   near_m <= z < far_m
///     M = 1 + s sᵀ/(L + 1)                                                                   (slanted_bend)
///
/// g the falloff at q. A straight ray crosses L δ metres, hence is turned by an angle of √L |∇⊥(gψ)|, the root because
/// the variance of a bend grows as the air crossed, and alike in both directions across it, as the air is isotropic.
/// In the plane of slant an angle α changes the slope by α L², across it by α L: M stretches the former L times. So
/// the ray is displaced by √L³ lever_m(z) M ∇⊥(gψ): what the warp's first order says
/// (noise/turbulence/screens/screen_layout.h). q and so F are constant along a straight ray within a slab, from
/// whichever side it comes. At a slab's end F is that of the slab which the ray goes into. Slabs are fixed in the
/// world.
///
/// Steeper rays than kSteepestRay are not bent: thin screens mean nothing for a ray along them.
#pragma once

#include <glm/vec2.hpp>
#include <optional>

#include "noise/medium/force_jet.h"
#include "noise/medium/shot_frame.h"
#include "noise/turbulence/screens/screens.h"

namespace eikonal {

/// L of the most slanted ray that screens bend.
inline constexpr double kSteepestRay = 100;

/// M times the bend g of a ray whose slope against the screen's normal is s, L = √(1 + s²): its part along s is L times
/// as large. *added*
inline glm::dvec2 slanted_bend(const glm::dvec2& s, double L, const glm::dvec2& g) {
    return g + s * ((s.x * g.x + s.y * g.y) / (L + 1));
}

/// Immutable, thread-safe.
class ScreenForce {
  public:
    /// strength: multiplies ∇ψ (ray equation and exaggeration). The frame's axes are those of `field`.
    /// screens: an instant of `field`.
    ScreenForce(const ScreenField& field, std::vector<ScreenInstant> screens, const ShotFrame& frame,
                const std::optional<Falloff>& falloff, double strength);

    dvec3 force(const dvec3& x, const dvec3& p) const;
    ForceJet force_jet(const dvec3& x, const dvec3& p) const;

    /// The longest step [m] from x: one slab, less if the ray bends so much on it that the tangent's meeting point
    /// moves by a good part of a cell; plus the way to the slabs. The same for every d.
    double longest_step(const dvec3& x, const dvec3& d) const;
    /// To the first slab: 0 within.
    double clear_way(const dvec3& x, const dvec3& d) const;
    /// To the next end of a slab.
    double way_to_edge(const dvec3& x, const dvec3& d) const;

  private:
    struct Meeting;
    std::optional<Meeting> meet(const dvec3& x, const dvec3& p) const;
    double depth(const dvec3& x) const;
    double rate(const dvec3& d) const;

    ShotFrame frame_;
    std::optional<Falloff> falloff_;
    double strength_;
    std::vector<ScreenInstant> screens_;
    std::vector<double> ends_;   ///< depths: near end of the first slab, far ends of all
    std::vector<double> steps_;  ///< longest step inside each slab
};

}  // namespace eikonal
