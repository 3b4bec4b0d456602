/// The reference for lattice fields. It is the trigonometric sum itself, term by term, in double precision and with the
/// C library's sine. It shares only the layout of the spectrum with the library. Nyquist modes are cosines in the
/// index, and bend no light.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "noise/turbulence/lattice/lattice.h"
#include "noise/turbulence/lattice/lattice_instant.h"

namespace eikonal {

class TrigonometricSum {
  public:
    TrigonometricSum(const FftVector<complex32>& spectrum, const LatticeGeometry& geometry)
        : spectrum_(spectrum.begin(), spectrum.end()), g_(geometry) {}

    /// The n that bends light, and its gradient.
    IndexSample sample(const dvec3& x) const { return sum(x, false); }
    /// n - n_ambient with all modes, Nyquist's included.
    double index(const dvec3& x) const { return sum(x, true).n; }

  private:
    IndexSample sum(const dvec3& x, bool nyquist_too) const {
        std::array<std::vector<std::complex<double>>, 3> value, slope;
        for (int axis = 0; axis < 3; ++axis) {
            const int n = g_.size[axis], count = axis == 2 ? n / 2 + 1 : n;
            for (int i = 0; i < count; ++i) {
                const double k = 2 * M_PI * (2 * i <= n ? i : i - n) / g_.period[axis];
                const std::complex<double> wave = std::polar(1.0, k * x[axis]);
                const std::complex<double> e = 2 * i != n ? wave : nyquist_too ? wave.real() : 0.0;
                value[axis].push_back(e);
                slope[axis].push_back(std::complex<double>(0, k) * e);
            }
        }
        IndexSample out{0, {0, 0, 0}};
        std::size_t at = 0;
        for (int ix = 0; ix < g_.size[0]; ++ix)
            for (int iy = 0; iy < g_.size[1]; ++iy)
                for (int iz = 0; iz <= g_.size[2] / 2; ++iz, ++at) {
                    const double both = iz == 0 || 2 * iz == g_.size[2] ? 1 : 2;
                    const auto &vx = value[0][ix], &vy = value[1][iy], &vz = value[2][iz];
                    const std::complex<double> a = both * spectrum_[at];
                    out.n += std::real(a * vx * vy * vz);
                    out.gradient.x += std::real(a * slope[0][ix] * vy * vz);
                    out.gradient.y += std::real(a * vx * slope[1][iy] * vz);
                    out.gradient.z += std::real(a * vx * vy * slope[2][iz]);
                }
        return out;
    }

    std::vector<std::complex<double>> spectrum_;
    LatticeGeometry g_;
};

/// A plain forward transform, nx × ny × nz, axis by axis.
inline std::vector<std::complex<double>> forward_transform(std::span<const float> samples, const LatticeGeometry& g) {
    std::vector<std::complex<double>> data(samples.begin(), samples.end());
    std::size_t stride = data.size();
    for (int axis = 0; axis < 3; ++axis) {
        const auto n = static_cast<std::size_t>(g.size[axis]);
        stride /= n;
        std::vector<std::complex<double>> out(data.size());
        for (std::size_t i = 0; i < data.size(); ++i) {
            const std::size_t k = i / stride % n, base = i - k * stride;
            for (std::size_t j = 0; j < n; ++j)
                out[i] += data[base + j * stride] *
                          std::polar(1.0, -2 * M_PI * static_cast<double>(j * k % n) / static_cast<double>(n));
        }
        data = std::move(out);
    }
    return data;
}

}  // namespace eikonal
