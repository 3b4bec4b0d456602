#include "noise/blobs/eddies.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include "noise/base/instruction_sets.h"
#include "noise/math/cubic_taps.h"
#include "noise/math/periodic_spline3.h"
#include "noise/math/portable_math.h"
#include "noise/math/random.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {
namespace {

constexpr std::size_t kSize = kEddySize;
constexpr std::size_t kWrapped = kSize + 3;  ///< with nodes -1, n and n + 1, so that no tap needs a modulo
constexpr std::size_t kLanes = 4;            ///< A_x, A_y, A_z, 0
constexpr double kCell = kEddyPeriod / kEddySize;
constexpr std::array<int, 3> kSizes{kEddySize, kEddySize, kEddySize};

/// Two neighbouring nodes along z, kLanes numbers each.
using TwoNodes = float __attribute__((vector_size(32)));

TwoNodes load(const float* p) {
    TwoNodes v;
    std::memcpy(&v, p, sizeof v);
    return v;
}
TwoNodes each(float first, float second) {
    return TwoNodes{first, first, first, first, second, second, second, second};
}

LatticeField potential(std::uint64_t seed, std::uint64_t component) {
    TurbulenceSpec spec;
    spec.seed = RandomStream(seed, "wind").bits(component);
    spec.cn2 = 1;
    spec.outer_scale = 1;
    spec.inner_scale = kEddyInnerScale;
    spec.alpha = 1;
    return LatticeField(
        spec, {{kEddySize, kEddySize, kEddySize, kEddyTimes}, {kEddyPeriod, kEddyPeriod, kEddyPeriod, kEddyLoop}});
}

std::array<LatticeField, 3> potentials(std::uint64_t seed) {
    std::array<std::optional<LatticeField>, 3> made;
    tbb::parallel_for(std::size_t{0}, made.size(), [&](std::size_t c) { made[c].emplace(potential(seed, c)); });
    return {std::move(*made[0]), std::move(*made[1]), std::move(*made[2])};
}

/// 1/√(k² + k0²), which turns a lattice field's spectrum into the potential's. mx, my, mz: signed bins.
double potential_factor(int mx, int my, int mz) {
    const double k1 = portable::kTwoPi / kEddyPeriod, m2 = mx * mx + my * my + mz * mz;
    return 1 / std::sqrt(k1 * k1 * m2 + portable::kTwoPi * portable::kTwoPi);
}

/// Mean square of the cubic spline through e^{iθj} and of its slope [1/cell]: sums of B-splines of degree 7 and 5.
struct SplineGain {
    double value, slope;

    explicit SplineGain(int bin) {
        const double turns = static_cast<double>(bin) / kEddySize;
        const auto cosine = [&](int j) {
            double s, c;
            portable::sincos_turns(j * turns, s, c);
            return c;
        };
        const double inverse = 1 / (spline_transfer(turns) * spline_transfer(turns));
        value = (2416 + 2382 * cosine(1) + 240 * cosine(2) + 2 * cosine(3)) / 5040 * inverse;
        slope = 2 * (1 - cosine(1)) * (66 + 52 * cosine(1) + 2 * cosine(2)) / 120 * inverse;
    }
};

/// Variance of each component of the curl of the potential's splines.
double curl_variance(const LatticeField& field) {
    std::vector<SplineGain> gain;
    for (int m = 0; m <= kEddySize / 2; ++m) gain.emplace_back(m);
    const auto signs = [](int m) { return m == 0 || is_nyquist(m, kEddySize) ? 1.0 : 2.0; };
    double sum = 0;
    for (int mx = 0; mx <= kEddySize / 2; ++mx)
        for (int my = 0; my <= kEddySize / 2; ++my)
            for (int mz = 0; mz <= my; ++mz) {
                const double factor = potential_factor(mx, my, mz), twice = mz < my ? 2 : 1;  // y and z are alike
                sum += twice * signs(mx) * signs(my) * signs(mz) * factor * factor * field.mode_variance(mx, my, mz) *
                       gain[static_cast<std::size_t>(mx)].slope * gain[static_cast<std::size_t>(my)].value *
                       gain[static_cast<std::size_t>(mz)].value;
            }
    return 2 * sum / (kCell * kCell);  // two derivatives of independent components
}

}  // namespace

