/// What a lattice is expected to do, as discrete sums over its modes, and what it costs. No random number is drawn
/// here.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "noise/base/error.h"
#include "noise/math/bessel.h"
#include "noise/math/portable_math.h"
#include "noise/turbulence/lattice/lattice.h"
#include "noise/turbulence/lattice/path_kernel.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {
namespace {

constexpr double kDefaultOuterScales = 2;       ///< periods in L0
constexpr double kDefaultCorrelationTimes = 4;  ///< T in correlation times of the largest eddies
constexpr int kDefaultTimes = 32;
constexpr int kDefaultPaperSize = 32;
/// Bound of nz nt. An int, and the 32 bits of a random counter, count the modes of a row.
constexpr double kLongestRow = 2e9;

/// Calls action(m, modes) for every |m| of the lattice up to `last` along each axis. `modes`: how many signed modes
/// share it.
template <class Action>
void for_each_octant_mode(const LatticeGeometry& g, const std::array<int, 3>& last, Action&& action) {
    const auto signs = [](int m, int n) { return m == 0 || is_nyquist(m, n) ? 1.0 : 2.0; };
    for (int mx = 0; mx <= last[0]; ++mx)
        for (int my = 0; my <= last[1]; ++my)
            for (int mz = 0; mz <= last[2]; ++mz)
                action(std::array<int, 3>{mx, my, mz},
                       signs(mx, g.size[0]) * signs(my, g.size[1]) * signs(mz, g.size[2]));
}

/// Calls action for every mode, or for those that bend light.
template <class Action>
void for_each_mode(const LatticeGeometry& g, Action&& action) {
    for_each_octant_mode(g, {g.size[0] / 2, g.size[1] / 2, g.size[2] / 2}, action);
}
template <class Action>
void for_each_bending_mode(const LatticeGeometry& g, Action&& action) {
    for_each_octant_mode(
        g, {largest_bending_mode(g.size[0]), largest_bending_mode(g.size[1]), largest_bending_mode(g.size[2])}, action);
}

/// |∫₀^u w (u - w) e^{ikw} dw| = 4 |sin φ - φ cos φ|/k³, φ = ku/2; u³/6 as φ → 0.
double diverging_kernel(double k, double u) {
    const double phase = 0.5 * k * u;
    if (std::abs(phase) < 0.1) return u * u * u / 6 * (1 - phase * phase / 10);
    double s, c;
    portable::sincos_turns(phase / portable::kTwoPi, s, c);
    return 4 * std::abs((s - phase * c) / (k * k * k));
}

}  // namespace

LatticeGeometry choose_lattice(const TurbulenceSpec& spec) {
    LatticeGeometry g;
    const bool von_karman = spec.spectrum == SpectrumKind::VonKarman;
    const double length = kDefaultOuterScales * spec.outer_scale;
    // The correlation time of an eddy of wavenumber k0 = 2π/L0 is 2/(√α k0).
    const double time =
        spec.alpha > 0 ? kDefaultCorrelationTimes * spec.outer_scale / (portable::kPi * std::sqrt(spec.alpha)) : 1;
    g.period = spec.period.value_or(std::array<double, 4>{length, length, length, time});
    if (spec.lattice) {
        g.size = *spec.lattice;
        return g;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const double cells = von_karman ? std::ceil(2 * g.period[axis] / spec.inner_scale) : kDefaultPaperSize;
        g.size[axis] = good_fft_size(static_cast<int>(std::clamp(cells, 2.0, double{kLargestDefaultSize})));
    }
    g.size[3] = spec.alpha > 0 ? kDefaultTimes : 1;
    return g;
}

std::uint64_t lattice_bytes(const TurbulenceSpec& spec, const LatticeGeometry& g) {
    const double samples = double(g.size[0]) * g.size[1] * g.size[2];
    const double modes = double(g.size[0]) * g.size[1] * g.half();
    const double terms = spec.alpha > 0 ? 1 + 2.0 * (g.size[3] / 2) : 1;
    // Amplitudes, an instant's spectrum and the copy that its transform destroys; the spline, and n and F at the nodes.
    const double bytes = modes * sizeof(complex32) * (terms + 2) + samples * sizeof(float) * 5;
    return bytes < 0x1p64 ? static_cast<std::uint64_t>(bytes) : std::numeric_limits<std::uint64_t>::max();
}

