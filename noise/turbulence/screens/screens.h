/// Thin screens for long paths (PHYSICS.md#thin-screens, *added*): slabs of air thicker than L0, each a plane of random
/// optical path ψ(x, y) = ∫ n dw [m] through the slab, of 2-D spectrum 2πδ Φ_n(k⊥, kz = 0), drifting and evolving.
///
///     angle(θ; D) = Σ_m (1 - w_m/D) ∇⊥ψ_m(w_m θ),   w_m < D        (perspective; the sum is the caller's)
///
/// x, y [m] are lateral coordinates on a screen along the axes e1, e2 given at construction, zero on the axis of the
/// shot; screens are fixed in the world. Each is a sum of lattices (screen_bands of
/// noise/turbulence/screens/screen_layout.h, noise/turbulence/screens/screen_band.h), made by one transform each; the
/// gradient is that of the spline through them.
///
/// Mean velocity: its components along e1 and e2 carry the whole pattern, an exact shift of the sample position at any
/// t. The component along the axis does not move screens (it would only exchange the air in a slab for air of the same
/// statistics, which evolution does). With a velocity the loop over T closes only if v T is a whole number of periods.
/// Falloff is not applied: multiply by the strength g at the point where a ray meets the screen (and add ψ∇g).
/// The ray equation's factor (½ in the paper's) and exaggeration are the caller's too.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "noise/turbulence/screens/screen_layout.h"

namespace eikonal {

/// One screen at one instant. Cheap to copy, immutable, thread-safe.
class ScreenInstant {
  public:
    double w() const { return w_; }                  ///< [m]
    double thickness() const { return thickness_; }  ///< δ [m]
    double cell() const { return cell_; }            ///< of the finest lattice [m]

    /// ψ [m] and ∇ψ [rad] at any finite position.
    PeriodicSpline2::Sample sample(double x, double y) const;
    /// With the second derivatives, in double precision.
    PeriodicSpline2::Jet jet(double x, double y) const;
    /// Where the points x0 + i step_x, i < n, lie on every lattice of this screen; the same for all rows.
    using Columns = std::vector<PeriodicSpline2::Columns>;
    Columns columns(double x0, double step_x, int n) const;
    /// As PeriodicSpline2's: uv interleaved += weight ∇ψ; values += weight ψ, along the row at y.
    void add_gradients(const Columns& columns, double y, float weight, float* uv) const;
    void add_values(const Columns& columns, double y, float weight, float* values) const;

  private:
    friend class ScreenField;
    double w_ = 0, thickness_ = 0, cell_ = 0, drift_x_ = 0, drift_y_ = 0;
    std::vector<std::shared_ptr<const PeriodicSpline2>> bands_;
};

/// All screens of a medium. Immutable, thread-safe.
class ScreenField {
  public:
    /// screens: as layout_screens gives them; check_screens first. e1, e2: unit vectors of the lateral axes. UserError:
    /// the paper's lowest wavenumber is beyond all that a screen resolves.
    ScreenField(const TurbulenceSpec& spec, std::vector<ScreenGeometry> screens, const dvec3& e1, const dvec3& e2);

    /// Every screen at time t [s], any finite; costs the same for every t. Same bits for any number of threads.
    std::vector<ScreenInstant> at(double t) const;

    const std::vector<ScreenGeometry>& screens() const { return screens_; }

    /// Discrete expectations (of the lattices, not the continuum), single axis [rad²]. Var ∂ψ of one screen:
    double gradient_variance(std::size_t screen) const;
    /// Σ (lever_m(D)/D)² var_m, the lever as slab_lever gives it: the angle that an object at D seems displaced by.
    /// Continuum for a point aperture and large L0: 1.093 Cn² D l0^(-1/3).
    double displacement_angle_variance(double D) const;
    /// The same of the eddies that are too fine for the screens' lattices, whose cells are no finer than a pixel. (The
    /// paper's spectrum ends with its lattice.)
    double lost_angle_variance(double D) const;
    /// Σ var_m: angle of arrival of parallel rays. Continuum: 3.28 Cn² L l0^(-1/3).
    double arrival_angle_variance() const;
    /// Variance of ∂/∂x of the map's displacement at D: Σ (lever/D)² s² <(∂²ψ/∂x²)²> with s = w seen in perspective,
    /// and s = D for parallel rays. Near 1 rays fold and first order fails. Continuum: 0.479 Cn² D³ l0^(-7/3) in
    /// perspective, ten times that for parallel rays. Curvature lives at the inner scale: cells coarser than l0/3 do
    /// not see, and so do not count, all of it.
    double focusing_variance(double D, bool perspective = true) const;

  private:
    double lever(std::size_t screen, double D) const;  ///< as a part of D

    std::vector<ScreenGeometry> screens_;
    std::vector<std::vector<ScreenBand>> bands_;
    std::vector<double> lost_;  ///< gradient_variance that a screen's lattices leave out
    double velocity_x_, velocity_y_;
};

}  // namespace eikonal
