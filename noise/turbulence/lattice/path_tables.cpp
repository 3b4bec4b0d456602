#include "noise/turbulence/lattice/path_tables.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "noise/base/instruction_sets.h"
#include "noise/math/bessel.h"
#include "noise/math/portable_math.h"
#include "noise/turbulence/lattice/lattice_instant.h"
#include "noise/turbulence/lattice/path_kernel.h"

namespace eikonal {
namespace {

/// Part of the tolerance that the splines' expected error may take. Rounding and chance take the rest.
constexpr double kSplineShare = 0.5;
constexpr int kLanes = 8;  ///< partial sums of a dot product. Their order is the same on every processor.

/// Factors along the ray axis for several outputs: value[output][re, im][bin]. Rows are padded with zeros.
struct Kernels {
    int outputs, bins, stride;
    std::vector<float> value;

    Kernels(int outputs_, int bins_)
        : outputs(outputs_),
          bins(bins_),
          stride((bins_ + kLanes - 1) / kLanes * kLanes),
          value(2 * static_cast<std::size_t>(outputs_) * static_cast<std::size_t>(stride)) {}
    float* re(int output) {
        return value.data() + 2 * static_cast<std::size_t>(output) * static_cast<std::size_t>(stride);
    }
    const float* re(int output) const {
        return value.data() + 2 * static_cast<std::size_t>(output) * static_cast<std::size_t>(stride);
    }
};

/// H(k∥) = e^{ik∥z0} kernel(sign k∥) for each bin of the ray axis. (The Nyquist bin has no modes.) Along z only half of
/// the bins are stored. sum_along adds the other half as mirrored conjugates, so a bin that is its own mirror gets ½.
template <class Kernel>
void fill_kernel(const LatticeGeometry& g, const PathRays& rays, double z0, Kernel&& kernel, float* re, float* im) {
    const int n = g.size[rays.axis], bins = rays.axis == 2 ? g.half() : n;
    const double period = g.period[rays.axis], start = std::fmod(z0, period) / period;
    for (int i = 0; i < bins; ++i) {
        const int m = signed_index(i, n);
        double s, c;
        portable::sincos_turns(m * start, s, c);
        const std::complex<double> h = kernel(rays.sign * (portable::kTwoPi * m / period));
        double hr = c * h.real() - s * h.imag(), hi = c * h.imag() + s * h.real();
        if (rays.axis == 2 && i == 0) {
            hr *= 0.5;
            hi *= 0.5;
        }
        re[i] = static_cast<float>(hr);
        im[i] = static_cast<float>(hi);
    }
}

EIKONAL_CLONES
void split_row(int n, const float* __restrict row, float* __restrict re, float* __restrict im) {
    for (int z = 0; z < n; ++z) {
        re[z] = row[2 * z];
        im[z] = row[2 * z + 1];
    }
}

/// acc += H · row
EIKONAL_CLONES
void add_row(int n, float hr, float hi, const float* __restrict re, const float* __restrict im,
             float* __restrict acc_re, float* __restrict acc_im) {
    for (int z = 0; z < n; ++z) {
        acc_re[z] += hr * re[z] - hi * im[z];
        acc_im[z] += hr * im[z] + hi * re[z];
    }
}

/// Σ_z H row, n a multiple of kLanes.
EIKONAL_CLONES
void dot_row(int n, const float* __restrict hr, const float* __restrict hi, const float* __restrict re,
             const float* __restrict im, float* __restrict out) {
    using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));
    Lanes sum_re{}, sum_im{};
    for (int z = 0; z < n; z += kLanes) {
        Lanes a, b, c, d;
        std::memcpy(&a, hr + z, sizeof a);
        std::memcpy(&b, hi + z, sizeof b);
        std::memcpy(&c, re + z, sizeof c);
        std::memcpy(&d, im + z, sizeof d);
        sum_re += a * c - b * d;
        sum_im += a * d + b * c;
    }
    out[0] = out[1] = 0;
    for (int l = 0; l < kLanes; ++l) {
        out[0] += sum_re[l];
        out[1] += sum_im[l];
    }
}

