#include "noise/math/periodic_spline2.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "noise/base/instruction_sets.h"
#include "noise/math/cubic_taps.h"
#include "noise/math/periodic_spline3.h"

namespace eikonal {
namespace {

/// x modulo n, in [0, n], for any finite x.
double wrap(double x, double n) {
    if (std::abs(x) > 1e9 * n) x = std::fmod(x, n);
    const double r = x - n * std::floor(x / n);
    return std::clamp(r, 0.0, n);
}

constexpr int kBlock = 64;

/// Cells and offsets of up to kBlock points of a line.
struct Block {
    std::array<std::int32_t, kBlock> cell_x, cell_y;
    std::array<float, kBlock> tx, ty;
};

EIKONAL_CLONES void locate(double first, double step, double size, double inv_size, int begin, int count,
                           std::int32_t* cell, float* t) {
    for (int i = 0; i < count; ++i) {
        const double u = first + static_cast<double>(begin + i) * step;
        // |u / size| < 2^31, since start and step are reduced and the number of points is an int.
        const double turns = u * inv_size;
        double whole = static_cast<double>(static_cast<std::int32_t>(turns));
        whole -= turns < whole ? 1.0 : 0.0;
        double r = u - whole * size;
        r = r < 0 ? 0 : (r > size ? size : r);
        const auto c = static_cast<std::int32_t>(r);
        cell[i] = c;
        t[i] = static_cast<float>(r - static_cast<double>(c));
    }
}

/// Weighs the coefficients of four rows by the taps along y. The result is two periodic functions of x: the value, and
/// its derivative along y.
EIKONAL_CLONES void collapse_row(const float* coefficients, int stride, int count, float ty, float* value,
                                 float* slope) {
    const FactoredCubicTaps y(ty);
    const float *c0 = coefficients, *c1 = c0 + stride, *c2 = c1 + stride, *c3 = c2 + stride;
    const float w0 = y.weight[0], w1 = y.weight[1], w2 = y.weight[2], w3 = y.weight[3];
    const float d0 = y.slope[0], d1 = y.slope[1], d2 = y.slope[2], d3 = y.slope[3];
    for (int a = 0; a < count; ++a) {
        value[a] = (w0 * c0[a] + w1 * c1[a]) + (w2 * c2[a] + w3 * c3[a]);
        slope[a] = (d0 * c0[a] + d1 * c1[a]) + (d2 * c2[a] + d3 * c3[a]);
    }
}

/// The gradient in one cell of a row, as polynomials in the offset t:
///     ∂/∂u = a0 + a1 t + a2 t²,   ∂/∂v = b0 + b1 t + b2 t² + b3 t³
struct GradientCell {
    Float4 low;   ///< a0, b0, a1, b1
    Float4 high;  ///< a2, b2, 0, b3
};

/// Transposes the 4 × 4 matrix of rows a, b, c, d.
void transpose(Float4& a, Float4& b, Float4& c, Float4& d) {
    const Float4 ab_low = __builtin_shufflevector(a, b, 0, 4, 1, 5),
                 ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    const Float4 cd_low = __builtin_shufflevector(c, d, 0, 4, 1, 5),
                 cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    a = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
    b = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
    c = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
    d = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}

constexpr int kCellsAtOnce = 4;
int whole_cells(int cells) {
    return (cells + kCellsAtOnce - 1) / kCellsAtOnce * kCellsAtOnce;
}

/// value and slope must have whole_cells(cells) + 3 readable numbers. out must have room for whole_cells(cells).
EIKONAL_CLONES void gradient_cells(const float* value, const float* slope, int cells, float scale_x, float scale_y,
                                   GradientCell* out) {
    constexpr float sixth = 1.0F / 6;
    for (int i = 0; i < cells; i += kCellsAtOnce) {
        const Float4 v0 = load_float4(value + i), v1 = load_float4(value + i + 1), v2 = load_float4(value + i + 2),
                     v3 = load_float4(value + i + 3);
        const Float4 s0 = load_float4(slope + i), s1 = load_float4(slope + i + 1), s2 = load_float4(slope + i + 2),
                     s3 = load_float4(slope + i + 3);
        Float4 a0 = scale_x * (0.5F * (v2 - v0)), a1 = scale_x * ((v0 - v1) + (v2 - v1));
        Float4 a2 = scale_x * (0.5F * ((v3 - v0) + 3 * (v1 - v2))), none{};
        Float4 b0 = scale_y * (sixth * (s0 + 4 * s1 + s2)), b1 = scale_y * (0.5F * (s2 - s0));
        Float4 b2 = scale_y * (0.5F * ((s0 - s1) + (s2 - s1))), b3 = scale_y * (sixth * ((s3 - s0) + 3 * (s1 - s2)));
        transpose(a0, b0, a1, b1);
        transpose(a2, b2, none, b3);
        out[i] = {a0, a2};
        out[i + 1] = {b0, b2};
        out[i + 2] = {a1, none};
        out[i + 3] = {b1, b3};
    }
}

EIKONAL_CLONES void gradients_on_row(const GradientCell* cells, const std::int32_t* cell, const float* tx, int count,
                                     float* uv) {
    for (int i = 0; i < count; ++i) {
        const float t = tx[i];
        const GradientCell& c = cells[cell[i]];
        const Float4 q = c.low + (t * t) * c.high;
        uv[2 * i] += q[0] + t * q[2];
        uv[2 * i + 1] += q[1] + t * q[3];
    }
}

/// The value in each cell, as the four coefficients of a cubic.
EIKONAL_CLONES void value_cells(const float* value, int cells, float scale, Float4* out) {
    for (int i = 0; i < cells; ++i) {
        const float c0 = value[i], c1 = value[i + 1], c2 = value[i + 2], c3 = value[i + 3];
        constexpr float sixth = 1.0F / 6;
        out[i] = Float4{scale * (sixth * (c0 + 4 * c1 + c2)), scale * (0.5F * (c2 - c0)),
                        scale * (0.5F * ((c0 - c1) + (c2 - c1))), scale * (sixth * ((c3 - c0) + 3 * (c1 - c2)))};
    }
}

EIKONAL_CLONES void values_on_row(const Float4* cells, const std::int32_t* cell, const float* tx, int count,
                                  float* values) {
    for (int i = 0; i < count; ++i) {
        const Float4 c = cells[cell[i]];
        const float t = tx[i];
        values[i] += c[0] + t * (c[1] + t * (c[2] + t * c[3]));
    }
}

EIKONAL_CLONES void values_at(const float* coefficients, int stride, const Block& block, int count, float scale,
                              float* values) {
    for (int i = 0; i < count; ++i) {
        const float* c = coefficients + static_cast<std::ptrdiff_t>(block.cell_y[i]) * stride + block.cell_x[i];
        const FactoredCubicTaps x(block.tx[i]), y(block.ty[i]);
        Float4 value = y.weight[0] * load_float4(c);
        for (int b = 1; b < 4; ++b) value += y.weight[b] * load_float4(c + b * static_cast<std::ptrdiff_t>(stride));
        values[i] += scale * dot4(value, x.weight);
    }
}

FftVector<float> prefilter(int n) {
    FftVector<float> f(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) {
        f[static_cast<std::size_t>(i)] = static_cast<float>(1 / spline_transfer(static_cast<double>(i) / n));
    }
    return f;
}

}  // namespace

SplinePlan2::SplinePlan2(int nx, int ny, int pad)
    : nx_(nx),
      ny_(ny),
      pad_(pad),
      filter_x_(prefilter(nx * pad)),
      filter_y_(prefilter(ny * pad)),
      plan_(FftPlan::Kind::ComplexToReal, std::array{nx * pad, ny * pad}) {}

PeriodicSpline2::PeriodicSpline2(FftVector<complex32>&& spectrum, int nx, int ny, double Lx, double Ly, int pad)
    : PeriodicSpline2(SplinePlan2(nx, ny, pad), std::move(spectrum), Lx, Ly) {}

PeriodicSpline2::PeriodicSpline2(const SplinePlan2& plan, FftVector<complex32>&& spectrum, double Lx, double Ly)
    : nx_(plan.nx_ * plan.pad_), ny_(plan.ny_ * plan.pad_), stride_(nx_ + 4), per_x_(nx_ / Lx), per_y_(ny_ / Ly) {
    FftVector<complex32> modes =
        plan.pad_ == 1 ? std::move(spectrum) : pad_spectrum(spectrum, {1, plan.nx_, plan.ny_}, {1, nx_, ny_});
    const auto half = static_cast<std::size_t>(ny_ / 2 + 1);
    for (std::size_t a = 0; a < static_cast<std::size_t>(nx_); ++a)
        for (std::size_t b = 0; b < half; ++b) modes[a * half + b] *= plan.filter_x_[a] * plan.filter_y_[b];
    FftScratch<float> samples(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_));
    plan.plan_.execute(modes.data(), samples.data());
    modes = {};
    // The coefficients are transposed: x is the fastest, so that whole rows are read in order. Row and column 0 hold
    // sample -1. The period [1, n + 1) follows, and three wrapped samples.
    coefficients_.resize(static_cast<std::size_t>(ny_ + 4) * static_cast<std::size_t>(stride_));
    constexpr int kTile = 16;
    for (int b0 = 0; b0 < ny_; b0 += kTile)
        for (int a = 0; a < nx_; ++a) {
            const float* from = samples.data() + static_cast<std::ptrdiff_t>(a) * ny_;
            float* to = coefficients_.data() + a + 1;
            for (int b = b0; b < std::min(b0 + kTile, ny_); ++b)
                to[static_cast<std::ptrdiff_t>(b + 1) * stride_] = from[b];
        }
    for (int b = 1; b <= ny_; ++b) {
        float* row = coefficients_.data() + static_cast<std::ptrdiff_t>(b) * stride_;
        row[0] = row[nx_];
        for (int a = 0; a < 3; ++a) row[nx_ + 1 + a] = row[1 + a % nx_];
    }
    const auto copy_row = [&](int from, int to) {
        std::copy_n(coefficients_.data() + static_cast<std::ptrdiff_t>(from) * stride_, stride_,
                    coefficients_.data() + static_cast<std::ptrdiff_t>(to) * stride_);
    };
    copy_row(ny_, 0);
    for (int b = 0; b < 3; ++b) copy_row(1 + b % ny_, ny_ + 1 + b);
}

