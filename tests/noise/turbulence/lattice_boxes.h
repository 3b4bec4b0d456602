/// Small lattices, and comparisons of their node values, that the tests of lattices share.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "noise/turbulence/lattice/lattice.h"

namespace eikonal {

inline TurbulenceSpec air(std::uint64_t seed = 1, double alpha = 0.5) {
    TurbulenceSpec spec;
    spec.seed = seed;
    spec.cn2 = 1e-12;
    spec.outer_scale = 0.7;
    spec.inner_scale = 0.2;
    spec.alpha = alpha;
    return spec;
}

inline LatticeGeometry box(int nx, int ny, int nz, int nt) {
    return {{nx, ny, nz, nt}, {1.0, 1.3, 0.9, 2.0}};
}

inline FftVector<float> samples_of(FftVector<complex32> spectrum, const LatticeGeometry& g) {
    const FftPlan plan(FftPlan::Kind::ComplexToReal, std::array{g.size[0], g.size[1], g.size[2]});
    FftVector<float> out(plan.sample_size());
    plan.execute(spectrum.data(), out.data());
    return out;
}

inline double rms(std::span<const float> v) {
    double sum = 0;
    for (const float x : v) sum += double{x} * x;
    return std::sqrt(sum / static_cast<double>(v.size()));
}

inline double worst_difference(std::span<const float> a, std::span<const float> b) {
    EXPECT_EQ(a.size(), b.size());
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(double{a[i]} - b[i]));
    return worst;
}

}  // namespace eikonal
