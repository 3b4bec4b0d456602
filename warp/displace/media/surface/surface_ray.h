/// Rays over a heated or cooled plane, bent exactly (PHYSICS.md#ray-equation to #heated-surface): the two-dimensional
/// problem behind a mirage.
///
/// The index depends on the height h >= 0 over the plane only, so that a ray stays in the vertical plane of its start,
/// and what it has of dx/du along the ground is constant. Let it start at height H with w = the sine of its elevation
/// (w < 0: downwards), and let σ be its way along the ground over the cosine of that elevation: the length of the
/// straight ray to the same place, so that the straight ray is at H + wσ. Then
///
///     (dh/dσ)² = w² + q(h),    q = (n²(h) − n²(H))/n²(H)  physical (*corrected*),   (n(h) − n(H))/n(H)  paper
///
/// Closed form (*added*). By Eqs. 3 and 4 the index is a rational function of y = (T − T_a)/T_a = β e^{−h/d0}, with
/// β = (T_S − T_a)/T_a:  n − n_a = −N y/(1 + y), N the exaggerated n_a − 1. Hence w² + q = (A + B y + C y²)/(1 + y)²
/// exactly, with A, B, C free of cancellation, and with v = 1/|y|, which grows with h,
///
///     σ/d0 = χ ± ∫ dχ/v,     (dv/dχ)² = A v² ± B v + C          (− for a cold surface, y < 0)
///
/// so v(χ) is hyperbolic or (a cold duct, A < 0) trigonometric, and the integral is an arctangent or its hyperbolic
/// relative. χ is counted from the ray's anchor: its turning point above the hot surface, else where it leaves the
/// plane when followed backwards, or meets it; the ray is even about the former. Only the inversion σ(χ) -> χ, near the
/// identity, is iterated: Newton, to rounding. More than kSurfaceRayCut e-folds above the anchor, rays are straight.
///
/// Accuracy: δ/σ within kSurfaceRayError (tests/mirage_test.cpp, against an integration of the ray equation in long
/// double). Finite for every finite input. Portable arithmetic: the same bits everywhere.
#pragma once

#include "noise/medium/media.h"
#include "noise/medium/refractivity.h"

namespace eikonal {

/// [rad]: what the error of a ray's height shows as from its start, for ways from 1 cm and d0 up to 10 m.
inline constexpr double kSurfaceRayError = 1e-9;
/// e-folds of v beyond which a ray is straight, within e^-24 of d0.
inline constexpr double kSurfaceRayCut = 24;

/// A surface as its rays need it.
struct SurfaceOptics {
    double d0;              ///< dropoff [m]
    double beta;            ///< β > -1
    double N;               ///< exaggerated n_a - 1
    double ambient;         ///< n_a
    bool paper;             ///< the paper's ray equation
    double sign, log_beta;  ///< of β; ln|β|

    SurfaceOptics(const SurfaceSpec& spec, const IndexLaw& law, double exaggeration, RayEquation equation);
    /// Whether it bends rays at all.
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
    /// h - (H + wσ) at a way σ >= 0 [m]: how far the bent ray is above the straight one. Constant beyond the hit is the
    /// ray's end, not this: there it is that of σ = hit().
    double rise(double way) const { return rise_where(way, 1, 0); }
    /// The same where the ray crosses the plane  along σ + across (h - H) = z >= 0  (an axial depth): along > 0, and
    /// along + across w > 0. At its end if it ends before.
    double rise_where(double z, double along, double across) const;

  private:
    struct State {
        double X, dX, log_slope, v;  ///< σ/d0 from the anchor, its derivative by χ, that of ln v, and v; of |χ|
    };
    State at(double chi) const;
    State signed_at(double chi) const;
    double rise_of(double X, double log_v) const;

    const SurfaceOptics* optics_ = nullptr;
    double H_ = 0, w_ = 0;
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
