/// Air over a heated or cooled surface (PHYSICS.md#heated-surface, Eq. 4 *paper*), the source of mirages:
///
///     T(h) = T_a + (T_S - T_a) e^{-h/d0},   h = (x - origin)·normal >= 0,     n by Eq. 3 exactly:
///     n - n_a = (n0 - 1) T0 (T_a - T)/(T T_a)
///
/// Below the surface (h < 0) the index is that of the surface itself and has no gradient, which therefore jumps at
/// h = 0. A function of height alone, so that n cosθ (θ the angle to the surface) is constant along a ray.
///
/// With e = e^{-h/d0}, T is written T_S e + T_a (1 - e), the bracket without cancellation (T_a + D where none
/// threatens), D = T - T_a = (T_S - T_a) e, and A = (n0 - 1) T0:    n - n_a = -A D/(T T_a),   n' = A D/(d0 T²),   n'' =
/// A D (D - T_a)/(d0² T³). Errors are within kSurfaceError, relative, for any d0 from 1e-12 to 1e12 m and temperatures
/// from 1e-3 to 1e12 K (n'' relative to A |D| (|D| + T_a)/(d0² T³): it changes sign); what is below 1e-290 may be zero.
/// Without exaggeration, which is the field's.
#pragma once

#include "noise/math/index_sample.h"
#include "noise/medium/optics.h"
#include "noise/medium/refractivity.h"
#include "noise/surface/surface_spec.h"

namespace eikonal {

inline constexpr double kSurfaceError = 1e-13;
/// Relative error of SurfaceIndex::critical_slope.
inline constexpr double kCriticalSlopeError = 1e-12;

/// Immutable, thread-safe.
class SurfaceIndex {
  public:
    /// spec.normal: of unit length.
    SurfaceIndex(const SurfaceSpec& spec, const IndexLaw& law);

    /// n - n_ambient and its derivatives at any finite x.
    IndexSample sample(const dvec3& x) const;
    IndexJet jet(const dvec3& x) const;

    /// h of x [m]; the height that x gains a metre of way along a direction.
    double height(const dvec3& x) const;
    double climb(const dvec3& direction) const;

    /// n - n_ambient, its first [1/m] and second [1/m²] derivative at height h; 0, but for the first, where h < 0.
    double above_ambient(double h) const;
    double slope(double h) const;
    double curvature(double h) const;

    /// Height [m] above which |n - n_a| is below kNegligibleIndex of its largest, and its derivatives about as small.
    double top() const { return top_; }
    /// Height [m] below which the whole of T_S/T_a has worn off: where the derivatives have their largest, if it is not
    /// at the surface. 0 unless T_S > T_a.
    double knee() const { return knee_; }
    double dropoff() const { return dropoff_; }
    const dvec3& normal() const { return normal_; }
    /// Bound of |n'| anywhere [1/m].
    double largest_slope() const { return largest_slope_; }
    /// Whether the surface differs from the ambient at all.
    bool bends() const { return excess_ != 0; }

    /// Grazing angle [rad] below the horizontal of the ray from `camera_height` >= 0 that just touches h = 0, with
    /// n - n_a multiplied by `exaggeration`: all that leave less steeply return upward. cosθ = n(0)/n(H), in the
    /// paper's convention its root: θ = √(2(n_a - n_S)) where that is small and H large. 0 if the surface is the
    /// optically denser, π/2 if no ray reaches it.
    double critical_slope(double camera_height, double exaggeration = 1,
                          RayEquation equation = RayEquation::Physical) const;

  private:
    /// T, T - T_a and 1/T at h >= 0.
    struct State {
        double T, D, inverse_T;
    };
    State state(double h) const;
    double above_ambient(const State& s) const;
    double slope(const State& s) const;
    double curvature(const State& s) const;

    dvec3 origin_, normal_;
    double dropoff_, inverse_dropoff_;   ///< d0, 1/d0
    double surface_, ambient_, excess_;  ///< T_S, T_a, T_S - T_a [K]
    double inverse_ambient_;             ///< 1/T_a
    double scale_;                       ///< A [K]
    bool plain_;                         ///< T = T_a + D keeps its digits
    double top_, knee_, largest_slope_;
};

}  // namespace eikonal
