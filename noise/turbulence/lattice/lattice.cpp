#include "noise/turbulence/lattice/lattice.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "noise/base/error.h"
#include "noise/base/instruction_sets.h"
#include "noise/math/fourier_random.h"
#include "noise/math/portable_math.h"
#include "noise/math/random.h"

namespace eikonal {
namespace {

/// Amplitudes below this count as zero: denormal numbers would slow every transform and change nothing.
constexpr double kSmallestAmplitude = 1e-30;
/// Terms of the sums over time frequencies that are worth a task of their own: some 20 µs.
constexpr std::size_t kTermsAtOnce = 1 << 16;
/// Largest rms of n that single precision squares safely; far beyond anything physical.
constexpr double kLargestRms = 1e15;

/// k_m of the paper's spectrum: cycles per lattice period, the shortest of the three.
double lowest_wavenumber(const TurbulenceSpec& spec, const LatticeGeometry& g) {
    return spec.lowest_wavenumber * portable::kTwoPi / std::min({g.period[0], g.period[1], g.period[2]});
}

const LatticeGeometry& checked(const TurbulenceSpec& spec, const LatticeGeometry& geometry) {
    check_lattice(spec, geometry, ~std::uint64_t{0});
    return geometry;
}

/// out = √(variance weight factor), per component of a complex Gaussian.
EIKONAL_CLONES
void component_scale(int n, const double* variance, const double* weight, double factor, float* out) {
    for (int z = 0; z < n; ++z) {
        const double s = std::sqrt(variance[z] * weight[z] * factor);
        out[z] = static_cast<float>(s < kSmallestAmplitude ? 0.0 : s);
    }
}

/// Σ_j of one row: a + Σ P cos + M sin. trig: cos, sin of κ_j t, for j = 1 … terms. Data: as LatticeField::Row.
EIKONAL_CLONES
void sum_row(const float* __restrict data_re, const float* __restrict data_im, int half, int terms,
             const std::uint16_t* first, const float* trig, float* __restrict re, float* __restrict im) {
    for (int z = 0; z < half; ++z) {
        re[z] = data_re[z];
        im[z] = data_im[z];
    }
    data_re += half;
    data_im += half;
    for (int j = 1; j <= terms; ++j) {
        const int lo = first[j], n = half - lo;
        const float c = trig[2 * (j - 1)], s = trig[2 * (j - 1) + 1];
        float* __restrict r = re + lo;
        float* __restrict i = im + lo;
        for (int z = 0; z < n; ++z) {
            r[z] += c * data_re[z] + s * data_re[n + z];
            i[z] += c * data_im[z] + s * data_im[n + z];
        }
        data_re += 2 * n;
        data_im += 2 * n;
    }
}

/// out = (re + i im) · row · ez, interleaved.
EIKONAL_CLONES
void advect_row(int half, const float* __restrict re, const float* __restrict im, complex32 row,
                const float* __restrict ez_re, const float* __restrict ez_im, float* __restrict out) {
    const float cr = row.real(), ci = row.imag();
    for (int z = 0; z < half; ++z) {
        const float pr = cr * ez_re[z] - ci * ez_im[z], pi = cr * ez_im[z] + ci * ez_re[z];
        out[2 * z] = re[z] * pr - im[z] * pi;
        out[2 * z + 1] = re[z] * pi + im[z] * pr;
    }
}

/// out = p P + q iM, times the operator: `scale` (index) or i·scale (derivative). re, im: P then M.
EIKONAL_CLONES
void combine_row(int n, const float* __restrict re, const float* __restrict im, float p, float q, bool derivative,
                 const float* __restrict scale, float* __restrict out) {
    for (int z = 0; z < n; ++z) {
        const float a = (p * re[z] - q * im[n + z]) * scale[z], b = (p * im[z] + q * re[n + z]) * scale[z];
        out[2 * z] = derivative ? -b : a;
        out[2 * z + 1] = derivative ? a : b;
    }
}

/// The same of a alone.
EIKONAL_CLONES
void scale_row(int n, const float* __restrict re, const float* __restrict im, bool derivative,
               const float* __restrict scale, float* __restrict out) {
    for (int z = 0; z < n; ++z) {
        const float a = re[z] * scale[z], b = im[z] * scale[z];
        out[2 * z] = derivative ? -b : a;
        out[2 * z + 1] = derivative ? a : b;
    }
}

/// e^{-2πi m s} for every bin of an axis; the Nyquist bin gets the mean of its two signs, cos.
std::vector<std::complex<double>> shift_phases(int n, int count, double s) {
    std::vector<std::complex<double>> phase(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        double sine, cosine;
        portable::sincos_turns(signed_index(i, n) * s, sine, cosine);
        phase[static_cast<std::size_t>(i)] = {cosine, is_nyquist(i, n) ? 0.0 : -sine};
    }
    return phase;
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

double bin_wavenumber(int i, int n, double period) {
    return portable::kTwoPi * signed_index(i, n) / period;
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

void LatticeField::draw_quadrant(int mx, int my) {
    const int nx = geometry_.size[0], ny = geometry_.size[1], nz = geometry_.size[2], half = geometry_.half();
    const auto n = static_cast<std::size_t>(half);
    const std::uint16_t* first = first_modes(mx, my);
    const Row& row = rows_[row_index(mx, my)];

    // Temporal weights q^(j²), q = exp(-κ₁²/(αk²)), by w_{j+1} = w_j q^(2j+1); then variance/Σ.
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

    // Scale and counter of every stored amplitude of a row, in its order.
    const auto total_modes = static_cast<std::size_t>(row.total);
    std::vector<float> scale(total_modes);
    std::vector<std::uint32_t> counter(total_modes);
    struct Segment {
        int at, first, length;
    };
    std::vector<Segment> segments;
    int at = 0;
    for (int j = 0; j <= row.terms; ++j)
        for (int which = 0; which < (j == 0 ? 1 : 2); ++which) {
            const int lo = j == 0 ? 0 : first[j];
            const double* w = weights.data() + n * static_cast<std::size_t>(j);
            component_scale(half - lo, variance.data() + lo, w + lo, 0.5 * multiplicity(j), scale.data() + at);
            for (int z = lo; z < half; ++z)
                counter[static_cast<std::size_t>(at + z - lo)] = static_cast<std::uint32_t>((2 * j + which) * half + z);
            segments.push_back({at, lo, half - lo});
            at += half - lo;
        }

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
        gaussian_modes(stream.bits(r), counter.data(), row.total, scale.data(), re, re + row.total);
    });
    // Planes that hold their own conjugates: the row of the higher index takes those of the lower, self-paired modes
    // are real with their full variance.
    for_each_row([&](std::size_t r, std::size_t partner) {
        if (r < partner) return;
        float* re = amplitudes_.data() + rows_[r].offset;
        const float* from = amplitudes_.data() + rows_[partner].offset;
        for (const Segment& s : segments)
            for (const int z : {0, nz / 2}) {
                if (z < s.first || (z != 0 && !is_nyquist(z, nz))) continue;
                const int i = s.at + z - s.first;
                re[i] = r == partner ? re[i] * 1.41421356F : from[i];
                re[i + row.total] = r == partner ? 0.0F : -from[i + row.total];
            }
    });
}

FftVector<complex32> LatticeField::spectrum_at(double t) const {
    FftVector<complex32> spectrum(geometry_.half_spectrum());
    spectrum_at(t, spectrum.data());
    return spectrum;
}

void LatticeField::spectrum_at(double t, complex32* out) const {
    const int nx = geometry_.size[0], ny = geometry_.size[1], half = geometry_.half();
    const auto n = static_cast<std::size_t>(half);
    std::vector<float> trig(2 * static_cast<std::size_t>(frequencies_));
    const double turns = std::fmod(t, geometry_.period[3]) / geometry_.period[3];
    for (int j = 1; j <= frequencies_; ++j) {
        double s, c;
        portable::sincos_turns(j * turns, s, c);
        trig[2 * static_cast<std::size_t>(j - 1)] = static_cast<float>(c);
        trig[2 * static_cast<std::size_t>(j - 1) + 1] = static_cast<float>(s);
    }
    std::array<std::vector<std::complex<double>>, 3> phase;
    for (int axis = 0; axis < 3; ++axis) {
        const double period = geometry_.period[axis];
        phase[axis] = shift_phases(geometry_.size[axis], axis == 2 ? half : geometry_.size[axis],
                                   std::fmod(spec_.velocity[axis] * t, period) / period);
    }
    std::vector<float> ez_re(n), ez_im(n);
    for (std::size_t z = 0; z < n; ++z) {
        ez_re[z] = static_cast<float>(phase[2][z].real());
        ez_im[z] = static_cast<float>(phase[2][z].imag());
    }
    const auto terms = static_cast<std::size_t>(ny) * n * static_cast<std::size_t>(1 + frequencies_);
    const int rows_at_once = 1 + static_cast<int>(kTermsAtOnce / terms);
    tbb::parallel_for(tbb::blocked_range<int>(0, nx, rows_at_once), [&](const tbb::blocked_range<int>& range) {
        std::vector<float> re(n), im(n);
        for (int ix = range.begin(); ix < range.end(); ++ix)
            for (int iy = 0; iy < ny; ++iy) {
                const std::size_t r = row_index(ix, iy);
                const float* data = amplitudes_.data() + rows_[r].offset;
                sum_row(data, data + rows_[r].total, half, rows_[r].terms, first_modes(ix, iy), trig.data(), re.data(),
                        im.data());
                const auto& ex = phase[0][static_cast<std::size_t>(ix)];
                const auto& ey = phase[1][static_cast<std::size_t>(iy)];
                const complex32 row(static_cast<float>(ex.real() * ey.real() - ex.imag() * ey.imag()),
                                    static_cast<float>(ex.real() * ey.imag() + ex.imag() * ey.real()));
                advect_row(half, re.data(), im.data(), row, ez_re.data(), ez_im.data(),
                           reinterpret_cast<float*>(out + r * n));
            }
    });
}

FftVector<complex32> LatticeField::bending_spectrum_at(double t) const {
    FftVector<complex32> spectrum = spectrum_at(t);
    const int nx = geometry_.size[0], ny = geometry_.size[1], nz = geometry_.size[2];
    complex32* row = spectrum.data();
    for (int ix = 0; ix < nx; ++ix)
        for (int iy = 0; iy < ny; ++iy, row += geometry_.half()) {
            const bool whole = is_nyquist(ix, nx) || is_nyquist(iy, ny);
            std::fill(row + (whole ? 0 : largest_bending_mode(nz) + 1), row + geometry_.half(), complex32(0, 0));
        }
    return spectrum;
}

void LatticeField::period_spectrum(Component what, complex32* spectrum) const {
    const int nx = geometry_.size[0], ny = geometry_.size[1], nz = geometry_.size[2], nt = geometry_.size[3];
    const int half = geometry_.half();
    const std::size_t plane = geometry_.half_spectrum();
    const bool derivative = what != Component::Index;
    tbb::parallel_for(tbb::blocked_range<int>(0, nx), [&](const tbb::blocked_range<int>& range) {
        std::vector<float> scale(static_cast<std::size_t>(half), 1.0F);
        for (int ix = range.begin(); ix < range.end(); ++ix)
            for (int iy = 0; iy < ny; ++iy) {
                if (derivative) {
                    const bool bends = !is_nyquist(ix, nx) && !is_nyquist(iy, ny);
                    for (int z = 0; z < half; ++z) {
                        const double k = what == Component::ForceX   ? bin_wavenumber(ix, nx, geometry_.period[0])
                                         : what == Component::ForceY ? bin_wavenumber(iy, ny, geometry_.period[1])
                                                                     : bin_wavenumber(z, nz, geometry_.period[2]);
                        scale[static_cast<std::size_t>(z)] = bends && !is_nyquist(z, nz) ? static_cast<float>(k) : 0.0F;
                    }
                }
                const std::size_t r = row_index(ix, iy);
                const std::uint16_t* first = first_modes(ix, iy);
                const float* re = amplitudes_.data() + rows_[r].offset;
                const float* im = re + rows_[r].total;
                const auto target = [&](int bin) {
                    return spectrum + static_cast<std::size_t>(bin) * plane + r * static_cast<std::size_t>(half);
                };
                scale_row(half, re, im, derivative, scale.data(), reinterpret_cast<float*>(target(0)));
                re += half;
                im += half;
                for (int j = 1; j <= nt / 2; ++j) {
                    const bool nyquist = is_nyquist(j, nt);
                    const int lo = j <= rows_[r].terms ? first[j] : half, n = half - lo;
                    // a± = (P ∓ iM)/2; at Nyquist the two meet in one bin as P
                    for (const int sign : {-1, 1}) {
                        if (nyquist && sign == 1) break;
                        complex32* to = target(sign < 0 ? j : nt - j);
                        std::fill(to, to + lo, complex32(0, 0));
                        if (n > 0)
                            combine_row(n, re, im, nyquist ? 1.0F : 0.5F,
                                        nyquist ? 0.0F : 0.5F * static_cast<float>(sign), derivative, scale.data() + lo,
                                        reinterpret_cast<float*>(to + lo));
                    }
                    re += 2 * n;
                    im += 2 * n;
                }
            }
    });
}

FftVector<float> LatticeField::synthesize_period(Component what) const {
    const FftPlan plan(FftPlan::Kind::ComplexToReal,
                       std::array{geometry_.size[3], geometry_.size[0], geometry_.size[1], geometry_.size[2]});
    FftScratch<complex32> spectrum(plan.spectrum_size());
    FftVector<float> samples(plan.sample_size());
    period_spectrum(what, spectrum.data());
    plan.execute(spectrum.data(), samples.data());
    return samples;
}

PeriodSynthesis::PeriodSynthesis(const LatticeField& field)
    : field_(field),
      plan_(FftPlan::Kind::ComplexToReal, std::array{field.geometry().size[3], field.geometry().size[0],
                                                     field.geometry().size[1], field.geometry().size[2]}),
      spectrum_(plan_.spectrum_size()),
      samples_(plan_.sample_size()) {}

std::span<const float> PeriodSynthesis::operator()(Component what) {
    field_.period_spectrum(what, spectrum_.data());
    plan_.execute(spectrum_.data(), samples_.data());
    return samples_;
}

}  // namespace eikonal
