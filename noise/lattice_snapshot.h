/// One instant of a lattice field as continuous functions, and as node values.
///
/// The continuous n is what bends light: the lattice's n less its Nyquist modes of space, which have no force
/// (lattice.h), so that index and gradient along a ray are of one function. It is a periodic cubic B-spline whose
/// coefficients are the lattice spectrum divided by the spline's own transfer (prefilter in Fourier space), so that it
/// passes through the node values exactly: C² in n, C¹ in its gradient, and the gradient is the exact derivative of the
/// interpolated n, hence free of curl. Falloff (PHYSICS 5, Fig. 6) multiplies the potential: n g, with gradient g ∇n +
/// n ∇g, hence curl-free as well (∇g jumps where the falloff begins, h = 0).
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

#include "noise/index_sample.h"
#include "noise/lattice.h"

namespace eikonal {

/// A half-complex spectrum, size[0] × size[1] × (size[2]/2 + 1), on a lattice of `finer` >= size points along each
/// axis: same trigonometric sum. A Nyquist mode that is one no more becomes its two halves, a cosine as before.
FftVector<complex32> pad_spectrum(const FftVector<complex32>& spectrum, const std::array<int, 3>& size,
                                  const std::array<int, 3>& finer);

/// How many times finer than its lattice a spline is, along each axis: >= 1.
using Padding = std::array<int, 3>;

/// Periodic cubic B-spline in three dimensions with period 1 along each axis. Positions are double; what follows from
/// the fraction of a cell is single precision (rounding 1e-6 of the largest value). Immutable, thread-safe.
class PeriodicSpline3 {
  public:
    /// spectrum: half-complex, size[0] × size[1] × (size[2]/2 + 1), Hermitian; the spline passes through its
    /// unnormalised inverse transform on a lattice `padding` times finer.
    PeriodicSpline3(FftVector<complex32> spectrum, const std::array<int, 3>& size, const Padding& padding = {1, 1, 1});

    struct Sample {
        double value;
        dvec3 gradient;  ///< per period
    };
    /// At x [periods], any finite value (reduced modulo 1).
    Sample sample(const dvec3& x) const;

    /// The same in double precision throughout, for integrators of high order: as smooth as the spline is.
    IndexSample smooth_sample(const dvec3& x) const;
    /// With the second derivatives [per period²]: the exact derivative of that gradient, continuous, piecewise linear.
    IndexJet jet(const dvec3& x) const;

    /// Bounds of the value anywhere: a spline lies within its coefficients' range.
    float lower_bound() const { return lower_; }
    float upper_bound() const { return upper_; }

  private:
    std::array<int, 3> size_;
    FftVector<float> coefficients_;
    float lower_ = 0, upper_ = 0;
};

/// Transfer of the cubic B-spline at its knots, (2 + cos θ)/3, for a phase advance of θ = 2π turns a cell.
double spline_transfer(double turns);

/// Rms error, relative to e^{ikx}, of the cubic spline through its samples, and of the spline's slope; |turns| <= 1/2 a
/// cell. The spline holds the mode and its aliases θ + 2πm with weights ∝ (θ + 2πm)^-4. *added*
double spline_error(double turns);
double spline_slope_error(double turns);

/// Expected rms errors of a snapshot's gradient, without falloff: discrete sums over the lattice's modes.
struct SnapshotError {
    double slope = 0;  ///< relative to the rms gradient
    /// Of the gradient's integral along a straight ray, across it, after 1 m [m^-1/2]; it grows as the root of the
    /// way. A wave adds up only on rays along its crests: π <e²>/k over all directions, of a wave whose gradient is
    /// off by e. Rays near an axis, along which aliases have crests too, are off by that; oblique ones by half. *added*
    double bend = 0;
};
/// With cells of l0/2 (von Kármán) and padding 1, 2, 3, 4 the slope's are 0.19, 0.0096, 0.0022, 8.4e-4.
SnapshotError snapshot_error(const LatticeField& field, int padding);

/// n - n_ambient (less Nyquist modes) and its gradient at one instant, with falloff. Immutable, thread-safe.
class LatticeSnapshot {
  public:
    /// t [s]; padding >= 1 (see above).
    LatticeSnapshot(const LatticeField& field, double t, int padding = 1);
    LatticeSnapshot(const LatticeField& field, double t, const Padding& padding);

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

/// g and ∇g [1/m] of a falloff at x.
IndexSample falloff_at(const Falloff& falloff, const dvec3& x);
/// With the second derivatives [1/m²].
IndexJet falloff_jet(const Falloff& falloff, const dvec3& x);
/// The product with a field's own values at x.
IndexSample with_falloff(const std::optional<Falloff>& falloff, const dvec3& x, const IndexSample& field);
IndexJet with_falloff(const std::optional<Falloff>& falloff, const dvec3& x, const IndexJet& field);

/// Node values at time t, nx × ny × nz row-major, node (i, j, l) at world (i Lx/nx, j Ly/ny, l Lz/nz): n - n_ambient,
/// Nyquist modes included, or an exact component of the force (bending spectrum times ik), both with falloff.
FftVector<float> node_field(const LatticeField& field, double t, Component what);

}  // namespace eikonal
