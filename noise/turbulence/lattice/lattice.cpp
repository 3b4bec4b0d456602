#include "noise/turbulence/lattice/lattice.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "noise/base/error.h"
#include "noise/base/instruction_sets.h"
#include "noise/math/fourier_random.h"
#include "noise/math/portable_math.h"
#include "noise/math/random.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {
namespace {

/// Amplitudes below this count as zero. Denormal numbers would slow every transform and change nothing.
constexpr double kSmallestAmplitude = 1e-30;
/// The largest rms of n whose square is safe in single precision. It is far beyond anything physical.
constexpr double kLargestRms = 1e15;

/// k_m of the paper's spectrum [rad/m], from its number of cycles in the shortest of the three periods.
double lowest_wavenumber(const TurbulenceSpec& spec, const LatticeGeometry& g) {
    return spec.lowest_wavenumber * portable::kTwoPi / std::min({g.period[0], g.period[1], g.period[2]});
}

const LatticeGeometry& checked(const TurbulenceSpec& spec, const LatticeGeometry& geometry) {
    check_lattice(spec, geometry, ~std::uint64_t{0});
    return geometry;
}

/// out = √(variance weight factor): the standard deviation of each component of a complex Gaussian.
EIKONAL_CLONES
void component_scale(int n, const double* variance, const double* weight, double factor, float* out) {
    for (int z = 0; z < n; ++z) {
        const double s = std::sqrt(variance[z] * weight[z] * factor);
        out[z] = static_cast<float>(s < kSmallestAmplitude ? 0.0 : s);
    }
}

int mirrored(int i, int n) {
    return i == 0 ? 0 : n - i;
}

}  // namespace

std::size_t LatticeGeometry::spatial_samples() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
}

std::size_t LatticeGeometry::half_spectrum() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(half());
}

LatticeField::LatticeField(const TurbulenceSpec& spec, const LatticeGeometry& geometry)
    : spec_(spec), geometry_(checked(spec, geometry)), spectrum_(spec, lowest_wavenumber(spec, geometry)) {
    cell_volume_ = 1;
    for (int axis = 0; axis < 3; ++axis) cell_volume_ *= portable::kTwoPi / geometry_.period[axis];
    if (!(variance() < kLargestRms * kLargestRms))
        throw UserError(
            fmt::format("turbulence: an index that fluctuates by more than {:g} is unphysical; lower cn2 or strength",
                        kLargestRms));
    const double finest2 = wavenumber2(largest_bending_mode(geometry_.size[0]), largest_bending_mode(geometry_.size[1]),
                                       largest_bending_mode(geometry_.size[2]));
    const double lowest = lowest_wavenumber(spec, geometry_);
    if (spec.spectrum == SpectrumKind::Paper && !(lowest * lowest <= finest2 * (1 + 1e-12)))
        throw UserError(fmt::format(
            "turbulence: lowest_wavenumber = {:g} cycles is beyond the lattice's finest eddies of {:g}, so that none "
            "are left; lower it, or make the lattice finer",
            spec.lowest_wavenumber, spec.lowest_wavenumber * std::sqrt(finest2) / lowest));
    frequencies_ = spec.alpha > 0 ? geometry_.size[3] / 2 : 0;
    layout();
    const auto qx = static_cast<std::size_t>(geometry_.size[0] / 2 + 1),
               qy = static_cast<std::size_t>(geometry_.size[1] / 2 + 1);
    tbb::parallel_for(std::size_t{0}, qx * qy, [&](std::size_t quadrant) {
        draw_quadrant(static_cast<int>(quadrant / qy), static_cast<int>(quadrant % qy));
    });
}

double LatticeField::wavenumber2(int mx, int my, int mz) const {
    const double kx = mx * (portable::kTwoPi / geometry_.period[0]);
    const double ky = my * (portable::kTwoPi / geometry_.period[1]);
    const double kz = mz * (portable::kTwoPi / geometry_.period[2]);
    return kx * kx + ky * ky + kz * kz;
}

double LatticeField::mode_variance(int mx, int my, int mz) const {
    if (mx == 0 && my == 0 && mz == 0) return 0;
    return spectrum_(wavenumber2(mx, my, mz)) * cell_volume_;
}

int LatticeField::first_mode(int mx, int my, int j) const {
    // exp(-κ²/(αk²)) >= kNegligibleWeight
    static const double exponent = -portable::log(kNegligibleWeight);
    const double kappa = portable::kTwoPi * j / geometry_.period[3];
    int z = 0;
    while (z < geometry_.half() && exponent * spec_.alpha * wavenumber2(mx, my, z) < kappa * kappa) ++z;
    return z;
}

void LatticeField::layout() {
    const int nx = geometry_.size[0], ny = geometry_.size[1], half = geometry_.half();
    const int qx = nx / 2 + 1, qy = ny / 2 + 1;
    const auto stride = static_cast<std::size_t>(frequencies_ + 1);
    first_.resize(static_cast<std::size_t>(qx) * static_cast<std::size_t>(qy) * stride);
    rows_.resize(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny));
    for (int mx = 0; mx < qx; ++mx)
        for (int my = 0; my < qy; ++my)
            for (int j = 1; j <= frequencies_; ++j)
                first_[(static_cast<std::size_t>(mx) * static_cast<std::size_t>(qy) + static_cast<std::size_t>(my)) *
                           stride +
                       static_cast<std::size_t>(j)] = static_cast<std::uint16_t>(first_mode(mx, my, j));
    std::size_t offset = 0;
    for (int ix = 0; ix < nx; ++ix)
        for (int iy = 0; iy < ny; ++iy) {
            Row& row = rows_[row_index(ix, iy)];
            row.offset = offset;
            row.terms = 0;
            row.total = half;
            const std::uint16_t* first = first_modes(ix, iy);
            while (row.terms < frequencies_ && first[row.terms + 1] < half)
                row.total += 2 * (half - first[++row.terms]);
            offset += 2 * static_cast<std::size_t>(row.total);
        }
    amplitudes_.resize(offset);
}

