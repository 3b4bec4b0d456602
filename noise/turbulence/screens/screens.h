/// Thin screens for long paths (PHYSICS.md#thin-screens, *added*). A screen stands for a slab of air thicker than L0.
/// It is a plane of random optical path ψ(x, y) = ∫ n dw [m] through the slab, with the 2-D spectrum 2πδ Φ_n(k⊥, kz =
/// 0). It drifts and evolves.
///
///     angle(θ; D) = Σ_m (1 - w_m/D) ∇⊥ψ_m(w_m θ),   w_m < D        (perspective; the sum is the caller's)
///
/// x and y [m] are lateral coordinates on a screen, along the axes e1 and e2 given at construction, and zero on the
/// axis of the shot. Screens are fixed in the world. A screen is the sum of several lattices (screen_bands of
/// noise/turbulence/screens/screen_layout.h), each made by one transform (noise/turbulence/screens/screen_band.h). The
/// gradient is the exact gradient of the splines through them.
///
/// Mean velocity. The components along e1 and e2 carry the whole pattern, by an exact shift of the sample position at
/// any t. The component along the axis does not move screens: it would only exchange the air in a slab for air of the
/// same statistics, which evolution does. With a velocity, the loop over T closes only if v T is a whole number of
/// periods.
///
/// Not included: the falloff (multiply by g where a ray meets the screen, and add ψ∇g), the ray equation's factor (½ in
/// the paper's convention), and exaggeration.
/// Theory: PHYSICS.md#focusing.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "noise/turbulence/parameters/turbulence_spec.h"
#include "noise/turbulence/screens/screen_layout.h"

namespace eikonal {

/// One screen at one instant. Cheap to copy, immutable, thread-safe.
class ScreenInstant {
  public:
    double w() const { return w_; }                  ///< [m]
    double thickness() const { return thickness_; }  ///< δ [m]
    double cell() const { return cell_; }            ///< cell of the finest lattice [m]

    /// ψ [m] and ∇ψ [rad] at any finite position.
    PeriodicSpline2::Sample sample(double x, double y) const;
    /// With the second derivatives, in double precision.
    PeriodicSpline2::Jet jet(double x, double y) const;
    /// The columns of the points x0 + i step_x, i < n, on every lattice of this screen. They are the same for all rows.
    using Columns = std::vector<PeriodicSpline2::Columns>;
    Columns columns(double x0, double step_x, int n) const;
    /// Along the row at y: interleaved uv += weight ∇ψ, and values += weight ψ.
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
    /// screens: from layout_screens, and passed by check_screens. e1, e2: unit vectors of the lateral axes. UserError
    /// if the paper's lowest wavenumber is beyond all that a screen resolves.
    ScreenField(const TurbulenceSpec& spec, std::vector<ScreenGeometry> screens, const dvec3& e1, const dvec3& e2);

    /// Every screen at any finite time t [s], at the same cost. The bits are the same for any number of threads.
    std::vector<ScreenInstant> at(double t) const;

    const std::vector<ScreenGeometry>& screens() const { return screens_; }

    // The expectations below are discrete: of the lattices, not of the continuum. They hold along one axis [rad²].

    /// Variance of ∂ψ/∂x of one screen.
    double gradient_variance(std::size_t screen) const;
    /// Variance of the angle by which an object at D seems displaced: Σ (lever_m(D)/D)² var_m, with slab_lever.
    /// Continuum, for a point aperture and a large L0: 1.093 Cn² D l0^(-1/3).
    double displacement_angle_variance(double D) const;
    /// The part of that variance which is lost: that of eddies too fine for the screens' lattices, whose cells are no
    /// finer than a pixel. Zero for the paper's spectrum, which ends with its lattice.
    double lost_angle_variance(double D) const;
    /// Variance of the angle of arrival of parallel rays: Σ var_m. Continuum: 3.28 Cn² L l0^(-1/3).
    double arrival_angle_variance() const;
    /// Variance of ∂/∂x of the map's displacement at D: Σ (lever/D)² s² <(∂²ψ/∂x²)²>, with s = w in perspective and
    /// s = D for parallel rays. Near 1, rays fold and first order fails. Continuum: 0.479 Cn² D³ l0^(-7/3) in
    /// perspective, ten times that for parallel rays. Curvature lies at the inner scale. Cells coarser than l0/3 lose
    /// part of it, and this sum does not count that part.
    double focusing_variance(double D, bool perspective = true) const;

  private:
    double lever(std::size_t screen, double D) const;  ///< divided by D

    std::vector<ScreenGeometry> screens_;
    std::vector<std::vector<ScreenBand>> bands_;
    std::vector<double> lost_;  ///< part of gradient_variance that a screen's lattices leave out
    double velocity_x_, velocity_y_;
};

}  // namespace eikonal
