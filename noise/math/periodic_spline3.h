/// A triply periodic function as a cubic B-spline through its samples, with its exact gradient and Hessian. The
/// function and its first two derivatives are continuous.
///
/// The spline deviates from the trigonometric sum between the samples. For a mode of τ turns a cell along an axis, the
/// rms error relative to the mode is spline_error(τ) in the value and spline_slope_error(τ) in the derivative along
/// that axis:
///     τ        1/2    3/8    1/4     1/8    1/16
///     value    0.7    0.17   0.019   8e-4   4e-5
///     slope    0.7    0.23   0.04    3e-3   4e-4
/// Padding by p evaluates the trigonometric sum on a lattice p times finer first. It divides τ by p and costs p³ in
/// memory.
///
/// Failures: std::bad_alloc.
/// Theory: PHYSICS.md#spline.
#pragma once

#include <array>

#include "noise/math/fft.h"
#include "noise/math/index_sample.h"

namespace eikonal {

using glm::dvec3;

/// Moves a half-complex spectrum, size[0] × size[1] × (size[2]/2 + 1), to a lattice of `finer` >= size points along
/// each axis. The trigonometric sum stays the same. A mode that was Nyquist and is no longer is split into the two
/// halves of a cosine.
FftVector<complex32> pad_spectrum(const FftVector<complex32>& spectrum, const std::array<int, 3>& size,
                                  const std::array<int, 3>& finer);

/// How many times finer than the spectrum's lattice a spline is along each axis, >= 1.
using Padding = std::array<int, 3>;

/// Periodic cubic B-spline in three dimensions, with period 1 along each axis. Immutable, thread-safe.
class PeriodicSpline3 {
  public:
    /// spectrum: half-complex, size[0] × size[1] × (size[2]/2 + 1), Hermitian. The spline passes through the
    /// spectrum's unnormalised inverse transform on a lattice `padding` times finer.
    PeriodicSpline3(FftVector<complex32> spectrum, const std::array<int, 3>& size, const Padding& padding = {1, 1, 1});

    struct Sample {
        double value;
        dvec3 gradient;  ///< per period
    };
    /// At x [periods], any finite value. Single precision after the cell is found: rounding is 1e-6 of the largest
    /// value.
    Sample sample(const dvec3& x) const;

    /// The same in double precision throughout, for integrators of high order, which rounding would disturb.
    IndexSample smooth_sample(const dvec3& x) const;
    /// With the second derivatives [per period²]: the exact derivative of that gradient, continuous and piecewise
    /// linear.
    IndexJet jet(const dvec3& x) const;

    /// Bounds of the value anywhere. A spline lies within the range of its coefficients.
    float lower_bound() const { return lower_; }
    float upper_bound() const { return upper_; }

  private:
    std::array<int, 3> size_;
    FftVector<float> coefficients_;
    float lower_ = 0, upper_ = 0;
};

/// Transfer of the cubic B-spline at its knots, (2 + cos θ)/3, for a phase advance of θ = 2π turns a cell.
double spline_transfer(double turns);

/// Rms error, relative to e^{ikx}, of the cubic spline through its samples, and of the spline's slope. turns: of the
/// mode a cell, |turns| <= 1/2. The spline holds the mode and its aliases θ + 2πm, with weights ∝ (θ + 2πm)^-4. *added*
double spline_error(double turns);
double spline_slope_error(double turns);

}  // namespace eikonal
