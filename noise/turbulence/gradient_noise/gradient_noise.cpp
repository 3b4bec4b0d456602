#include "noise/turbulence/gradient_noise/gradient_noise.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "noise/base/error.h"
#include "noise/math/portable_math.h"
#include "noise/math/random.h"
#include "noise/turbulence/parameters/falloff.h"
#include "noise/turbulence/parameters/spectrum.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {
namespace {

/// ∫Φ d³k = ∫ 4πk³ Φ d ln k from `lowest` [rad/m] to beyond the inner scale, by Simpson's rule.
double spectrum_variance(const TurbulenceSpec& spec, double lowest) {
    const Spectrum spectrum(spec, lowest);
    const double km = kInnerScaleConstant / spec.inner_scale;
    const bool sharp = spec.spectrum == SpectrumKind::Paper;
    const double first = portable::log(sharp ? lowest : 1e-4 * lowest),
                 last = portable::log(sharp ? std::max(km, lowest) : 6 * km);
    constexpr int n = 2000;
    double sum = 0;
    for (int i = 0; i <= n; ++i) {
        const double k = portable::exp(first + (last - first) * i / n);
        sum += (i == 0 || i == n ? 1 : (i % 2 == 1 ? 4 : 2)) * 4 * portable::kPi * k * k * k * spectrum(k * k);
    }
    return sum * (last - first) / (3 * n);
}

/// Rows of a random rotation, uniform over all rotations, from a random unit quaternion.
std::array<dvec3, 3> random_rotation(const RandomStream& stream) {
    double w, x, y, z;
    stream.gaussians(0, w, x);
    stream.gaussians(1, y, z);
    const double norm = std::max(std::sqrt(w * w + x * x + y * y + z * z), 1e-12);
    w /= norm, x /= norm, y /= norm, z /= norm;
    return {dvec3{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
            dvec3{2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
            dvec3{2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
}

/// The cell of one coordinate, the offset within it, and the fade there with its derivatives.
struct Coordinate {
    std::int64_t cell;
    double t, fade, slope, curvature;
};

Coordinate locate(double u) {
    if (!(std::abs(u) < 0x1p52)) u = std::fmod(u, 0x1p52);
    const double whole = std::floor(u), t = u - whole;
    return {static_cast<std::int64_t>(whole), t, t * t * t * (t * (6 * t - 15) + 10), 30 * t * t * (t - 1) * (t - 1),
            60 * t * (t - 1) * (2 * t - 1)};
}

/// N, its gradient [1/cell] and, if `second`, its Hessian [1/cell²] in the first three coordinates.
template <bool second>
IndexJet noise4(const std::array<double, 4>& u, std::uint64_t key) {
    constexpr std::array<std::uint64_t, 4> kPrime{0x9e3779b97f4a7c15ULL, 0xc2b2ae3d27d4eb4fULL, 0x165667b19e3779f9ULL,
                                                  0xd6e8feb86659fd93ULL};
    std::array<Coordinate, 4> c;
    for (std::size_t i = 0; i < 4; ++i) c[i] = locate(u[i]);
    IndexJet sum;
    for (unsigned corner = 0; corner < 16; ++corner) {
        std::array<double, 4> d, w, dw, ddw;
        std::uint64_t h = key;
        for (std::size_t i = 0; i < 4; ++i) {
            const unsigned far = (corner >> i) & 1U;
            h += (static_cast<std::uint64_t>(c[i].cell) + far) * kPrime[i];
            d[i] = c[i].t - far;
            w[i] = far ? c[i].fade : 1 - c[i].fade;
            dw[i] = far ? c[i].slope : -c[i].slope;
            ddw[i] = far ? c[i].curvature : -c[i].curvature;
        }
        // One of 32 gradients: three components are ±1, and the fourth is 0.
        const std::uint64_t bits = mix64(h);
        std::array<double, 4> g;
        for (std::size_t i = 0; i < 4; ++i) g[i] = (bits >> (8 + i)) & 1U ? 1.0 : -1.0;
        g[bits & 3U] = 0;
        const double ramp = (g[0] * d[0] + g[1] * d[1]) + (g[2] * d[2] + g[3] * d[3]);
        const double w01 = w[0] * w[1], w23 = w[2] * w[3], weight = w01 * w23;
        sum.n += weight * ramp;
        sum.gradient.x += weight * g[0] + dw[0] * w[1] * w23 * ramp;
        sum.gradient.y += weight * g[1] + w[0] * dw[1] * w23 * ramp;
        sum.gradient.z += weight * g[2] + w01 * dw[2] * w[3] * ramp;
        if constexpr (second) {
            // The second derivative of weight · ramp. The ramp is linear.
            const dvec3 slope(dw[0] * w[1] * w23, w[0] * dw[1] * w23, w01 * dw[2] * w[3]), ramps(g[0], g[1], g[2]);
            const double xy = dw[0] * dw[1] * w23, xz = dw[0] * w[1] * dw[2] * w[3], yz = w[0] * dw[1] * dw[2] * w[3];
            const glm::dmat3 weights(ddw[0] * w[1] * w23, xy, xz, xy, w[0] * ddw[1] * w23, yz, xz, yz,
                                     w01 * ddw[2] * w[3]);
            sum.hessian += weights * ramp + glm::outerProduct(slope, ramps) + glm::outerProduct(ramps, slope);
        }
    }
    return sum;
}

}  // namespace

GradientNoiseField::GradientNoiseField(const TurbulenceSpec& spec) : velocity_(spec.velocity), falloff_(spec.falloff) {
    double lowest = portable::kTwoPi / spec.outer_scale;
    if (spec.spectrum == SpectrumKind::Paper) {
        if (!(spec.lowest_wavenumber > 0))
            throw UserError(
                "turbulence: lowest_wavenumber is 0; gradient-noise has no period to bound the paper's spectrum; give "
                "it above 0");
        lowest = spec.lowest_wavenumber * portable::kTwoPi / (spec.period ? (*spec.period)[0] : spec.outer_scale);
    }
    variance_ = spectrum_variance(spec, lowest);
    double power = 0;
    for (double s = kLargestCell * portable::kTwoPi / lowest; octaves_.empty() || s >= kSmallestCell * spec.inner_scale;
         s /= 2) {
        const RandomStream stream(spec.seed, "gradient-noise", octaves_.size());
        Octave o;
        o.rows = random_rotation(stream);
        for (dvec3& row : o.rows) row /= s;
        for (std::size_t i = 0; i < 4; ++i) o.offset[i] = 1024 * stream.uniform(2 + i);
        o.amplitude = portable::pow(s, 1.0 / 3);
        o.rate = std::sqrt(1.5 * spec.alpha) / s;
        o.key = stream.bits(6);
        power += o.amplitude * o.amplitude * kGradientNoiseVariance;
        octaves_.push_back(o);
        smallest_cell_ = s;
    }
    for (Octave& o : octaves_) o.amplitude *= std::sqrt(variance_ / power);
}

template <bool second>
IndexJet GradientNoiseField::sum(const dvec3& x, double t) const {
    const dvec3 p = x - velocity_ * t;
    IndexJet sum;
    for (const Octave& o : octaves_) {
        std::array<double, 4> u;
        for (std::size_t i = 0; i < 3; ++i) u[i] = glm::dot(o.rows[i], p) + o.offset[i];
        u[3] = o.rate * t + o.offset[3];
        const IndexJet s = noise4<second>(u, o.key);
        sum.n += o.amplitude * s.n;
        sum.gradient += o.amplitude * (s.gradient.x * o.rows[0] + s.gradient.y * o.rows[1] + s.gradient.z * o.rows[2]);
        if constexpr (second) {
            const glm::dmat3 turn(o.rows[0], o.rows[1], o.rows[2]);  // columns: ∂u_i/∂x
            sum.hessian += o.amplitude * (turn * s.hessian * glm::transpose(turn));
        }
    }
    return sum;
}

IndexSample GradientNoiseField::sample(const dvec3& x, double t) const {
    const IndexJet s = sum<false>(x, t);
    return with_falloff(falloff_, x, IndexSample{s.n, s.gradient});
}

IndexJet GradientNoiseField::jet(const dvec3& x, double t) const {
    return with_falloff(falloff_, x, sum<true>(x, t));
}

}  // namespace eikonal
