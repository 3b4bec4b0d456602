#include "noise/math/periodic_spline3.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "noise/base/instruction_sets.h"
#include "noise/math/cubic_taps.h"
#include "noise/math/fourier_bins.h"
#include "noise/math/portable_math.h"

namespace eikonal {
namespace {

constexpr int kAliases = 6;  ///< on each side. The next one changes the error by less than 1e-6.

/// Calls action(m, weight) for the mode (m = 0) and its aliases in the spline. The weights sum to 1.
template <class Action>
void for_each_alias(double turns, Action&& action) {
    const auto weight = [&](int m) { return 1 / ((turns + m) * (turns + m) * (turns + m) * (turns + m)); };
    double sum = 0;
    for (int m = -kAliases; m <= kAliases; ++m) sum += weight(m);
    for (int m = -kAliases; m <= kAliases; ++m) action(m, weight(m) / sum);
}

/// The bins of a finer axis that take a bin of a coarser one, and the factor of each.
struct Targets {
    int count;
    std::array<int, 2> bin;
    float factor;
};
Targets targets(int i, int n, int finer) {
    const int m = signed_index(i, n);
    if (is_nyquist(i, n) && finer > n) return {2, {m, finer - m}, 0.5F};
    return {1, {m < 0 ? m + finer : m, 0}, 1.0F};
}

constexpr int kWrap = 3;  ///< samples -1, n and n + 1 are stored beside a period's own, so that no tap needs a modulo

/// A spline's coefficients: `size` cells, z fastest, wrapped by kWrap.
struct Coefficients {
    const float* data;
    std::array<int, 3> size;

    /// Value and gradient [per period], and the Hessian if `second`.
    template <bool second>
    [[gnu::always_inline]] IndexJet evaluate(const dvec3& x) const {
        const PeriodicTaps<double> bx = periodic_taps<double>(x.x, size[0]), by = periodic_taps<double>(x.y, size[1]),
                                   bz = periodic_taps<double>(x.z, size[2]);
        const std::size_t row = static_cast<std::size_t>(size[2]) + kWrap,
                          plane = (static_cast<std::size_t>(size[1]) + kWrap) * row;
        const float* corner = data + bx.first * plane + by.first * row + bz.first;
        Double4 value{}, x1{}, y1{}, xx{}, xy{}, yy{};  // not yet weighed along z
        for (std::size_t i = 0; i < 4; ++i, corner += plane) {
            Double4 v{}, s{}, q{};
            for (std::size_t j = 0; j < 4; ++j) {
                const Double4 c = load_double4(corner + j * row);
                v += by.taps.weight[j] * c;
                s += by.taps.slope[j] * c;
                if constexpr (second) q += by.taps.curvature[j] * c;
            }
            value += bx.taps.weight[i] * v;
            x1 += bx.taps.slope[i] * v;
            y1 += bx.taps.weight[i] * s;
            if constexpr (second) {
                xx += bx.taps.curvature[i] * v;
                xy += bx.taps.slope[i] * s;
                yy += bx.taps.weight[i] * q;
            }
        }
        const double nx = size[0], ny = size[1], nz = size[2];
        IndexJet jet{dot4(value, bz.taps.weight),
                     {nx * dot4(x1, bz.taps.weight), ny * dot4(y1, bz.taps.weight), nz * dot4(value, bz.taps.slope)},
                     glm::dmat3(0)};
        if constexpr (second) {
            jet.hessian[0][0] = nx * nx * dot4(xx, bz.taps.weight);
            jet.hessian[1][1] = ny * ny * dot4(yy, bz.taps.weight);
            jet.hessian[2][2] = nz * nz * dot4(value, bz.taps.curvature);
            jet.hessian[0][1] = jet.hessian[1][0] = nx * ny * dot4(xy, bz.taps.weight);
            jet.hessian[0][2] = jet.hessian[2][0] = nx * nz * dot4(x1, bz.taps.slope);
            jet.hessian[1][2] = jet.hessian[2][1] = ny * nz * dot4(y1, bz.taps.slope);
        }
        return jet;
    }
};

/// The least and the largest of n > 0 values.
EIKONAL_CLONES std::pair<float, float> bounds(const float* v, std::size_t n) {
    constexpr std::size_t kLanes = 16;
    std::array<float, kLanes> low, high;
    low.fill(v[0]);
    high.fill(v[0]);
    std::size_t i = 0;
    for (; i + kLanes <= n; i += kLanes)
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            low[lane] = v[i + lane] < low[lane] ? v[i + lane] : low[lane];
            high[lane] = v[i + lane] > high[lane] ? v[i + lane] : high[lane];
        }
    for (; i < n; ++i) {
        low[0] = std::min(low[0], v[i]);
        high[0] = std::max(high[0], v[i]);
    }
    return {*std::min_element(low.begin(), low.end()), *std::max_element(high.begin(), high.end())};
}

}  // namespace

double spline_transfer(double turns) {
    double s, c;
    portable::sincos_turns(turns, s, c);
    return (2 + c) / 3;
}

double spline_error(double turns) {
    if (turns == 0) return 0;
    double sum = 0;
    for_each_alias(turns, [&](int m, double w) { sum += m == 0 ? (1 - w) * (1 - w) : w * w; });
    return std::sqrt(sum);
}

double spline_slope_error(double turns) {
    if (turns == 0) return 0;
    double sum = 0;
    for_each_alias(turns, [&](int m, double w) {
        const double slope = m == 0 ? 1 - w : w * (turns + m) / turns;
        sum += slope * slope;
    });
    return std::sqrt(sum);
}

