/// A triply periodic function as a cubic B-spline through its samples: C2, with its exact gradient and Hessian.
///
/// Interpolation error against the trigonometric sum, in rms and relative to the mode, for a mode of τ turns a cell
/// along an axis: spline_error(τ) for the value, spline_slope_error(τ) for its derivative there. Both are known in
/// closed form. (τ: value, slope) 1/2: 0.7, 0.7; 3/8: 0.17, 0.23; 1/4: 0.019, 0.04; 1/8: 8e-4, 3e-3; 1/16: 4e-5, 4e-4.
/// Padding by p evaluates the trigonometric sum on a lattice p times finer first, which divides τ by p and costs p³ in
/// memory. Failures: none but std::bad_alloc.
#pragma once

#include <array>

#include "noise/math/fft.h"
#include "noise/math/index_sample.h"

namespace eikonal {

using glm::dvec3;

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

}  // namespace eikonal