/// Sums over ix or iy, whole rows at a time.
void sum_across(const LatticeGeometry& g, const FftVector<complex32>& spectrum, int axis, const Kernels& kernels,
                std::vector<FftVector<complex32>>& out) {
    const int half = g.half(), rows = g.size[axis == 0 ? 1 : 0];
    const auto n = static_cast<std::size_t>(half);
    tbb::parallel_for(tbb::blocked_range<int>(0, rows), [&](const tbb::blocked_range<int>& range) {
        std::vector<float> re(n), im(n), acc(2 * n * static_cast<std::size_t>(kernels.outputs));
        for (int row = range.begin(); row < range.end(); ++row) {
            std::fill(acc.begin(), acc.end(), 0.0F);
            for (int bin = 0; bin < kernels.bins; ++bin) {
                const int ix = axis == 0 ? bin : row, iy = axis == 0 ? row : bin;
                const std::size_t at = (static_cast<std::size_t>(ix) * static_cast<std::size_t>(g.size[1]) +
                                        static_cast<std::size_t>(iy)) *
                                       n;
                split_row(half, reinterpret_cast<const float*>(spectrum.data() + at), re.data(), im.data());
                for (int o = 0; o < kernels.outputs; ++o) {
                    float* sum = acc.data() + 2 * n * static_cast<std::size_t>(o);
                    const float* h = kernels.re(o) + bin;
                    add_row(half, h[0], h[kernels.stride], re.data(), im.data(), sum, sum + n);
                }
            }
            for (int o = 0; o < kernels.outputs; ++o) {
                const float* sum = acc.data() + 2 * n * static_cast<std::size_t>(o);
                complex32* to = out[static_cast<std::size_t>(o)].data() + static_cast<std::size_t>(row) * n;
                for (std::size_t z = 0; z < n; ++z) to[z] = {sum[z], sum[n + z]};
            }
        }
    });
}

/// Sums over iz within rows: half of the modes, then the mirrored conjugates for the rest.
void sum_along(const LatticeGeometry& g, const FftVector<complex32>& spectrum, const Kernels& kernels,
               std::vector<FftVector<complex32>>& out) {
    const int nx = g.size[0], ny = g.size[1], half = g.half();
    const auto plane = static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny);
    const auto outputs = static_cast<std::size_t>(kernels.outputs);
    FftScratch<complex32> sums(plane * outputs);  // the outputs of one row lie side by side
    tbb::parallel_for(tbb::blocked_range<int>(0, nx), [&](const tbb::blocked_range<int>& range) {
        std::vector<float> re(static_cast<std::size_t>(kernels.stride)), im(static_cast<std::size_t>(kernels.stride));
        for (int ix = range.begin(); ix < range.end(); ++ix)
            for (int iy = 0; iy < ny; ++iy) {
                const std::size_t r =
                    static_cast<std::size_t>(ix) * static_cast<std::size_t>(ny) + static_cast<std::size_t>(iy);
                split_row(half, reinterpret_cast<const float*>(spectrum.data() + r * static_cast<std::size_t>(half)),
                          re.data(), im.data());
                for (int o = 0; o < kernels.outputs; ++o)
                    dot_row(kernels.stride, kernels.re(o), kernels.re(o) + kernels.stride, re.data(), im.data(),
                            reinterpret_cast<float*>(sums.data() + r * outputs + static_cast<std::size_t>(o)));
            }
    });
    const int lateral_half = ny / 2 + 1;
    tbb::parallel_for(0, nx, [&](int ix) {
        const auto row = [&](int x) {
            return sums.data() + static_cast<std::size_t>(x) * static_cast<std::size_t>(ny) * outputs;
        };
        const complex32 *own = row(ix), *mirror = row(ix == 0 ? 0 : nx - ix);
        for (std::size_t o = 0; o < outputs; ++o) {
            complex32* to = out[o].data() + static_cast<std::size_t>(ix) * static_cast<std::size_t>(lateral_half);
            for (int iy = 0; iy < lateral_half; ++iy)
                to[iy] = own[static_cast<std::size_t>(iy) * outputs + o] +
                         std::conj(mirror[static_cast<std::size_t>(iy == 0 ? 0 : ny - iy) * outputs + o]);
        }
    });
}

std::array<int, 2> lateral_size(const LatticeGeometry& g, const PathRays& rays) {
    return {g.size[rays.lateral()[0]], g.size[rays.lateral()[1]]};
}

/// Lateral half-complex spectra of n, weighted along the rays by each kernel, with the aperture.
std::vector<FftVector<complex32>> lateral_spectra(const LatticeGeometry& g, const FftVector<complex32>& spectrum,
                                                  const PathRays& rays, const Kernels& kernels) {
    const std::array<int, 2> size = lateral_size(g, rays);
    const int half = size[1] / 2 + 1;
    std::vector<FftVector<complex32>> out(
        static_cast<std::size_t>(kernels.outputs),
        FftVector<complex32>(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(half)));
    if (rays.axis == 2)
        sum_along(g, spectrum, kernels, out);
    else
        sum_across(g, spectrum, rays.axis, kernels, out);
    if (!(rays.aperture > 0)) return out;
    std::size_t at = 0;
    for (int i = 0; i < size[0]; ++i)
        for (int j = 0; j < half; ++j, ++at) {
            const double k0 = portable::kTwoPi * signed_index(i, size[0]) / g.period[rays.lateral()[0]];
            const double k1 = portable::kTwoPi * j / g.period[rays.lateral()[1]];
            const auto filter = static_cast<float>(jinc(0.5 * rays.aperture * std::sqrt(k0 * k0 + k1 * k1)));
            for (auto& o : out) o[at] *= filter;
        }
    return out;
}

