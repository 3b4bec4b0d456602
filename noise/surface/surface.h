/// Air over a heated or cooled surface (PHYSICS.md#heated-surface, Eq. 4 *paper*), the source of mirages:
///
///     T(h) = T_a + (T_S - T_a) e^{-h/d0},   h = (x - origin)·normal >= 0,     n by Eq. 3 exactly:
///     n - n_a = (n0 - 1) T0 (T_a - T)/(T T_a)
///
/// Below the surface (h < 0) the index is that of the surface itself. The gradient is zero there and jumps at h = 0.
/// The index depends on the height alone, so that n cosθ (θ the angle to the surface) is constant along a ray.
///
/// With e = e^{-h/d0}, T is written as T_S e + T_a (1 - e), where the bracket is computed without cancellation. Where
/// no digits are lost it is T_a + D. With D = T - T_a = (T_S - T_a) e and A = (n0 - 1) T0:
///     n - n_a = -A D/(T T_a),   n' = A D/(d0 T²),   n'' = A D (D - T_a)/(d0² T³)
/// Relative errors are within kSurfaceError for any d0 from 1e-12 to 1e12 m and temperatures from 1e-3 to 1e12 K. The
/// error of n'', which changes sign, is relative to A |D| (|D| + T_a)/(d0² T³). Values below 1e-290 may be zero.
/// Exaggeration is not included.
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

    /// The height h of x [m]. Below: the change of height per metre along a direction.
    double height(const dvec3& x) const;
    double climb(const dvec3& direction) const;

    /// n - n_ambient at height h, and below its first [1/m] and second [1/m²] derivative. For h < 0 the derivatives are
    /// 0.
    double above_ambient(double h) const;
    double slope(double h) const;
    double curvature(double h) const;

    /// Height [m] above which |n - n_a| is below kNegligibleIndex of its largest value. The derivatives are then about
    /// as small.
    double top() const { return top_; }
    /// Height d0 ln(T_S/T_a) [m]. Over a very hot surface T has fallen to about 2 T_a there, and the derivatives are
    /// largest near it. Over others they are largest at the surface. 0 unless T_S > T_a.
    double knee() const { return knee_; }
    double dropoff() const { return dropoff_; }
    const dvec3& normal() const { return normal_; }
    /// Bound of |n'| anywhere [1/m].
    double largest_slope() const { return largest_slope_; }
    /// Whether the surface has another temperature than the ambient.
    bool bends() const { return excess_ != 0; }

    /// Grazing angle [rad] below the horizontal of the ray from `camera_height` >= 0 that just touches h = 0, with n -
    /// n_a multiplied by `exaggeration`. All rays that are less steep turn back upward. cosθ = n(0)/n(H), or its root
    /// in the paper's convention. θ = √(2(n_a - n_S)) if it is small and H is large. 0 if the air at the surface is
    /// optically denser, π/2 if no ray reaches the surface.
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
    bool plain_;                         ///< whether T = T_a + D loses no digits
    double top_, knee_, largest_slope_;
};

}  // namespace eikonal
