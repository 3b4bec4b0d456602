#include "noise/turbulence/lattice/lattice_instant.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "noise/math/portable_math.h"

namespace eikonal {
namespace {

std::array<int, 3> spatial_size(const LatticeGeometry& g) {
    return {g.size[0], g.size[1], g.size[2]};
}

}  // namespace

SplineError lattice_spline_error(const LatticeField& field, int padding) {
    const LatticeGeometry& g = field.geometry();
    // Squared errors of the spline's value and slope along each axis.
    std::array<std::vector<double>, 3> value, slope;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (int m = 0; m <= largest_bending_mode(g.size[axis]); ++m) {
            const double turns = static_cast<double>(m) / (g.size[axis] * padding);
            value[axis].push_back(spline_error(turns) * spline_error(turns));
            slope[axis].push_back(spline_slope_error(turns) * spline_slope_error(turns));
        }
    double error = 0, power = 0, bend = 0;
    std::array<std::size_t, 3> m{};
    const auto count = [&](std::size_t axis) { return m[axis] == 0 ? 1.0 : 2.0; };
    for (m[0] = 0; m[0] < value[0].size(); ++m[0])
        for (m[1] = 0; m[1] < value[1].size(); ++m[1])
            for (m[2] = 0; m[2] < value[2].size(); ++m[2]) {
                const double variance =
                    count(0) * count(1) * count(2) *
                    field.mode_variance(static_cast<int>(m[0]), static_cast<int>(m[1]), static_cast<int>(m[2]));
                const double values = value[0][m[0]] + value[1][m[1]] + value[2][m[2]];
                double off = 0, k2 = 0;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const double k = bin_wavenumber(static_cast<int>(m[axis]), g.size[axis], g.period[axis]);
                    off += variance * k * k * (values - value[axis][m[axis]] + slope[axis][m[axis]]);
                    k2 += k * k;
                }
                error += off;
                power += variance * k2;
                if (k2 > 0) bend += portable::kPi * off / std::sqrt(k2);
            }
    return power > 0 ? SplineError{std::sqrt(error / power), std::sqrt(bend)} : SplineError{};
}

LatticeInstant::LatticeInstant(const LatticeField& field, double t, int padding)
    : LatticeInstant(field, t, Padding{padding, padding, padding}) {}

LatticeInstant::LatticeInstant(const LatticeField& field, double t, const Padding& padding)
    : period_{field.geometry().period[0], field.geometry().period[1], field.geometry().period[2]},
      falloff_(field.spec().falloff),
      spline_(field.bending_spectrum_at(t), spatial_size(field.geometry()), padding) {}

IndexSample LatticeInstant::sample(const dvec3& x) const {
    const PeriodicSpline3::Sample s = spline_.sample(x / period_);
    return with_falloff(falloff_, x, IndexSample{s.value, s.gradient / period_});
}

IndexSample LatticeInstant::smooth_sample(const dvec3& x) const {
    const IndexSample s = spline_.smooth_sample(x / period_);
    return with_falloff(falloff_, x, IndexSample{s.n, s.gradient / period_});
}

IndexJet LatticeInstant::jet(const dvec3& x) const {
    IndexJet jet = spline_.jet(x / period_);
    jet.gradient /= period_;
    for (int i = 0; i < 3; ++i) jet.hessian[i] /= period_ * period_[i];
    return with_falloff(falloff_, x, jet);
}

FftVector<float> node_field(const LatticeField& field, double t, Component what) {
    const LatticeGeometry& g = field.geometry();
    const auto half = static_cast<std::size_t>(g.half());
    const FftVector<complex32> spectrum =
        what == Component::Index ? field.spectrum_at(t) : field.bending_spectrum_at(t);
    const FftPlan plan(FftPlan::Kind::ComplexToReal, spatial_size(g));
    const auto transform = [&](Component component) {
        FftVector<complex32> modes = spectrum;
        if (component != Component::Index) {
            const int axis = static_cast<int>(component) - static_cast<int>(Component::ForceX);
            for (std::size_t r = 0; r < modes.size(); ++r) {
                const auto z = static_cast<int>(r % half),
                           y = static_cast<int>(r / half % static_cast<std::size_t>(g.size[1]));
                const auto x = static_cast<int>(r / half / static_cast<std::size_t>(g.size[1]));
                const int bin = axis == 0 ? x : (axis == 1 ? y : z);
                const auto k = static_cast<float>(bin_wavenumber(bin, g.size[axis], g.period[axis]));
                modes[r] = {-k * modes[r].imag(), k * modes[r].real()};
            }
        }
        FftVector<float> samples(plan.sample_size());
        plan.execute(modes.data(), samples.data());
        return samples;
    };
    FftVector<float> out = transform(what);
    if (!field.spec().falloff) return out;
    const FftVector<float> index = what == Component::Index ? FftVector<float>() : transform(Component::Index);
    tbb::parallel_for(0, g.size[0], [&](int ix) {
        auto at =
            static_cast<std::size_t>(ix) * static_cast<std::size_t>(g.size[1]) * static_cast<std::size_t>(g.size[2]);
        for (int iy = 0; iy < g.size[1]; ++iy)
            for (int iz = 0; iz < g.size[2]; ++iz, ++at) {
                const IndexSample f =
                    falloff_at(*field.spec().falloff, {ix * g.spacing(0), iy * g.spacing(1), iz * g.spacing(2)});
                double value = out[at] * f.n;
                if (what != Component::Index)
                    value += index[at] * f.gradient[static_cast<int>(what) - static_cast<int>(Component::ForceX)];
                out[at] = static_cast<float>(value);
            }
    });
    return out;
}

}  // namespace eikonal