/// The derivative of a lateral spectrum along lateral axis e.
FftVector<complex32> differentiate(const FftVector<complex32>& spectrum, const LatticeGeometry& g, const PathRays& rays,
                                   int e) {
    const std::array<int, 2> size = lateral_size(g, rays);
    const int half = size[1] / 2 + 1;
    FftVector<complex32> out(spectrum.size());
    std::size_t at = 0;
    for (int i = 0; i < size[0]; ++i)
        for (int j = 0; j < half; ++j, ++at) {
            const auto k = static_cast<float>(bin_wavenumber(e == 0 ? i : j, size[e], g.period[rays.lateral()[e]]));
            out[at] = {-k * spectrum[at].imag(), k * spectrum[at].real()};
        }
    return out;
}

SplinePlan2 spline_plan(const LatticeGeometry& g, const PathRays& rays, int padding) {
    const std::array<int, 2> size = lateral_size(g, rays);
    return {size[0], size[1], padding};
}

/// Makes splines over the lateral axes, whose arguments are periods.
struct Splines {
    const SplinePlan2& plan;
    const LatticeGeometry& g;
    const PathRays& rays;

    PeriodicSpline2 operator()(FftVector<complex32> spectrum) const { return {plan, std::move(spectrum), 1, 1}; }
    std::array<PeriodicSpline2, 2> gradient(const FftVector<complex32>& potential) const {
        return {(*this)(differentiate(potential, g, rays, 0)), (*this)(differentiate(potential, g, rays, 1))};
    }
};

/// The variance of the two lateral components, and of the error of splines on a lattice `padding` times finer: sums of
/// slope² power over the lateral modes. power(k∥) weights the ray axis.
struct LateralVariance {
    std::array<double, 2> value{}, error{};
};
template <class Power>
std::vector<LateralVariance> lateral_variances(const LatticeField& field, const PathRays& rays, Power&& power,
                                               std::span<const int> paddings) {
    const LatticeGeometry& g = field.geometry();
    const std::array<int, 2> lateral = rays.lateral(), size = lateral_size(g, rays);
    const auto signs = [](int m) { return m == 0 ? 1.0 : 2.0; };
    const int last = largest_bending_mode(g.size[rays.axis]);
    std::vector<double> weight;
    for (int m = 0; m <= last; ++m) weight.push_back(power(portable::kTwoPi * m / g.period[rays.axis]) * signs(m));
    std::vector<std::array<std::vector<double>, 2>> error(paddings.size());
    for (std::size_t p = 0; p < paddings.size(); ++p)
        for (int e = 0; e < 2; ++e)
            for (int m = 0; m <= largest_bending_mode(size[e]); ++m)
                error[p][e].push_back(spline_error(static_cast<double>(m) / (size[e] * paddings[p])));
    std::vector<LateralVariance> out(paddings.size());
    for (int m0 = 0; m0 <= largest_bending_mode(size[0]); ++m0)
        for (int m1 = 0; m1 <= largest_bending_mode(size[1]); ++m1) {
            const std::array<int, 2> m{m0, m1};
            const double k0 = portable::kTwoPi * m0 / g.period[lateral[0]],
                         k1 = portable::kTwoPi * m1 / g.period[lateral[1]];
            const double filter = rays.aperture > 0 ? jinc(0.5 * rays.aperture * std::sqrt(k0 * k0 + k1 * k1)) : 1;
            double sum = 0;
            std::array<int, 3> mode{};
            for (int e = 0; e < 2; ++e) mode[lateral[e]] = m[e];
            for (int l = 0; l <= last; ++l) {
                mode[rays.axis] = l;
                sum += weight[static_cast<std::size_t>(l)] * field.mode_variance(mode[0], mode[1], mode[2]);
            }
            sum *= filter * filter * signs(m0) * signs(m1);
            for (int e = 0; e < 2; ++e) {
                const double k = e == 0 ? k0 : k1;
                for (std::size_t p = 0; p < paddings.size(); ++p) {
                    const double e0 = error[p][0][static_cast<std::size_t>(m0)],
                                 e1 = error[p][1][static_cast<std::size_t>(m1)];
                    out[p].value[e] += k * k * sum;
                    out[p].error[e] += k * k * sum * (e0 * e0 + e1 * e1);
                }
            }
        }
    return out;
}