FftVector<complex32> pad_spectrum(const FftVector<complex32>& spectrum, const std::array<int, 3>& size,
                                  const std::array<int, 3>& finer) {
    if (finer == size) return spectrum;
    const auto half = static_cast<std::size_t>(size[2] / 2 + 1),
               finer_half = static_cast<std::size_t>(finer[2] / 2 + 1);
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(x) * static_cast<std::size_t>(finer[1]) + static_cast<std::size_t>(y);
    };
    FftVector<complex32> out(at(finer[0], 0) * finer_half);
    const bool split = is_nyquist(size[2] / 2, size[2]) && finer[2] > size[2];
    for (int ix = 0; ix < size[0]; ++ix) {
        const Targets tx = targets(ix, size[0], finer[0]);
        for (int iy = 0; iy < size[1]; ++iy) {
            const Targets ty = targets(iy, size[1], finer[1]);
            const complex32* from =
                spectrum.data() +
                (static_cast<std::size_t>(ix) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(iy)) *
                    half;
            const float factor = tx.factor * ty.factor;
            for (int a = 0; a < tx.count; ++a)
                for (int b = 0; b < ty.count; ++b) {
                    complex32* to = out.data() + at(tx.bin[a], ty.bin[b]) * finer_half;
                    for (std::size_t z = 0; z < half; ++z) to[z] = from[z] * factor;
                    if (split) to[half - 1] *= 0.5F;
                }
        }
    }
    return out;
}

PeriodicSpline3::PeriodicSpline3(FftVector<complex32> spectrum, const std::array<int, 3>& size, const Padding& padding)
    : size_{size[0] * padding[0], size[1] * padding[1], size[2] * padding[2]} {
    // The prefilter comes before the padding: zeros need none.
    std::array<std::vector<float>, 3> inverse;
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < size[axis]; ++i) {
            const int bin = targets(i, size[axis], size_[axis]).bin[0];
            inverse[axis].push_back(static_cast<float>(1 / spline_transfer(static_cast<double>(bin) / size_[axis])));
        }
    const auto half = static_cast<std::size_t>(size[2] / 2 + 1);
    tbb::parallel_for(0, size[0], [&](int ix) {
        complex32* row = spectrum.data() + static_cast<std::size_t>(ix) * static_cast<std::size_t>(size[1]) * half;
        for (int iy = 0; iy < size[1]; ++iy, row += half) {
            const float xy = inverse[0][static_cast<std::size_t>(ix)] * inverse[1][static_cast<std::size_t>(iy)];
            for (std::size_t z = 0; z < half; ++z) row[z] *= xy * inverse[2][z];
        }
    });
    spectrum = pad_spectrum(spectrum, size, size_);
    const FftPlan plan(FftPlan::Kind::ComplexToReal, size_);
    FftScratch<float> samples(plan.sample_size());
    plan.execute(spectrum.data(), samples.data());
    std::tie(lower_, upper_) = bounds(samples.data(), samples.size());
    const auto nx = static_cast<std::size_t>(size_[0]), ny = static_cast<std::size_t>(size_[1]),
               nz = static_cast<std::size_t>(size_[2]);
    coefficients_.resize((nx + kWrap) * (ny + kWrap) * (nz + kWrap));
    tbb::parallel_for(std::size_t{0}, nx + kWrap, [&](std::size_t i) {
        for (std::size_t j = 0; j < ny + kWrap; ++j) {
            const float* from = samples.data() + (((i + nx - 1) % nx) * ny + (j + ny - 1) % ny) * nz;
            float* to = coefficients_.data() + (i * (ny + kWrap) + j) * (nz + kWrap);
            to[0] = from[nz - 1];
            std::copy_n(from, nz, to + 1);
            to[nz + 1] = from[0];
            to[nz + 2] = from[1 % nz];
        }
    });
}

EIKONAL_CLONES PeriodicSpline3::Sample PeriodicSpline3::sample(const dvec3& x) const {
    const PeriodicTaps<float> bx = periodic_taps<float>(x.x, size_[0]), by = periodic_taps<float>(x.y, size_[1]),
                              bz = periodic_taps<float>(x.z, size_[2]);
    const std::size_t row = static_cast<std::size_t>(size_[2]) + kWrap,
                      plane = (static_cast<std::size_t>(size_[1]) + kWrap) * row;
    const float* corner = coefficients_.data() + bx.first * plane + by.first * row + bz.first;
    Float4 value{}, slope_x{}, slope_y{};  // not yet weighed along z
    for (std::size_t i = 0; i < 4; ++i, corner += plane) {
        Float4 v{}, s{};
        for (std::size_t j = 0; j < 4; ++j) {
            const Float4 c = load_float4(corner + j * row);
            v += by.taps.weight[j] * c;
            s += by.taps.slope[j] * c;
        }
        value += bx.taps.weight[i] * v;
        slope_x += bx.taps.slope[i] * v;
        slope_y += bx.taps.weight[i] * s;
    }
    const double nx = size_[0], ny = size_[1], nz = size_[2];
    return {dot4(value, bz.taps.weight),
            {nx * dot4(slope_x, bz.taps.weight), ny * dot4(slope_y, bz.taps.weight), nz * dot4(value, bz.taps.slope)}};
}

EIKONAL_CLONES IndexSample PeriodicSpline3::smooth_sample(const dvec3& x) const {
    const IndexJet jet = Coefficients{coefficients_.data(), size_}.evaluate<false>(x);
    return {jet.n, jet.gradient};
}

EIKONAL_CLONES IndexJet PeriodicSpline3::jet(const dvec3& x) const {
    return Coefficients{coefficients_.data(), size_}.evaluate<true>(x);
}

}  // namespace eikonal
