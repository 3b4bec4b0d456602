/// A doubly periodic function as a cubic B-spline through its samples, with its exact gradient and second derivatives.
/// The function and its first two derivatives are continuous.
///
/// The coefficients come from a half-complex spectrum. Each mode is divided by the spline's transfer (2 + cos ω)/3
/// along both axes, and one transform follows. Positions are metres. Gradients have the function's unit per metre.
/// Positions are reduced modulo the period in double precision. All later arithmetic is single precision, unless
/// stated.
///
/// The spline passes through the samples, but for rounding. Between them it deviates from the trigonometric sum. The
/// gradient of a mode of ω = k·cell [rad a sample] has the relative rms error spline_slope_error(ω/2π) of
/// noise/math/periodic_spline3.h: 0.04 % at ω = π/8, 0.33 % at π/4, 0.9 % at π/3, 4 % at π/2, 23 % at 3π/4. Padding by
/// p divides ω by p.
///
/// Failures: std::bad_alloc. Immutable and thread-safe after construction.
/// Theory: PHYSICS.md#spline.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "noise/math/fft.h"

namespace eikonal {

/// Transform and prefilter of one lattice shape. Many splines can share it, since planning takes longer than making a
/// small spline.
class SplinePlan2 {
  public:
    /// nx, ny: size of the spectrum's lattice, >= 1. pad: how many times finer the spline's own lattice is, >= 1.
    SplinePlan2(int nx, int ny, int pad = 1);

  private:
    friend class PeriodicSpline2;
    int nx_, ny_, pad_;
    FftVector<float> filter_x_, filter_y_;  // 3/(2 + cos ω) of each padded row and column
    FftPlan plan_;
};

/// The spline. A default-constructed one is zero everywhere.
class PeriodicSpline2 {
  public:
    PeriodicSpline2() = default;

    /// spectrum: nx × (ny/2+1), half-complex, row-major, y fastest. It is consumed.
    ///     f(x_i, y_j) = Σ X e^{2πi(ai/nx + bj/ny)}
    /// Lx, Ly: period [m] > 0. pad: the spectrum is padded with zeros to pad·nx × pad·ny first.
    PeriodicSpline2(FftVector<complex32>&& spectrum, int nx, int ny, double Lx = 1, double Ly = 1, int pad = 1);
    /// The same with a shared plan.
    PeriodicSpline2(const SplinePlan2& plan, FftVector<complex32>&& spectrum, double Lx, double Ly);

    /// Value and gradient [1/m].
    struct Sample {
        float value = 0, dx = 0, dy = 0;
    };
    /// Evaluates the spline at any finite position [m].
    Sample sample(double x, double y) const;

    /// Value, gradient and second derivatives [1/m²] in double precision throughout. Rounding does not roughen it.
    struct Jet {
        double value = 0, dx = 0, dy = 0, dxx = 0, dxy = 0, dyy = 0;
    };
    Jet jet(double x, double y) const;

    /// The cells in which the evenly spaced points of a row lie. They are the same for every row of a picture.
    struct Columns {
        std::vector<std::int32_t> cell;
        std::vector<float> t;      ///< offset within the cell, 0 … 1
        int first = 0, count = 0;  ///< range of cells that holds all points
    };
    /// Columns of the points x0 + i step_x, i < n.
    Columns columns(double x0, double step_x, int n) const;
    /// Adds a row of gradients: uv[2i], uv[2i+1] += weight · gradient at (column i, y). Faster than point by point.
    void add_row_gradients(const Columns& columns, double y, float weight, float* uv) const;
    /// Adds a row of values: values[i] += weight · value at (column i, y).
    void add_row_values(const Columns& columns, double y, float weight, float* values) const;

    /// Adds the values along any line: values[i] += weight · value at (x0 + i step_x, y0 + i step_y), i < n.
    void add_values(double x0, double y0, double step_x, double step_y, int n, float weight, float* values) const;

  private:
    struct Line;
    /// The coefficients of the row at y: those of the value, then those of its derivative by cells along y.
    FftVector<float> collapsed(const Columns& columns, double y) const;
    Line line(double x0, double y0, double step_x, double step_y) const;

    int nx_ = 0, ny_ = 0, stride_ = 0;
    double per_x_ = 0, per_y_ = 0;   // cells a metre
    FftVector<float> coefficients_;  // (ny + 4) × (nx + 4), x fastest, wrapped so that no tap needs a modulo
};

}  // namespace eikonal