EddyField::EddyField(std::uint64_t seed)
    : potential_(potentials(seed)), plan_(FftPlan::Kind::ComplexToReal, kSizes, 3) {
    // Slopes are derivatives by cells, so the cell is the potential's unit of length.
    const double scale = 1 / (kCell * std::sqrt(curl_variance(potential_[0])));
    std::array<double, kSize> prefilter;
    for (int i = 0; i < kEddySize; ++i)
        prefilter[static_cast<std::size_t>(i)] = 1 / spline_transfer(static_cast<double>(i) / kEddySize);
    filter_.reserve(potential_[0].geometry().half_spectrum());
    for (int x = 0; x < kEddySize; ++x)
        for (int y = 0; y < kEddySize; ++y)
            for (int z = 0; z < potential_[0].geometry().half(); ++z)
                filter_.push_back(static_cast<float>(
                    scale * potential_factor(signed_index(x, kEddySize), signed_index(y, kEddySize), z) *
                    prefilter[static_cast<std::size_t>(x)] * prefilter[static_cast<std::size_t>(y)] *
                    prefilter[static_cast<std::size_t>(z)]));
}

EddyInstant EddyField::at(double t, EddyWorkspace& room) const {
    const std::size_t modes = filter_.size(), samples = kSize * kSize * kSize;
    room.spectra.resize(3 * modes);
    room.nodes.resize(3 * samples);
    for (std::size_t c = 0; c < 3; ++c) {
        complex32* spectrum = room.spectra.data() + c * modes;
        potential_[c].spectrum_at(t, spectrum);
        for (std::size_t i = 0; i < modes; ++i) spectrum[i] *= filter_[i];
    }
    plan_.execute(room.spectra.data(), room.nodes.data());

    EddyInstant instant;
    instant.coefficients_ = FftScratch<float>(kWrapped * kWrapped * kWrapped * kLanes);
    float* to = instant.coefficients_.data();
    for (std::size_t i = 0; i < kWrapped; ++i)
        for (std::size_t j = 0; j < kWrapped; ++j) {
            const float* from = room.nodes.data() + ((i + kSize - 1) % kSize * kSize + (j + kSize - 1) % kSize) * kSize;
            for (std::size_t l = 0; l < kWrapped; ++l, to += kLanes) {
                const float* node = from + (l + kSize - 1) % kSize;
                for (std::size_t c = 0; c < 3; ++c) to[c] = node[c * samples];
                to[3] = 0;
            }
        }
    return instant;
}

EIKONAL_CLONES dvec3 EddyInstant::velocity(const dvec3& x) const {
    const PeriodicTaps<float> in_x = periodic_taps<float>(x.x, kEddySize), in_y = periodic_taps<float>(x.y, kEddySize),
                              in_z = periodic_taps<float>(x.z, kEddySize);
    const float* corner =
        coefficients_.data() + ((in_x.first * kWrapped + in_y.first) * kWrapped + in_z.first) * kLanes;
    const CubicTaps<float>&tx = in_x.taps, &ty = in_y.taps, &tz = in_z.taps;
    const TwoNodes w01 = each(tz.weight[0], tz.weight[1]), w23 = each(tz.weight[2], tz.weight[3]);
    const TwoNodes d01 = each(tz.slope[0], tz.slope[1]), d23 = each(tz.slope[2], tz.slope[3]);
    TwoNodes sum_x{}, sum_y{}, sum_z{};  // of ∂A/∂x, ∂A/∂y, ∂A/∂z: even nodes along z, then odd ones
    for (std::size_t i = 0; i < 4; ++i) {
        TwoNodes value{}, slope_y{}, slope_z{};
        for (std::size_t j = 0; j < 4; ++j) {
            const float* row = corner + (i * kWrapped + j) * kWrapped * kLanes;
            const TwoNodes c01 = load(row), c23 = load(row + 2 * kLanes);
            const TwoNodes v = w01 * c01 + w23 * c23, s = d01 * c01 + d23 * c23;
            value += ty.weight[j] * v;
            slope_y += ty.slope[j] * v;
            slope_z += ty.weight[j] * s;
        }
        sum_x += tx.slope[i] * value;
        sum_y += tx.weight[i] * slope_y;
        sum_z += tx.weight[i] * slope_z;
    }
    const auto component = [](const TwoNodes& sum, int c) { return sum[c] + sum[c + 4]; };
    const dvec3 dx(component(sum_x, 0), component(sum_x, 1), component(sum_x, 2));
    const dvec3 dy(component(sum_y, 0), component(sum_y, 1), component(sum_y, 2));
    const dvec3 dz(component(sum_z, 0), component(sum_z, 1), component(sum_z, 2));
    return {dy[2] - dz[1], dz[0] - dx[2], dx[1] - dy[0]};
}

}  // namespace eikonal
