/// A doubly periodic function as a cubic B-spline through its samples: C2, cheap, with its own exact gradient.
///
/// The coefficients come from a half-complex spectrum: each mode is divided by the spline's transform
/// (2 + cos ω)/3 along both axes, then transformed once. Positions are metres, gradients the function's unit per metre,
/// arithmetic float32 behind positions reduced modulo the period in double.
///
/// The spline passes through the samples exactly (to float rounding); between them it deviates from the trigonometric
/// sum. A mode of ω = k·cell [rad a sample] has the relative rms error spline_slope_error(ω/2π) of lattice_snapshot.h
/// in its gradient: 0.04 % at ω = π/8, 0.33 % at π/4, 0.9 % at π/3, 4 % at π/2, 23 % at 3π/4. Padding by p turns ω into
/// ω/p.
///
/// Failures: none but std::bad_alloc. Immutable and thread-safe after construction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "noise/math/fft.h"

namespace eikonal {

/// Transform and prefilter of one lattice shape, to be shared by many splines (planning takes longer than small ones).
class SplinePlan2 {
  public:
    /// nx, ny >= 1: the spectrum's lattice. pad >= 1: its zero padding in both axes.
    SplinePlan2(int nx, int ny, int pad = 1);

  private:
    friend class PeriodicSpline2;
    int nx_, ny_, pad_;
    FftVector<float> filter_x_, filter_y_;  // 3/(2 + cos ω), one a (padded) row and one a column
    FftPlan plan_;
};

/// The spline. Default-constructed: zero everywhere.
class PeriodicSpline2 {
  public:
    PeriodicSpline2() = default;

    /// spectrum: nx × (ny/2+1), half-complex, row-major, y fastest, f(x_i, y_j) = Σ X e^{2πi(ai/nx + bj/ny)}; consumed.
    /// Lx, Ly: period [m] > 0. pad: the spectrum is zero padded to pad·nx × pad·ny first.
    PeriodicSpline2(FftVector<complex32>&& spectrum, int nx, int ny, double Lx = 1, double Ly = 1, int pad = 1);
    /// The same with a shared plan of shape nx × ny.
    PeriodicSpline2(const SplinePlan2& plan, FftVector<complex32>&& spectrum, double Lx, double Ly);

    /// Value and gradient [1/m].
    struct Sample {
        float value = 0, dx = 0, dy = 0;
    };
    /// At any finite position [m].
    Sample sample(double x, double y) const;

    /// With the second derivatives [1/m²], in double precision throughout: as smooth as the spline is.
    struct Jet {
        double value = 0, dx = 0, dy = 0, dxx = 0, dxy = 0, dyy = 0;
    };
    Jet jet(double x, double y) const;

    /// Where evenly spaced points of a row lie among the cells: the same for every row of a picture, so found once.
    struct Columns {
        std::vector<std::int32_t> cell;
        std::vector<float> t;      ///< place within the cell, 0 … 1
        int first = 0, count = 0;  ///< the cells among which they are
    };
    /// Points at x0 + i step_x, i < n.
    Columns columns(double x0, double step_x, int n) const;
    /// uv[2i], uv[2i+1] += weight · gradient at (column i, y). The fast way through whole rows.
    void add_row_gradients(const Columns& columns, double y, float weight, float* uv) const;
    /// values[i] += weight · value at (column i, y).
    void add_row_values(const Columns& columns, double y, float weight, float* values) const;

    /// values[i] += weight · value at (x0 + i step_x, y0 + i step_y), i < n: any line.
    void add_values(double x0, double y0, double step_x, double step_y, int n, float weight, float* values) const;

  private:
    struct Line;
    /// The taps along y collapsed at one y: the value for each coefficient along x, then ∂/∂v.
    FftVector<float> collapsed(const Columns& columns, double y) const;
    Line line(double x0, double y0, double step_x, double step_y) const;

    int nx_ = 0, ny_ = 0, stride_ = 0;
    double per_x_ = 0, per_y_ = 0;   // cells a metre
    FftVector<float> coefficients_;  // (ny + 4) × (nx + 4), x fastest; wrapped, so that no tap needs a modulo
};

}  // namespace eikonal
