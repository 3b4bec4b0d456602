/// What is known of a scene whose only medium is air over a heated surface, a mirage: where it is too quiet to matter,
/// and the first-order bend of a straight ray in closed form (*added*). It spares most of a ray's cost.
///
/// The index is a function of the height h alone. With q = n - n_a = ε A (1/T - 1/T_a), ε the exaggeration, and g =
/// (n² - n_a²)/2 = n_a q + q²/2 (paper's convention: q/2), the force along the normal is dg/dh, hence for a ray that
/// climbs c a metre of way, at distance D, h1 = h0 + c D:
///
///     ∫₀^D (D - w) F dw = ( (P(h1) - P(h0))/c - D g(h0) )/c,      P(h) = ∫ g dh
///     ∫ q dh = ε A (d0/T_a) ln(T/T_a),     ∫ q² dh = -(ε A)² (d0/T_a) ( ln(T/T_a)/T_a + 1/T - 1/T_a )
///
/// Metres; positions in the world. Immutable, thread-safe.
#pragma once

#include <optional>

#include "noise/surface/surface.h"

namespace eikonal::reference {

/// Relative error of LoneSurface::pull, of the largest that the same change of height can cause.
inline constexpr double kPullError = 1e-9;

class LoneSurface {
  public:
    LoneSurface(const SurfaceSpec& spec, const OpticsSpec& optics);

    /// Length of the way from x along the unit direction d on which all that is above turns a ray by less than `turn`
    /// [rad] > 0, however it goes on within `longest` metres: 0 if none.
    double clear_way(const dvec3& x, const dvec3& d, double turn, double longest) const;
    /// Whether |F| is below `force` [1/m] > 0 all along the straight ray from this height, unit direction d, for sure.
    bool is_quiet(double height, const dvec3& d, double distance, double force) const;

    /// Of a height: the functions above.
    struct AtHeight {
        double height, g, P;
    };
    AtHeight at(const dvec3& x) const { return at(layer_.height(x)); }

    /// ∫₀^D (D - w) F dw along a straight ray from a place of which at() tells, unit direction d, [m] in units of the
    /// index squared. Nothing for rays below the surface, for those that change their height by less than a part of the
    /// dropoff, where the form cancels, and where there might be no index.
    std::optional<dvec3> pull(const AtHeight& from, const dvec3& d, double distance) const;

  private:
    AtHeight at(double h) const;
    double quiet_height(double force) const;

    SurfaceIndex layer_;
    IndexLaw law_;
    RayEquation equation_;
    double exaggeration_, largest_force_;
    bool has_index_;  ///< everywhere, for sure
    AtHeight surface_;
};

}  // namespace eikonal::reference