PeriodicSpline2::Sample PeriodicSpline2::sample(double x, double y) const {
    if (coefficients_.empty()) return {};
    const double u = wrap(std::fmod(x, nx_ / per_x_) * per_x_, nx_), v = wrap(std::fmod(y, ny_ / per_y_) * per_y_, ny_);
    const auto cu = static_cast<std::int32_t>(u), cv = static_cast<std::int32_t>(v);
    const FactoredCubicTaps wx(static_cast<float>(u - cu)), wy(static_cast<float>(v - cv));
    const float* c = coefficients_.data() + static_cast<std::ptrdiff_t>(cv) * stride_ + cu;
    Float4 value = wy.weight[0] * load_float4(c), slope = wy.slope[0] * load_float4(c);
    for (int b = 1; b < 4; ++b) {
        const Float4 row = load_float4(c + b * static_cast<std::ptrdiff_t>(stride_));
        value += wy.weight[b] * row;
        slope += wy.slope[b] * row;
    }
    return {dot4(value, wx.weight), static_cast<float>(per_x_) * dot4(value, wx.slope),
            static_cast<float>(per_y_) * dot4(slope, wx.weight)};
}

PeriodicSpline2::Jet PeriodicSpline2::jet(double x, double y) const {
    if (coefficients_.empty()) return {};
    const double u = wrap(std::fmod(x, nx_ / per_x_) * per_x_, nx_), v = wrap(std::fmod(y, ny_ / per_y_) * per_y_, ny_);
    const auto cu = static_cast<std::int32_t>(u), cv = static_cast<std::int32_t>(v);
    const CubicTaps<double> tx(u - cu), ty(v - cv);
    const float* c = coefficients_.data() + static_cast<std::ptrdiff_t>(cv) * stride_ + cu;
    Double4 value{}, slope{}, curvature{};
    for (int b = 0; b < 4; ++b, c += stride_) {
        const Double4 row = load_double4(c);
        value += ty.weight[b] * row;
        slope += ty.slope[b] * row;
        curvature += ty.curvature[b] * row;
    }
    return {dot4(value, tx.weight),
            per_x_ * dot4(value, tx.slope),
            per_y_ * dot4(slope, tx.weight),
            per_x_ * per_x_ * dot4(value, tx.curvature),
            per_x_ * per_y_ * dot4(slope, tx.slope),
            per_y_ * per_y_ * dot4(curvature, tx.weight)};
}

