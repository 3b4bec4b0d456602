#include "noise/turbulence/screens/screen_band.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "noise/base/instruction_sets.h"
#include "noise/math/bessel.h"
#include "noise/math/portable_math.h"
#include "noise/math/random.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {
namespace {

/// Box-Muller by tables: a complex Gaussian with E|z|² = 1 from 22 random bits.
struct GaussianTables {
    static constexpr int kRadii = 4096, kAngles = 1024;
    std::array<float, kRadii> radius;
    std::array<float, kAngles> cosine, sine;

    GaussianTables() {
        double mean = 0;
        std::array<double, kRadii> r2;
        for (int i = 0; i < kRadii; ++i) mean += r2[i] = -portable::log((i + 0.5) / kRadii);
        mean /= kRadii;
        for (int i = 0; i < kRadii; ++i) radius[i] = static_cast<float>(std::sqrt(r2[i] / mean));
        for (int i = 0; i < kAngles; ++i) {
            double s, c;
            portable::sincos_turns((i + 0.5) / kAngles, s, c);
            cosine[i] = static_cast<float>(c);
            sine[i] = static_cast<float>(s);
        }
    }
};

const GaussianTables& gaussian_tables() {
    static const GaussianTables tables;
    return tables;
}

/// The random bits of state j of a mode.
inline std::uint32_t hash(std::uint32_t j, std::uint32_t key_a, std::uint32_t key_b) {
    std::uint32_t h = j * 0x9e3779b9U + key_a;
    h = (h ^ (h >> 16)) * 0x21f0aaadU;
    h = ((h ^ (h >> 15)) + key_b) * 0x735a2d97U;
    return h ^ (h >> 15);
}

// The kernel at a tap d knots from the current one is exp(-(kKnotSpacing (f - d))²/2), which is proportional to
// q^d exp(-(kKnotSpacing d)²/2) with q = exp(kKnotSpacing² f). The common factor cancels in the normalisation.
constexpr int kFirstTap = -3, kLastTap = 4;
static_assert(kLastTap - kFirstTap + 1 == kKernelTaps);
static_assert(kKnotSpacing == 1.25);
constexpr std::array<float, kKernelTaps> kTapWeight{8.83826307e-4F, 4.39369336e-2F, 4.57833362e-1F, 1.0F,
                                                    4.57833362e-1F, 4.39369336e-2F, 8.83826307e-4F, 3.72665317e-6F};

/// exp(kKnotSpacing² f) for 0 <= f < 1 to 1e-6, by Taylor's series about 1/2.
inline float kernel_ratio(float f) {
    const float x = 1.5625F * (f - 0.5F);
    float p = 1.0F / 40320;
    p = p * x + 1.0F / 5040;
    p = p * x + 1.0F / 720;
    p = p * x + 1.0F / 120;
    p = p * x + 1.0F / 24;
    p = p * x + 1.0F / 6;
    p = p * x + 0.5F;
    p = p * x + 1.0F;
    p = p * x + 1.0F;
    return 2.18420810F * p;  // e^0.78125
}

/// The amplitudes of modes at phase tau = t/T in [0, 1). The result is right where states[i] >= kKernelTaps. All other
/// modes need evolve_slowly.
EIKONAL_CLONES void evolve(const float* __restrict amplitude, const std::int32_t* __restrict states,
                           const std::uint32_t* __restrict key_a, const std::uint32_t* __restrict key_b, int n,
                           double tau, const float* __restrict radius, const float* __restrict cosine,
                           const float* __restrict sine, float* __restrict re_out, float* __restrict im_out) {
    for (int i = 0; i < n; ++i) {
        const std::int32_t m = states[i];
        const double p = tau * static_cast<double>(m);
        const auto j0 = static_cast<std::int32_t>(p);
        const float q = kernel_ratio(static_cast<float>(p - static_cast<double>(j0)));
        const float q2 = q * q;
        float re = 0, im = 0, power = 0;
#pragma GCC unroll 8
        for (int tap = kKernelTaps - 1; tap >= 0; --tap) {
            std::int32_t j = j0 + (tap + kFirstTap);
            j += j < 0 ? m : 0;
            j -= j >= m ? m : 0;
            const std::uint32_t h = hash(static_cast<std::uint32_t>(j), key_a[i], key_b[i]);
            const float w = kTapWeight[static_cast<std::size_t>(tap)];
            const float r = w * radius[h >> 20];
            re = re * q + r * cosine[(h >> 10) & 1023U];
            im = im * q + r * sine[(h >> 10) & 1023U];
            power = power * q2 + w * w;
        }
        const float scale = amplitude[i] / std::sqrt(power);
        re_out[i] = scale * re;
        im_out[i] = scale * im;
    }
}

/// The amplitude of a mode with fewer states than taps. Taps that fall on the same state are added first.
complex32 evolve_slowly(float amplitude, std::int32_t m, std::uint32_t key_a, std::uint32_t key_b, double tau) {
    const GaussianTables& tables = gaussian_tables();
    const double p = tau * m;
    const auto j0 = static_cast<std::int32_t>(p);
    const float q = kernel_ratio(static_cast<float>(p - j0));
    std::array<float, kKernelTaps> weight{};
    float ratio = 1 / (q * q * q);
    for (int tap = 0; tap < kKernelTaps; ++tap, ratio *= q)
        weight[static_cast<std::size_t>((j0 + tap + kFirstTap + 4 * m) % m)] +=
            kTapWeight[static_cast<std::size_t>(tap)] * ratio;
    float re = 0, im = 0, power = 0;
    for (std::int32_t j = 0; j < m; ++j) {
        const std::uint32_t h = hash(static_cast<std::uint32_t>(j), key_a, key_b);
        const float w = weight[static_cast<std::size_t>(j)], r = w * tables.radius[h >> 20];
        re += r * tables.cosine[(h >> 10) & 1023U];
        im += r * tables.sine[(h >> 10) & 1023U];
        power += w * w;
    }
    const float scale = amplitude / std::sqrt(power);
    return {scale * re, scale * im};
}

/// ∫_cell k²Φ jinc²(kA/2) d²k / k² of the cell at mode (i, j), by midpoints of subcells.
double cell_power(const Spectrum& spectrum, const BandGeometry& g, int i, int j) {
    const double dx = portable::kTwoPi / g.Lx, dy = portable::kTwoPi / g.Ly;
    const double centre2 = i * dx * i * dx + j * dy * j * dy;
    const auto power = [&](double k2) {
        const double filter = g.aperture > 0 ? jinc(0.5 * g.aperture * std::sqrt(k2)) : 1;
        return spectrum(k2) * filter * filter;
    };
    const int near = std::max(std::abs(i), std::abs(j));
    const int parts = !g.integrate || near > 16 ? 1 : (near <= 2 ? 12 : 3);
    if (parts == 1) return power(centre2) * dx * dy;
    double sum = 0;
    for (int a = 0; a < parts; ++a)
        for (int b = 0; b < parts; ++b) {
            const double kx = (i - 0.5 + (a + 0.5) / parts) * dx, ky = (j - 0.5 + (b + 0.5) / parts) * dy;
            const double k2 = kx * kx + ky * ky;
            sum += k2 * power(k2);
        }
    return sum * dx * dy / (parts * parts * centre2);
}

}  // namespace