template <class Power>
int padding_for(const LatticeField& field, const PathRays& rays, Power&& power, double tolerance) {
    const double error = kSplineShare * tolerance;
    constexpr std::array paddings{1, 2, 3, 4, 6, kLargestPathPadding};
    const auto variances = lateral_variances(field, rays, power, paddings);
    for (std::size_t p = 0; p < paddings.size(); ++p) {
        bool good = true;
        for (int e = 0; e < 2; ++e) good = good && variances[p].error[e] <= error * error * variances[p].value[e];
        if (good) return paddings[p];
    }
    return kLargestPathPadding;
}

}  // namespace

std::vector<PathSpectrum> path_spectra(const LatticeField& field, const FftVector<complex32>& spectrum,
                                       const PathRays& rays, std::span<const double> u) {
    const LatticeGeometry& g = field.geometry();
    const int count = static_cast<int>(u.size());
    Kernels kernels(2 * count, rays.axis == 2 ? g.half() : g.size[rays.axis]);
    for (int i = 0; i < count; ++i) {
        const double path = u[static_cast<std::size_t>(i)];
        float* h = kernels.re(2 * i);
        float* slope = kernels.re(2 * i + 1);
        fill_kernel(
            g, rays, rays.z0, [&](double k) { return path_kernel(k, path); }, h, h + kernels.stride);
        fill_kernel(
            g, rays, rays.z0, [&](double k) { return path_kernel_derivative(k, path); }, slope, slope + kernels.stride);
    }
    std::vector<FftVector<complex32>> sums = lateral_spectra(g, spectrum, rays, kernels);
    std::vector<PathSpectrum> out;
    for (std::size_t i = 0; i < u.size(); ++i) out.push_back({std::move(sums[2 * i]), std::move(sums[2 * i + 1])});
    return out;
}

std::vector<PathTable> path_tables(const LatticeField& field, double t, const PathRays& rays, std::span<const double> u,
                                   int padding) {
    const LatticeGeometry& g = field.geometry();
    const SplinePlan2 plan = spline_plan(g, rays, padding > 0 ? padding : path_padding(field, rays, u));
    const Splines splines{plan, g, rays};
    const std::vector<PathSpectrum> spectra = path_spectra(field, field.bending_spectrum_at(t), rays, u);
    std::vector<PathTable> tables(u.size());
    tbb::parallel_for(std::size_t{0}, u.size(), [&](std::size_t i) {
        tables[i].u = u[i];
        tables[i].displacement = splines.gradient(spectra[i].potential);
        tables[i].slope = splines.gradient(spectra[i].slope);
        if (field.spec().falloff) {
            tables[i].potential = splines(spectra[i].potential);
            tables[i].potential_slope = splines(spectra[i].slope);
        }
    });
    return tables;
}

SliceTable slice_table(const LatticeField& field, double t, const PathRays& rays, double w, int padding) {
    const LatticeGeometry& g = field.geometry();
    const auto flat = [](double) { return std::complex<double>(1, 0); };
    const SplinePlan2 plan = spline_plan(g, rays,
                                         padding > 0 ? padding
                                                     : padding_for(
                                                           field, rays, [](double) { return 1.0; }, kPathTableError));
    const Splines splines{plan, g, rays};
    Kernels kernels(1, rays.axis == 2 ? g.half() : g.size[rays.axis]);
    fill_kernel(g, rays, rays.z0 + rays.sign * w, flat, kernels.re(0), kernels.re(0) + kernels.stride);
    const FftVector<complex32> slice = std::move(lateral_spectra(g, field.bending_spectrum_at(t), rays, kernels)[0]);
    SliceTable table{splines.gradient(slice), {}};
    if (field.spec().falloff) table.index = splines(slice);
    return table;
}

std::array<double, 2> LatticeField::displacement_variance(int axis, double u, double aperture) const {
    const auto power = [u](double k) { return std::norm(path_kernel(k, u)); };
    return lateral_variances(*this, PathRays{axis, 1, 0, aperture}, power, std::array{1})[0].value;
}

std::array<double, 2> slice_variance(const LatticeField& field, const PathRays& rays) {
    return lateral_variances(
               field, rays, [](double) { return 1.0; }, std::array{1})[0]
        .value;
}

int path_padding(const LatticeField& field, const PathRays& rays, std::span<const double> u, double tolerance) {
    double least = 0, greatest = 0;
    for (const double path : u) {
        if (path > 0 && (least == 0 || path < least)) least = path;
        greatest = std::max(greatest, path);
    }
    int padding = 1;
    for (const double path : {least, greatest})
        if (path > 0)
            padding = std::max(
                padding, padding_for(
                             field, rays, [path](double k) { return std::norm(path_kernel(k, path)); }, tolerance));
    return padding;
}

}  // namespace eikonal