/// A line of points in units of cells: start in [0, n], step in [-n/2, n/2].
struct PeriodicSpline2::Line {
    double u, v, du, dv;

    void locate(const PeriodicSpline2& f, int begin, int count, Block& block) const {
        eikonal::locate(u, du, f.nx_, 1.0 / f.nx_, begin, count, block.cell_x.data(), block.tx.data());
        eikonal::locate(v, dv, f.ny_, 1.0 / f.ny_, begin, count, block.cell_y.data(), block.ty.data());
    }
};

PeriodicSpline2::Line PeriodicSpline2::line(double x0, double y0, double step_x, double step_y) const {
    const double Lx = nx_ / per_x_, Ly = ny_ / per_y_;
    return {wrap(std::fmod(x0, Lx) * per_x_, nx_), wrap(std::fmod(y0, Ly) * per_y_, ny_),
            std::remainder(step_x, Lx) * per_x_, std::remainder(step_y, Ly) * per_y_};
}

PeriodicSpline2::Columns PeriodicSpline2::columns(double x0, double step_x, int n) const {
    Columns result{std::vector<std::int32_t>(static_cast<std::size_t>(n)),
                   std::vector<float>(static_cast<std::size_t>(n)), 0, 0};
    if (coefficients_.empty()) return result;
    const Line l = line(x0, 0, step_x, 0);
    locate(l.u, l.du, nx_, 1.0 / nx_, 0, n, result.cell.data(), result.t.data());
    if (n == 0) return result;
    const auto [low, high] = std::minmax_element(result.cell.begin(), result.cell.end());
    result.first = *low;
    result.count = *high - *low + 1;
    for (std::int32_t& cell : result.cell) cell -= result.first;
    return result;
}