ScreenBand::ScreenBand(const TurbulenceSpec& spec, const Spectrum& spectrum, const BandGeometry& geometry,
                       std::uint64_t index)
    : geometry_(geometry), plan_(std::make_shared<SplinePlan2>(geometry.nx, geometry.ny)) {
    const BandGeometry& g = geometry_;
    const RandomStream stream(spec.seed, "screens", index);
    const std::size_t n = static_cast<std::size_t>(g.nx) * half();
    amplitude_.assign(n, 0.0F);
    states_.assign(n, kKernelTaps);
    key_a_.resize(n);
    key_b_.resize(n);
    const double dx = portable::kTwoPi / g.Lx, dy = portable::kTwoPi / g.Ly;
    const double loop = g.T * std::sqrt(spec.alpha) / kKnotSpacing;  // states of a mode, divided by its wavenumber
    const double most = static_cast<double>(kStatesPerSample) * g.nt;
    const int columns = std::min(g.highest, (g.ny - 1) / 2), rows = std::min(g.highest, (g.nx - 1) / 2);
    struct Row {
        double x = 0, y = 0, curvature = 0;
        bool moves = false;
    };
    std::vector<Row> sums(static_cast<std::size_t>(rows + 1));
    tbb::parallel_for(0, rows + 1, [&](int i) {
        Row& row = sums[static_cast<std::size_t>(i)];
        for (int j = 0; j <= columns; ++j) {
            if (i == 0 && j == 0) continue;
            const double kx = i * dx, ky = j * dy, k = std::sqrt(kx * kx + ky * ky);
            const double power = portable::kTwoPi * g.thickness * cell_power(spectrum, g, i, j);
            const double sign = g.aperture > 0 && jinc(0.5 * g.aperture * k) < 0 ? -1 : 1;
            const auto states = static_cast<std::int32_t>(std::clamp(std::floor(loop * k + 0.5), 1.0, most));
            for (const int signed_i : {i, -i}) {
                const std::size_t at = static_cast<std::size_t>(signed_i < 0 ? signed_i + g.nx : signed_i) * half() +
                                       static_cast<std::size_t>(j);
                amplitude_[at] = static_cast<float>(sign * std::sqrt(power));
                states_[at] = states;
                const std::uint64_t key = stream.bits(at);
                key_a_[at] = static_cast<std::uint32_t>(key);
                key_b_[at] = static_cast<std::uint32_t>(key >> 32);
            }
            const double all = power * (i > 0 ? 2 : 1) * (j > 0 ? 2 : 1);
            row.x += all * kx * kx;
            row.y += all * ky * ky;
            row.curvature += all * kx * kx * kx * kx;
            row.moves = row.moves || (power > 0 && states > 1);
        }
    });
    bool moves = false;
    for (const Row& row : sums) {
        slope_x_ += row.x;
        slope_y_ += row.y;
        curvature_ += row.curvature;
        moves = moves || row.moves;
    }
    if (!moves) frozen_ = std::make_shared<PeriodicSpline2>(*plan_, spectrum_at(0), g.Lx, g.Ly);
}