void check_lattice(const TurbulenceSpec& spec, const LatticeGeometry& g, std::uint64_t memory_limit) {
    constexpr std::array names{"nx", "ny", "nz", "nt"};
    constexpr std::array lengths{"x", "y", "z", "t"};
    for (int axis = 0; axis < 4; ++axis) {
        const int least = axis == 3 ? 1 : 2;
        if (g.size[axis] < least)
            throw UserError(fmt::format("turbulence: lattice {} = {} is too small; allowed is {} or more", names[axis],
                                        g.size[axis], least));
        if (!(g.period[axis] > 0) || !std::isfinite(g.period[axis]))
            throw UserError(
                fmt::format("turbulence: period {} = {} must be positive and finite", lengths[axis], g.period[axis]));
    }
    if (g.half() > std::numeric_limits<std::uint16_t>::max())
        throw UserError(fmt::format("turbulence: lattice nz = {} is too large; allowed is {} or less", g.size[2],
                                    2 * (std::numeric_limits<std::uint16_t>::max() - 1)));
    const std::uint64_t bytes = lattice_bytes(spec, g);
    if (bytes > memory_limit)
        throw UserError(
            fmt::format("turbulence: lattice [{}, {}, {}, {}] needs {:.3g} GB of memory, {:.3g} GB are available; "
                        "use a smaller lattice or form = \"screens\"",
                        g.size[0], g.size[1], g.size[2], g.size[3], static_cast<double>(bytes) * 1e-9,
                        static_cast<double>(memory_limit) * 1e-9));
    const double row = double(g.size[2]) * (spec.alpha > 0 ? g.size[3] : 1);
    if (row > kLongestRow)
        throw UserError(fmt::format("turbulence: lattice nz = {} times nt = {} is too large; allowed is {:g} or less",
                                    g.size[2], g.size[3], kLongestRow));
}

double LatticeField::mode_correlation(int mx, int my, int mz, double t) const {
    const double k2 = wavenumber2(mx, my, mz);
    const double turns = std::fmod(t, geometry_.period[3]) / geometry_.period[3];
    double total = 1, sum = 1;
    for (int j = 1; j <= frequencies_; ++j) {
        const double weight =
            multiplicity(j) * temporal_weight(portable::kTwoPi * j / geometry_.period[3], spec_.alpha, k2);
        double s, c;
        portable::sincos_turns(j * turns, s, c);
        total += weight;
        sum += weight * c;
    }
    return sum / total;
}

double LatticeField::variance() const {
    double sum = 0;
    for_each_mode(geometry_,
                  [&](const std::array<int, 3>& m, double modes) { sum += modes * mode_variance(m[0], m[1], m[2]); });
    return sum;
}

std::array<double, 2> LatticeField::focusing_variance(int axis, double u, bool perspective, double aperture) const {
    std::vector<double> weight;
    for (int m = 0; m <= largest_bending_mode(geometry_.size[axis]); ++m) {
        const double k = portable::kTwoPi * m / geometry_.period[axis];
        const double kernel = perspective ? diverging_kernel(k, u) / u : std::abs(path_kernel(k, u));
        weight.push_back(kernel * kernel);
    }
    const std::array<int, 2> lateral{axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
    std::array<double, 2> sum{};
    for_each_bending_mode(geometry_, [&](const std::array<int, 3>& m, double modes) {
        std::array<double, 2> k2{};
        for (int e = 0; e < 2; ++e) {
            const double k = portable::kTwoPi * m[lateral[e]] / geometry_.period[lateral[e]];
            k2[e] = k * k;
        }
        const double filter = perspective ? 1 : jinc(0.5 * aperture * std::sqrt(k2[0] + k2[1]));
        const double power =
            modes * weight[static_cast<std::size_t>(m[axis])] * filter * filter * mode_variance(m[0], m[1], m[2]);
        for (int e = 0; e < 2; ++e) sum[e] += power * k2[e] * k2[e];
    });
    return sum;
}

double LatticeField::structure_function(int axis, double r) const {
    const int n = geometry_.size[axis];
    std::vector<double> weight(static_cast<std::size_t>(n / 2 + 1));
    for (int m = 0; m <= n / 2; ++m) {
        double s, c;
        portable::sincos_turns(m * std::fmod(r, n) / n, s, c);
        weight[static_cast<std::size_t>(m)] = 2 * (1 - c);
    }
    double sum = 0;
    for_each_mode(geometry_, [&](const std::array<int, 3>& m, double modes) {
        sum += modes * weight[static_cast<std::size_t>(m[axis])] * mode_variance(m[0], m[1], m[2]);
    });
    return sum;
}

}  // namespace eikonal
