/// One instant of a lattice field, as continuous functions and as node values.
///
/// The continuous n is the n that bends light: it leaves out the lattice's Nyquist modes of space (lattice.h). It is
/// the periodic cubic B-spline through the node values (noise/math/periodic_spline3.h, which states its error). n and
/// its first two derivatives are continuous. The gradient is the exact derivative of the interpolated n, so it has no
/// curl.
///
/// Falloff g (PHYSICS.md#turbulence, Fig. 6) multiplies n. The gradient is g ∇n + n ∇g, which has no curl either. ∇g
/// jumps where the falloff begins, at h = 0.
///
/// `padding` p evaluates the trigonometric sum on a lattice p times finer before the spline is fitted. It makes the
/// spline more exact and costs p³ in memory. Each axis may have its own p.
/// Theory: PHYSICS.md#lattice, #spline.
#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "noise/math/periodic_spline3.h"
#include "noise/turbulence/lattice/lattice.h"
#include "noise/turbulence/parameters/falloff.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {

/// Expected rms errors of an instant's gradient, without falloff: discrete sums over the lattice's modes.
struct SplineError {
    double slope = 0;  ///< relative to the rms gradient
    /// Error of the gradient's integral along a straight ray, across the ray, after 1 m [m^-1/2]. It grows as the root
    /// of the way. A wave's error adds up only on rays along its crests. Over all directions the mean square is
    /// π <e²>/k for a wave whose gradient is off by e. It is reached by rays near an axis, where aliases have crests
    /// too. Oblique rays are off by half as much. *added*
    double bend = 0;
};
/// With cells of l0/2 (von Kármán), padding by 1, 2, 3 and 4 gives slopes of 0.19, 0.0096, 0.0022 and 8.4e-4.
SplineError lattice_spline_error(const LatticeField& field, int padding);

/// n - n_ambient without Nyquist modes, with falloff, at one instant. Immutable, thread-safe.
class LatticeInstant {
  public:
    /// t: time [s]. padding: see above, >= 1.
    LatticeInstant(const LatticeField& field, double t, int padding = 1);
    LatticeInstant(const LatticeField& field, double t, const Padding& padding);

    /// At world position x [m]. Periodic, except for the falloff.
    IndexSample sample(const dvec3& x) const;
    /// The same in double precision throughout, for integrators of high order.
    IndexSample smooth_sample(const dvec3& x) const;
    /// With the Hessian, in double precision throughout.
    IndexJet jet(const dvec3& x) const;

    /// Bounds of n - n_ambient anywhere.
    double lower_bound() const {
        return falloff_ ? std::min(0.0, double{spline_.lower_bound()}) : spline_.lower_bound();
    }
    double upper_bound() const {
        return falloff_ ? std::max(0.0, double{spline_.upper_bound()}) : spline_.upper_bound();
    }

  private:
    dvec3 period_;  ///< [m]
    std::optional<Falloff> falloff_;
    PeriodicSpline3 spline_;
};

/// Node values at time t with falloff, nx × ny × nz, row-major. Node (i, j, l) lies at world position
/// (i Lx/nx, j Ly/ny, l Lz/nz). The index includes Nyquist modes. A component of the force is exact: the bending
/// spectrum times ik.
FftVector<float> node_field(const LatticeField& field, double t, Component what);

}  // namespace eikonal
