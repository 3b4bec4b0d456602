/// One instant of a lattice field as continuous functions, and as node values.
///
/// The continuous n is what bends light: the lattice's n less its Nyquist modes of space, which have no force
/// (lattice.h), so that index and gradient along a ray are of one function. It is a periodic cubic B-spline whose
/// coefficients are the lattice spectrum divided by the spline's own transfer (prefilter in Fourier space), so that it
/// passes through the node values exactly: C² in n, C¹ in its gradient, and the gradient is the exact derivative of the
/// interpolated n, hence free of curl. Falloff (PHYSICS.md#turbulence, Fig. 6) multiplies the potential: n g, with
/// gradient g ∇n + n ∇g, hence curl-free as well (∇g jumps where the falloff begins, h = 0).
///
/// Interpolation error against the trigonometric sum, in rms and relative to the mode, for a mode with τ turns a cell
/// along an axis: spline_error(τ) for n, spline_slope_error(τ) for its derivative there (both known in closed form and
/// tested, tests/lattice_test.cpp). `padding` p > 1 evaluates the trigonometric sum on a lattice p times finer first,
/// which costs p³ in memory and divides τ by p; each axis may have its own. (τ: n, slope) 1/2: 0.7, 0.7;
/// 3/8: 0.17, 0.23; 1/4: 0.019, 0.04; 1/8: 8e-4, 3e-3; 1/16: 4e-5, 4e-4.
#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "noise/math/periodic_spline3.h"
#include "noise/turbulence/lattice/lattice.h"
#include "noise/turbulence/parameters/falloff.h"

namespace eikonal {

/// Expected rms errors of a snapshot's gradient, without falloff: discrete sums over the lattice's modes.
struct SplineError {
    double slope = 0;  ///< relative to the rms gradient
    /// Of the gradient's integral along a straight ray, across it, after 1 m [m^-1/2]; it grows as the root of the
    /// way. A wave adds up only on rays along its crests: π <e²>/k over all directions, of a wave whose gradient is
    /// off by e. Rays near an axis, along which aliases have crests too, are off by that; oblique ones by half. *added*
    double bend = 0;
};
/// With cells of l0/2 (von Kármán) and padding 1, 2, 3, 4 the slope's are 0.19, 0.0096, 0.0022, 8.4e-4.
SplineError lattice_spline_error(const LatticeField& field, int padding);

/// n - n_ambient (less Nyquist modes) and its gradient at one instant, with falloff. Immutable, thread-safe.
class LatticeInstant {
  public:
    /// t [s]; padding >= 1 (see above).
    LatticeInstant(const LatticeField& field, double t, int padding = 1);
    LatticeInstant(const LatticeField& field, double t, const Padding& padding);

    /// At world position x [m]; periodic but for the falloff.
    IndexSample sample(const dvec3& x) const;
    /// The same in double precision throughout, and with the Hessian: the tracer's.
    IndexSample smooth_sample(const dvec3& x) const;
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

/// Node values at time t, nx × ny × nz row-major, node (i, j, l) at world (i Lx/nx, j Ly/ny, l Lz/nz): n - n_ambient,
/// Nyquist modes included, or an exact component of the force (bending spectrum times ik), both with falloff.
FftVector<float> node_field(const LatticeField& field, double t, Component what);

}  // namespace eikonal