FftVector<complex32> ScreenBand::spectrum_at(double t) const {
    const BandGeometry& g = geometry_;
    const double turns = std::fmod(t, g.T) / g.T;
    double tau = turns - std::floor(turns);
    if (tau >= 1) tau = 0;
    const GaussianTables& tables = gaussian_tables();
    FftVector<complex32> out(static_cast<std::size_t>(g.nx) * half());
    const int columns = std::min(g.highest, (g.ny - 1) / 2) + 1;
    std::vector<float> re(static_cast<std::size_t>(columns)), im(re.size());
    const int rows = std::min(g.highest, (g.nx - 1) / 2);
    for (int i = -rows; i <= rows; ++i) {
        const std::size_t first = static_cast<std::size_t>(i < 0 ? i + g.nx : i) * half();
        evolve(&amplitude_[first], &states_[first], &key_a_[first], &key_b_[first], columns, tau, tables.radius.data(),
               tables.cosine.data(), tables.sine.data(), re.data(), im.data());
        for (std::size_t j = 0; j < re.size(); ++j) {
            const std::size_t at = first + j;
            out[at] = states_[at] >= kKernelTaps
                          ? complex32{re[j], im[j]}
                          : evolve_slowly(amplitude_[at], states_[at], key_a_[at], key_b_[at], tau);
        }
    }
    // Hermitian symmetry within the row ky = 0.
    out[0] = 0;
    for (int i = 1; i <= rows; ++i)
        out[static_cast<std::size_t>(g.nx - i) * half()] = std::conj(out[static_cast<std::size_t>(i) * half()]);
    return out;
}

std::shared_ptr<const PeriodicSpline2> ScreenBand::at(double t) const {
    if (frozen_) return frozen_;
    return std::make_shared<PeriodicSpline2>(*plan_, spectrum_at(t), geometry_.Lx, geometry_.Ly);
}

double ScreenBand::bytes(const BandGeometry& g) {
    const double modes = static_cast<double>(g.nx) * (g.ny / 2 + 1), samples = static_cast<double>(g.nx) * g.ny;
    return modes * (4 * sizeof(std::uint32_t) + sizeof(complex32)) + 2 * sizeof(float) * samples;
}

}  // namespace eikonal
