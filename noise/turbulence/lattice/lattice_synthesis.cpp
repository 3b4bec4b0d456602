/// The spectra of a lattice field at one instant and over its whole period, from the amplitudes that lattice.cpp draws.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "noise/base/instruction_sets.h"
#include "noise/math/portable_math.h"
#include "noise/turbulence/lattice/lattice.h"

namespace eikonal {
namespace {

/// How many terms of the sums over time frequencies make up one task: some 20 µs of work.
constexpr std::size_t kTermsAtOnce = 1 << 16;

/// One row of an instant: a + Σ_j P cos(κ_j t) + M sin(κ_j t). trig: cos and sin of κ_j t, for j = 1 … terms. data_re,
/// data_im: as LatticeField::Row.
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

/// out = (re + i im) · row · ez, as interleaved complex numbers.
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

/// out = (p P + q iM) · scale, or times i·scale for a derivative. re, im: P, then M.
EIKONAL_CLONES
void combine_row(int n, const float* __restrict re, const float* __restrict im, float p, float q, bool derivative,
                 const float* __restrict scale, float* __restrict out) {
    for (int z = 0; z < n; ++z) {
        const float a = (p * re[z] - q * im[n + z]) * scale[z], b = (p * im[z] + q * re[n + z]) * scale[z];
        out[2 * z] = derivative ? -b : a;
        out[2 * z + 1] = derivative ? a : b;
    }
}

/// out = a · scale, or times i·scale for a derivative.
EIKONAL_CLONES
void scale_row(int n, const float* __restrict re, const float* __restrict im, bool derivative,
               const float* __restrict scale, float* __restrict out) {
    for (int z = 0; z < n; ++z) {
        const float a = re[z] * scale[z], b = im[z] * scale[z];
        out[2 * z] = derivative ? -b : a;
        out[2 * z + 1] = derivative ? a : b;
    }
}

/// e^{-2πi m s} for every bin of an axis. The Nyquist bin gets the mean of its two signs, a cosine.
std::vector<std::complex<double>> shift_phases(int n, int count, double s) {
    std::vector<std::complex<double>> phase(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        double sine, cosine;
        portable::sincos_turns(signed_index(i, n) * s, sine, cosine);
        phase[static_cast<std::size_t>(i)] = {cosine, is_nyquist(i, n) ? 0.0 : -sine};
    }
    return phase;
}

}  // namespace

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
                    // a± = (P ∓ iM)/2. At Nyquist both fall into one bin, and their sum is P.
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