const std::uint16_t* LatticeField::first_modes(int ix, int iy) const {
    const int mx = std::abs(signed_index(ix, geometry_.size[0])), my = std::abs(signed_index(iy, geometry_.size[1]));
    const std::size_t quadrant = static_cast<std::size_t>(mx) * static_cast<std::size_t>(geometry_.size[1] / 2 + 1) +
                                 static_cast<std::size_t>(my);
    return first_.data() + quadrant * static_cast<std::size_t>(frequencies_ + 1);
}

/// What the rows (±mx, ±my) have in common.
struct LatticeField::Quadrant {
    /// One run of amplitudes over z >= first.
    struct Segment {
        int at, first;  ///< at: place of the run in a row
    };
    std::vector<float> scale;            ///< of every stored amplitude of a row, in its order
    std::vector<std::uint32_t> counter;  ///< random counter of each
    std::vector<Segment> segments;
};

LatticeField::Quadrant LatticeField::quadrant(int mx, int my) const {
    const auto n = static_cast<std::size_t>(geometry_.half());
    const int half = geometry_.half();
    const std::uint16_t* first = first_modes(mx, my);
    const Row& row = rows_[row_index(mx, my)];

    // The temporal weights are q^(j²), q = exp(-κ₁²/(αk²)), by w_{j+1} = w_j q^(2j+1). Their sum divides the variance.
    std::vector<double> variance(n), step(n), ratio(n), total(n, 1.0),
        weights(n * static_cast<std::size_t>(row.terms + 1), 1.0);
    const double kappa1 = portable::kTwoPi / geometry_.period[3];
    for (std::size_t z = 0; z < n; ++z) {
        variance[z] = mode_variance(mx, my, static_cast<int>(z));
        step[z] = temporal_weight(kappa1, spec_.alpha, wavenumber2(mx, my, static_cast<int>(z)));
        ratio[z] = step[z] * step[z];
    }
    for (int j = 1; j <= row.terms; ++j) {
        const double* before = weights.data() + n * static_cast<std::size_t>(j - 1);
        double* w = weights.data() + n * static_cast<std::size_t>(j);
        const double count = multiplicity(j);
        for (std::size_t z = 0; z < n; ++z) {
            w[z] = before[z] * step[z];
            step[z] *= ratio[z];
            if (z >= first[j]) total[z] += count * w[z];
        }
    }
    for (std::size_t z = 0; z < n; ++z) variance[z] /= total[z];

    Quadrant q;
    q.scale.resize(static_cast<std::size_t>(row.total));
    q.counter.resize(static_cast<std::size_t>(row.total));
    int at = 0;
    for (int j = 0; j <= row.terms; ++j)
        for (int which = 0; which < (j == 0 ? 1 : 2); ++which) {
            const int lo = j == 0 ? 0 : first[j];
            const double* w = weights.data() + n * static_cast<std::size_t>(j);
            component_scale(half - lo, variance.data() + lo, w + lo, 0.5 * multiplicity(j), q.scale.data() + at);
            for (int z = lo; z < half; ++z)
                q.counter[static_cast<std::size_t>(at + z - lo)] =
                    static_cast<std::uint32_t>((2 * j + which) * half + z);
            q.segments.push_back({at, lo});
            at += half - lo;
        }
    return q;
}

void LatticeField::draw_quadrant(int mx, int my) {
    const int nx = geometry_.size[0], ny = geometry_.size[1], nz = geometry_.size[2];
    const Quadrant q = quadrant(mx, my);
    const RandomStream stream(spec_.seed, "lattice");
    const auto for_each_row = [&](auto&& action) {
        for (const int ix : {mx, mirrored(mx, nx)}) {
            for (const int iy : {my, mirrored(my, ny)}) {
                action(row_index(ix, iy), row_index(mirrored(ix, nx), mirrored(iy, ny)));
                if (iy == mirrored(iy, ny)) break;
            }
            if (ix == mirrored(ix, nx)) break;
        }
    };
    for_each_row([&](std::size_t r, std::size_t) {
        float* re = amplitudes_.data() + rows_[r].offset;
        const int total = rows_[r].total;
        gaussian_modes(stream.bits(r), q.counter.data(), total, q.scale.data(), re, re + total);
    });
    // The planes kz = 0 and Nyquist hold both modes of each conjugate pair. There the row of the higher index takes the
    // conjugates of the lower one's modes. A mode that is its own partner is real, with its full variance.
    for_each_row([&](std::size_t r, std::size_t partner) {
        if (r < partner) return;
        float* re = amplitudes_.data() + rows_[r].offset;
        const float* from = amplitudes_.data() + rows_[partner].offset;
        const int total = rows_[r].total;
        for (const Quadrant::Segment& s : q.segments)
            for (const int z : {0, nz / 2}) {
                if (z < s.first || (z != 0 && !is_nyquist(z, nz))) continue;
                const int i = s.at + z - s.first;
                re[i] = r == partner ? re[i] * 1.41421356F : from[i];
                re[i + total] = r == partner ? 0.0F : -from[i + total];
            }
    });
}

}  // namespace eikonal