FftVector<float> PeriodicSpline2::collapsed(const Columns& columns, double y) const {
    const double v = wrap(std::fmod(y, ny_ / per_y_) * per_y_, ny_);
    const auto cell = static_cast<std::int32_t>(v);
    const int n = columns.count + 3, room = whole_cells(columns.count) + 3;
    FftVector<float> row(2 * static_cast<std::size_t>(room));
    collapse_row(coefficients_.data() + static_cast<std::ptrdiff_t>(cell) * stride_ + columns.first, stride_, n,
                 static_cast<float>(v - cell), row.data(), row.data() + room);
    return row;
}

void PeriodicSpline2::add_row_gradients(const Columns& columns, double y, float weight, float* uv) const {
    if (coefficients_.empty() || columns.count == 0) return;
    const FftVector<float> row = collapsed(columns, y);
    FftScratch<GradientCell> cells(static_cast<std::size_t>(whole_cells(columns.count)));
    gradient_cells(row.data(), row.data() + row.size() / 2, columns.count, weight * static_cast<float>(per_x_),
                   weight * static_cast<float>(per_y_), cells.data());
    gradients_on_row(cells.data(), columns.cell.data(), columns.t.data(), static_cast<int>(columns.cell.size()), uv);
}

void PeriodicSpline2::add_row_values(const Columns& columns, double y, float weight, float* values) const {
    if (coefficients_.empty() || columns.count == 0) return;
    const FftVector<float> row = collapsed(columns, y);
    FftScratch<Float4> cells(static_cast<std::size_t>(columns.count));
    value_cells(row.data(), columns.count, weight, cells.data());
    values_on_row(cells.data(), columns.cell.data(), columns.t.data(), static_cast<int>(columns.cell.size()), values);
}

void PeriodicSpline2::add_values(double x0, double y0, double step_x, double step_y, int n, float weight,
                                 float* values) const {
    if (coefficients_.empty()) return;
    if (step_y == 0 && n >= nx_ / 4) return add_row_values(columns(x0, step_x, n), y0, weight, values);
    const Line l = line(x0, y0, step_x, step_y);
    Block block;
    for (int begin = 0; begin < n; begin += kBlock) {
        const int m = std::min(kBlock, n - begin);
        l.locate(*this, begin, m, block);
        values_at(coefficients_.data(), stride_, block, m, weight, values + begin);
    }
}

}  // namespace eikonal
