/// The thin screens of one medium at one instant, as a force along bent rays (noise/air/air.h).
///
/// The bend of slab m is spread evenly over the way through the slab (*added*). It is taken at the point q where the
/// ray's tangent meets the screen:
///
///     F⊥ = M ∇⊥(g ψ_m)(q)/(√L δ),   q = x⊥ + (w_m - z) s,   s = p⊥/p_z,   L = |p|/|p_z|,   near_m <= z < far_m
///     M = 1 + s sᵀ/(L + 1)                                                                   (slanted_bend)
///
/// g is the falloff at q. A straight ray crosses L δ metres, so it turns by an angle of √L |∇⊥(gψ)|. The root is there
/// because the variance of a bend grows in proportion to the air crossed. The angle has the same size in both
/// directions across the ray, as the air is isotropic. An angle α changes the slope by α L² in the plane of slant and
/// by α L across it. M therefore stretches the former L times. The displacement of the ray is √L³ lever_m(z) M ∇⊥(gψ),
/// which agrees with the warp's first order (noise/turbulence/screens/screen_layout.h).
///
/// q and F are constant along a straight ray within a slab, whichever side it comes from. At the end of a slab, F
/// belongs to the slab that the ray enters. Slabs are fixed in the world. Rays steeper than kSteepestRay are not bent:
/// thin screens have no meaning for a ray along them.
/// Theory: PHYSICS.md#thin-screens.
#pragma once

#include <glm/vec2.hpp>
#include <optional>

#include "noise/medium/medium.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "noise/turbulence/screens/screens.h"

namespace eikonal {

/// L of the most slanted ray that screens bend.
inline constexpr double kSteepestRay = 100;

/// M times the bend g, for a ray of slope s against the screen's normal, L = √(1 + s²). M makes the part along s L
/// times as large. *added*
inline glm::dvec2 slanted_bend(const glm::dvec2& s, double L, const glm::dvec2& g) {
    return g + s * ((s.x * g.x + s.y * g.y) / (L + 1));
}

/// Immutable, thread-safe.
class ScreenForce final : public MediumInstant {
  public:
    /// screens: an instant of `field`. frame: has the axes of `field`. strength: factor of ∇ψ, from the ray equation
    /// and exaggeration.
    ScreenForce(const ScreenField& field, std::vector<ScreenInstant> screens, const ShotFrame& frame,
                const std::optional<Falloff>& falloff, double strength);

    bool has_index() const override { return false; }
    dvec3 force(const dvec3& x, const dvec3& p) const override;
    ForceJet force_jet(const dvec3& x, const dvec3& p) const override;

    /// The longest step [m] from x, for any d: one slab, and the way to the slabs. It is shorter where the ray may bend
    /// so much within a slab that the meeting point q moves by a good part of a cell.
    double longest_step(const dvec3& x, const dvec3& d) const override;
    /// Way to the first slab [m]. 0 within the slabs.
    double clear_way(const dvec3& x, const dvec3& d) const override;
    /// Way to the next end of a slab [m].
    double way_to_edge(const dvec3& x, const dvec3& d) const override;
    /// Exact: the force is constant along a straight ray within a slab.
    bool add_bend(const dvec3& x, const dvec3& d, double distance, double turn, StraightBend& sum) const override;

  private:
    struct Meeting;
    std::optional<Meeting> meet(const dvec3& x, const dvec3& p) const;
    double depth(const dvec3& x) const;
    double rate(const dvec3& d) const;

    ShotFrame frame_;
    std::optional<Falloff> falloff_;
    double strength_;
    std::vector<ScreenInstant> screens_;
    std::vector<double> ends_;   ///< depths of the first slab's near end, then of all far ends [m]
    std::vector<double> steps_;  ///< longest step inside each slab [m]
};

}  // namespace eikonal
