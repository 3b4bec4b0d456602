/// Rays over a heated or cooled plane, bent exactly (PHYSICS.md#ray-equation to #heated-surface): the two-dimensional
/// problem behind a mirage.
///
/// The index depends on nothing but the height h >= 0 over the plane. A ray therefore stays in the vertical plane of
/// its start, and the component of dx/du along the ground is constant. The ray starts at height H; w is the sine of its
/// elevation (w < 0: downwards). Let σ be the way along the ground divided by the cosine of that elevation. This is the
/// length of the straight ray to the same place, so the straight ray is at height H + wσ. Then
///
///     (dh/dσ)² = w² + q(h),    q = (n²(h) − n²(H))/n²(H)  physical (*corrected*),   (n(h) − n(H))/n(H)  paper
///
/// Closed form (*added*). By Eqs. 3 and 4 the index is a rational function of y = (T − T_a)/T_a = β e^{−h/d0}, with
/// β = (T_S − T_a)/T_a:  n − n_a = −N y/(1 + y), where N is the exaggerated n_a − 1. Hence
/// w² + q = (A + B y + C y²)/(1 + y)² exactly, and A, B, C can be computed without cancellation. With v = 1/|y|, which
/// grows with h,
///
///     σ/d0 = χ ± ∫ dχ/v,     (dv/dχ)² = A v² ± B v + C          (− for a cold surface, y < 0)
///
/// So v(χ) is a hyperbolic function or, in a cold duct (A < 0), a trigonometric one. The integral is an arctangent or
/// an artanh. χ counts from the ray's anchor. This is the turning point above a hot surface, about which the ray is
/// even. For other rays it is where the ray meets the plane, forwards or backwards. Only the inversion σ(χ) -> χ, which
/// is nearly the identity, is iterated, by Newton's method down to rounding. More than kSurfaceRayCut e-folds above the
/// anchor, rays are straight.
///
/// Accuracy: δ/σ within kSurfaceRayError (tests/warp/displace/media/surface/mirage_test.cpp, against an integration of
/// the ray equation in long double). Finite for every finite input. Portable arithmetic: the same bits everywhere.
/// Theory: PHYSICS.md#mirage.
#pragma once

#include "noise/medium/optics.h"
#include "noise/medium/refractivity.h"
#include "noise/surface/surface_spec.h"

namespace eikonal {

/// Error of a ray's height, as an angle seen from its start [rad], for ways from 1 cm on and d0 up to 10 m.
inline constexpr double kSurfaceRayError = 1e-9;
/// Beyond so many e-folds of v a ray is straight, within e^-24 of d0.
inline constexpr double kSurfaceRayCut = 24;

/// The parameters of a surface that its rays depend on.
struct SurfaceOptics {
    double d0;              ///< dropoff [m]
    double beta;            ///< β > -1
    double N;               ///< exaggerated n_a - 1
    double ambient;         ///< n_a
    bool paper;             ///< the paper's ray equation
    double sign, log_beta;  ///< sign of β; ln|β|

    SurfaceOptics(const SurfaceSpec& spec, const IndexLaw& law, double exaggeration, RayEquation equation);
    /// Whether the surface bends rays at all.
    bool bends() const { return beta != 0 && N != 0; }
};

/// One bent ray. Way and depth are measured from its start.
class SurfaceRay {
  public:
    SurfaceRay() = default;
    /// H > 0 [m]; -1 <= w <= 1. optics must outlive this, and bend.
    SurfaceRay(const SurfaceOptics& optics, double H, double w);

    /// σ where the ray meets the plane [m]; infinite if it never does.
    double hit() const { return hit_; }
    /// σ where the ray turns round above the plane, on its way down to it [m]; 0 if it does not.
    double turn() const { return !straight_ && turns_ && start_X_ < 0 ? -start_X_ * optics_->d0 : 0; }
    /// h - H at a way σ >= 0 [m].
    double climb(double way) const { return w_ * way + rise(way); }
    /// h - (H + wσ) at a way σ >= 0 [m]: how far the bent ray is above the straight one. Beyond hit() it keeps the
    /// value at hit().
    double rise(double way) const { return rise_where(way, 1, 0); }
    /// The same where along σ + across (h - H) = z >= 0, at an axial depth z for example. along > 0, and
    /// along + across w > 0. The value at hit() if the ray ends before.
    double rise_where(double z, double along, double across) const;

  private:
    struct State {
        double X, dX, log_slope, v;  ///< σ/d0 from the anchor, its derivative by χ, that of ln v, and v; of |χ|
    };
    State at(double chi) const;
    State signed_at(double chi) const;
    double rise_of(double X, double log_v) const;
    void set_series(double y_H, double a, double b, double k);
    double set_anchor(double at_ground, double v_H, double p_H);
    double start_chi(double tau) const;
    void set_far_end();

    const SurfaceOptics* optics_ = nullptr;
    double w_ = 0;
    bool straight_ = true;  ///< too far above the layer
    bool turns_ = false;    ///< its anchor is a turning point
    double bend_ = 0, bend_slope_ = 0,
           short_ = 0;  ///< second and third derivative of h at the start; σ/d0 where they do
    double A_ = 0, B_ = 0, C_ = 0;
    double root_ = 0;  ///< √|A|
    double v_anchor_ = 1, p_anchor_ = 0;
    double all_ = 0;                                      ///< ∫ dχ/v over χ > 0 (A > 0)
    double log_far_ = 0;                                  ///< ln v - root χ far up
    double cut_ = 0;                                      ///< χ beyond which the ray is straight; infinite for A <= 0
    double top_chi_ = 0, top_X_ = 0;                      ///< of a duct's highest point, A < 0
    double start_chi_ = 0, start_X_ = 0, start_log_ = 0;  ///< at the camera, signed: < 0 before the anchor
    double end_X_ = 0, hit_ = 0;
    double tolerance_ = 0;  ///< of Newton's last step in χ
};

}  // namespace eikonal
