#include "noise/periodic_spline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "noise/dispatch.h"
#include "noise/lattice_snapshot.h"

namespace eikonal {
namespace {

using Float4 = float __attribute__((vector_size(16)));

Float4 load(const float* p) {
    Float4 v;
    std::memcpy(&v, p, sizeof v);
    return v;
}

float sum(Float4 v) {
    return (v[0] + v[2]) + (v[1] + v[3]);
}

/// Cubic B-spline weights of the taps -1, 0, 1, 2 at offset t in [0, 1], and their derivatives.
struct Weights {
    Float4 w, d;
};

Weights weights(float t) {
    const float s = 1 - t, t2 = t * t, s2 = s * s;
    constexpr float sixth = 1.0F / 6;
    return {Float4{sixth * (s2 * s), sixth * (4 - 3 * t2 * (2 - t)), sixth * (4 - 3 * s2 * (2 - s)), sixth * (t2 * t)},
            Float4{-0.5F * s2, 0.5F * t * (3 * t - 4), -0.5F * s * (3 * s - 4), 0.5F * t2}};
}

/// x modulo n, in [0, n]; x any finite number.
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
        // |u / size| < 2^31: the start and the step are reduced, the number of points is an int
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

/// Sums over the 4 × 4 taps, of the value and of both derivatives in cells.
EIKONAL_CLONES void gradients_at(const float* coefficients, int stride, const Block& block, int count, float scale_x,
                                 float scale_y, float* uv) {
    for (int i = 0; i < count; ++i) {
        const float* c = coefficients + static_cast<std::ptrdiff_t>(block.cell_x[i]) * stride + block.cell_y[i];
        const Weights x = weights(block.tx[i]), y = weights(block.ty[i]);
        Float4 value = x.w[0] * load(c), slope = x.d[0] * load(c);
        for (int a = 1; a < 4; ++a) {
            const Float4 row = load(c + a * static_cast<std::ptrdiff_t>(stride));
            value += x.w[a] * row;
            slope += x.d[a] * row;
        }
        uv[2 * i] += scale_x * sum(slope * y.w);
        uv[2 * i + 1] += scale_y * sum(value * y.d);
    }
}

/// A row at constant y: the taps along y collapse once into two periodic functions of x, interleaved as (value, ∂/∂v).
EIKONAL_CLONES void collapse_row(const float* coefficients, int stride, int rows, float ty, float* line) {
    const Weights y = weights(ty);
    for (int a = 0; a < rows; ++a) {
        const Float4 c = load(coefficients + static_cast<std::ptrdiff_t>(a) * stride);
        line[2 * a] = sum(c * y.w);
        line[2 * a + 1] = sum(c * y.d);
    }
}

EIKONAL_CLONES void gradients_on_row(const float* line, const std::int32_t* cell, const float* tx, int count,
                                     float scale_x, float scale_y, float* uv) {
    for (int i = 0; i < count; ++i) {
        const float* c = line + 2 * static_cast<std::ptrdiff_t>(cell[i]);
        const float t = tx[i], s = 1 - t, t2 = t * t, s2 = s * s;
        constexpr float sixth = 1.0F / 6;
        const float dx = 0.5F * (t2 * c[6] - s2 * c[0]) + 0.5F * (t * (3 * t - 4) * c[2] - s * (3 * s - 4) * c[4]);
        const float dy =
            (s2 * s * c[1] + (4 - 3 * t2 * (2 - t)) * c[3]) + ((4 - 3 * s2 * (2 - s)) * c[5] + t2 * t * c[7]);
        uv[2 * i] += scale_x * dx;
        uv[2 * i + 1] += scale_y * (sixth * dy);
    }
}

EIKONAL_CLONES void values_at(const float* coefficients, int stride, const Block& block, int count, float scale,
                              float* values) {
    for (int i = 0; i < count; ++i) {
        const float* c = coefficients + static_cast<std::ptrdiff_t>(block.cell_x[i]) * stride + block.cell_y[i];
        const Weights x = weights(block.tx[i]), y = weights(block.ty[i]);
        Float4 value = x.w[0] * load(c);
        for (int a = 1; a < 4; ++a) value += x.w[a] * load(c + a * static_cast<std::ptrdiff_t>(stride));
        values[i] += scale * sum(value * y.w);
    }
}

/// Cubic (four-point Lagrange) between knots `every` points apart; knots[1] is that of point 0. uv interleaved.
EIKONAL_CLONES void add_between_knots(const float* knots, int every, int n, float weight, float* uv) {
    const float inv = 1.0F / static_cast<float>(every);
    for (int first = 0; first < n; first += every, knots += 2) {
        std::array<std::array<float, 4>, 2> p;
        for (int c = 0; c < 2; ++c) {
            const float a = knots[c], b = knots[2 + c], d = knots[4 + c], e = knots[6 + c];
            p[c] = {weight * b, weight * (d - a / 3 - b / 2 - e / 6), weight * ((a + d) / 2 - b),
                    weight * ((b - d) / 2 + (e - a) / 6)};
        }
        const int count = std::min(every, n - first);
        float* out = uv + 2 * static_cast<std::ptrdiff_t>(first);
        for (int i = 0; i < count; ++i) {
            const float t = static_cast<float>(i) * inv;
            out[2 * i] += p[0][0] + t * (p[0][1] + t * (p[0][2] + t * p[0][3]));
            out[2 * i + 1] += p[1][0] + t * (p[1][1] + t * (p[1][2] + t * p[1][3]));
        }
    }
}

/// Multiplies by the prefilter and zero pads; a mode at the unpadded Nyquist is split between both signs.
FftVector<complex32> padded_spectrum(const FftVector<complex32>& in, int nx, int ny, int pad) {
    const int px = nx * pad, py = ny * pad, hy = ny / 2 + 1, phy = py / 2 + 1;
    FftVector<complex32> out(static_cast<std::size_t>(px) * static_cast<std::size_t>(phy));
    for (int a = 0; a < nx; ++a) {
        const bool split_x = nx % 2 == 0 && a == nx / 2;
        for (int b = 0; b < hy; ++b) {
            complex32 v = in[static_cast<std::size_t>(a) * hy + b];
            if (ny % 2 == 0 && b == ny / 2) v *= 0.5F;
            if (split_x) v *= 0.5F;
            const int row = 2 * a > nx ? a - nx + px : a;
            out[static_cast<std::size_t>(row) * phy + b] = v;
            if (split_x) out[static_cast<std::size_t>(px - row) * phy + b] = v;
        }
    }
    return out;
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
    : nx_(plan.nx_ * plan.pad_), ny_(plan.ny_ * plan.pad_), stride_(ny_ + 4), per_x_(nx_ / Lx), per_y_(ny_ / Ly) {
    FftVector<complex32> modes =
        plan.pad_ == 1 ? std::move(spectrum) : padded_spectrum(spectrum, plan.nx_, plan.ny_, plan.pad_);
    const auto half = static_cast<std::size_t>(ny_ / 2 + 1);
    for (std::size_t a = 0; a < static_cast<std::size_t>(nx_); ++a)
        for (std::size_t b = 0; b < half; ++b) modes[a * half + b] *= plan.filter_x_[a] * plan.filter_y_[b];
    FftScratch<float> samples(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_));
    plan.plan_.execute(modes.data(), samples.data());
    modes = {};
    // Row and column 0 hold sample -1; the period is [1, n + 1), followed by three wrapped ones.
    coefficients_.resize(static_cast<std::size_t>(nx_ + 4) * static_cast<std::size_t>(stride_));
    for (int a = 0; a < nx_ + 4; ++a) {
        const float* from = samples.data() + static_cast<std::ptrdiff_t>((a + nx_ - 1) % nx_) * ny_;
        float* to = coefficients_.data() + static_cast<std::ptrdiff_t>(a) * stride_;
        to[0] = from[ny_ - 1];
        std::copy_n(from, ny_, to + 1);
        for (int b = 0; b < 3; ++b) to[ny_ + 1 + b] = from[b % ny_];
    }
}

PeriodicSpline2::Sample PeriodicSpline2::sample(double x, double y) const {
    if (coefficients_.empty()) return {};
    const double u = wrap(std::fmod(x, nx_ / per_x_) * per_x_, nx_), v = wrap(std::fmod(y, ny_ / per_y_) * per_y_, ny_);
    const auto cu = static_cast<std::int32_t>(u), cv = static_cast<std::int32_t>(v);
    const Weights wx = weights(static_cast<float>(u - cu)), wy = weights(static_cast<float>(v - cv));
    const float* c = coefficients_.data() + static_cast<std::ptrdiff_t>(cu) * stride_ + cv;
    Float4 value = wx.w[0] * load(c), slope = wx.d[0] * load(c);
    for (int a = 1; a < 4; ++a) {
        const Float4 row = load(c + a * static_cast<std::ptrdiff_t>(stride_));
        value += wx.w[a] * row;
        slope += wx.d[a] * row;
    }
    return {sum(value * wy.w), static_cast<float>(per_x_) * sum(slope * wy.w),
            static_cast<float>(per_y_) * sum(value * wy.d)};
}

/// A batch's line in cells: start in [0, n], step in [-n/2, n/2].
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

void PeriodicSpline2::add_gradients(double x0, double y0, double step_x, double step_y, int n, float weight,
                                    float* uv) const {
    if (coefficients_.empty()) return;
    const Line l = line(x0, y0, step_x, step_y);
    Block block;
    const float sx = static_cast<float>(per_x_), sy = static_cast<float>(per_y_);
    const double fastest = std::max(std::abs(l.du), std::abs(l.dv));
    if (fastest * 64 <= 1 && n > 16) {
        // Knots at points -every, 0, every, … up to one beyond the last interval's end.
        const int every = static_cast<int>(std::min(0.125 / std::max(fastest, 1e-12), static_cast<double>(n)));
        const int count = (n + every - 1) / every + 3;
        std::vector<float> knots(2 * static_cast<std::size_t>(count));
        const Line coarse{wrap(l.u - l.du * every, nx_), wrap(l.v - l.dv * every, ny_), l.du * every, l.dv * every};
        for (int begin = 0; begin < count; begin += kBlock) {
            const int m = std::min(kBlock, count - begin);
            coarse.locate(*this, begin, m, block);
            gradients_at(coefficients_.data(), stride_, block, m, sx, sy,
                         knots.data() + 2 * static_cast<std::ptrdiff_t>(begin));
        }
        add_between_knots(knots.data(), every, n, weight, uv);
        return;
    }
    if (l.dv == 0 && n >= nx_ / 4) {
        l.locate(*this, 0, 1, block);
        FftScratch<float> row(2 * static_cast<std::size_t>(nx_ + 4));
        collapse_row(coefficients_.data() + block.cell_y[0], stride_, nx_ + 4, block.ty[0], row.data());
        for (int begin = 0; begin < n; begin += kBlock) {
            const int m = std::min(kBlock, n - begin);
            eikonal::locate(l.u, l.du, nx_, 1.0 / nx_, begin, m, block.cell_x.data(), block.tx.data());
            gradients_on_row(row.data(), block.cell_x.data(), block.tx.data(), m, weight * sx, weight * sy,
                             uv + 2 * static_cast<std::ptrdiff_t>(begin));
        }
        return;
    }
    for (int begin = 0; begin < n; begin += kBlock) {
        const int m = std::min(kBlock, n - begin);
        l.locate(*this, begin, m, block);
        gradients_at(coefficients_.data(), stride_, block, m, weight * sx, weight * sy,
                     uv + 2 * static_cast<std::ptrdiff_t>(begin));
    }
}

void PeriodicSpline2::add_values(double x0, double y0, double step_x, double step_y, int n, float weight,
                                 float* values) const {
    if (coefficients_.empty()) return;
    const Line l = line(x0, y0, step_x, step_y);
    Block block;
    for (int begin = 0; begin < n; begin += kBlock) {
        const int m = std::min(kBlock, n - begin);
        l.locate(*this, begin, m, block);
        values_at(coefficients_.data(), stride_, block, m, weight, values + begin);
    }
}

}  // namespace eikonal
