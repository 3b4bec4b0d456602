/// Shortcuts for a scene whose only medium is the air over one heated surface (a mirage): where the air is too quiet to
/// matter, and the first-order bend of a straight ray in closed form (*added*). They save most of a ray's cost.
///
/// The index is a function of the height h only. Let ε be the exaggeration, q = n - n_a = ε A (1/T - 1/T_a), and
/// g = (n² - n_a²)/2 = n_a q + q²/2 (in the paper's convention q/2). The force along the normal is dg/dh. For a ray
/// that climbs by c a metre of way and reaches h1 = h0 + c D at distance D,
///
///     ∫₀^D (D - w) F dw = ( (P(h1) - P(h0))/c - D g(h0) )/c,      P(h) = ∫ g dh
///     ∫ q dh = ε A (d0/T_a) ln(T/T_a),     ∫ q² dh = -(ε A)² (d0/T_a) ( ln(T/T_a)/T_a + 1/T - 1/T_a )
///
/// Units: metres; positions in the world. Immutable, thread-safe. No function fails.
/// Theory: PHYSICS.md#lone-surface.
#pragma once

#include <optional>

#include "noise/medium/optics.h"
#include "noise/surface/surface.h"
#include "noise/surface/surface_spec.h"

namespace eikonal::reference {

/// Error of LoneSurface::pull, relative to the largest pull that the same change of height can cause.
inline constexpr double kPullError = 1e-9;

class LoneSurface {
  public:
    LoneSurface(const SurfaceSpec& spec, const OpticsSpec& optics);

    /// Length of the way from x along the unit direction d [m] on which the ray may be taken as straight. All the air
    /// above turns it by less than `turn` [rad] > 0, however it goes on within `longest` [m]. 0 if there is no such
    /// way.
    double clear_way(const dvec3& x, const dvec3& d, double turn, double longest) const;
    /// Whether |F| is certainly below `force` [1/m] > 0 all along the straight ray from this height. d: unit direction.
    bool is_quiet(double height, const dvec3& d, double distance, double force) const;

    /// g and P of one height, as above.
    struct AtHeight {
        double height, g, P;
    };
    AtHeight at(const dvec3& x) const { return at(layer_.height(x)); }

    /// ∫₀^D (D - w) F dw [m] along a straight ray. from: at() of its start. d: unit direction. Nothing in three cases:
    /// the ray goes below the surface; its height changes by so small a part of the dropoff that the form cancels; or n
    /// <= 0 is possible somewhere.
    std::optional<dvec3> pull(const AtHeight& from, const dvec3& d, double distance) const;

  private:
    AtHeight at(double h) const;
    double quiet_height(double force) const;

    SurfaceIndex layer_;
    IndexLaw law_;
    RayEquation equation_;
    double exaggeration_, largest_force_;
    bool has_index_;  ///< n > 0 everywhere, for certain
    AtHeight surface_;
};

}  // namespace eikonal::reference
