// Spectra, compared with their defining integrals: the Kolmogorov constant, the slopes, the cut-offs.
#include "noise/turbulence/parameters/spectrum.h"

#include <gtest/gtest.h>

#include <cmath>

#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {
namespace {

TurbulenceSpec air(double outer, double inner) {
    TurbulenceSpec spec;
    spec.cn2 = 2.5e-13;
    spec.outer_scale = outer;
    spec.inner_scale = inner;
    return spec;
}

/// D_n(r) = 8π ∫ Φ(k) k² (1 - sin(kr)/(kr)) dk by the midpoint rule in ln k.
double structure_function(const Spectrum& spectrum, double r, double lowest, double highest) {
    constexpr int kSteps = 400000;
    const double step = std::log(highest / lowest) / kSteps;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double k = lowest * std::exp((i + 0.5) * step), x = k * r;
        const double weight = x < 1e-3 ? x * x / 6 : 1 - std::sin(x) / x;
        sum += spectrum(k * k) * k * k * k * weight;
    }
    return 8 * M_PI * sum * step;
}

TEST(Spectrum, StructureFunctionIsTwoThirdsInTheInertialRange) {
    const TurbulenceSpec spec = air(1e5, 1e-5);
    const Spectrum spectrum(spec, 0);
    for (const double r : {0.05, 0.5})
        EXPECT_NEAR(structure_function(spectrum, r, 1e-7, 1e7) / (spec.cn2 * std::pow(r, 2.0 / 3)), 1, 2e-3) << r;
    EXPECT_NEAR(kKolmogorovConstant, std::tgamma(8.0 / 3) * std::sin(M_PI / 3) / (4 * M_PI * M_PI), 1e-7);
}

TEST(Spectrum, VonKarmanIsItsFormula) {
    const TurbulenceSpec spec = air(0.8, 0.03);
    const Spectrum spectrum(spec, 0);
    for (const double k : {0.0, 0.1, 2 * M_PI / 0.8, 30.0, 5.92 / 0.03, 600.0}) {
        const double k0 = 2 * M_PI / 0.8, km = 5.92 / 0.03;
        const double expected =
            0.0330054 * spec.cn2 * std::pow(k * k + k0 * k0, -11.0 / 6) * std::exp(-k * k / (km * km));
        EXPECT_NEAR(spectrum(k * k) / expected, 1, 1e-13) << k;
    }
}

TEST(Spectrum, PaperIsAPowerLawAboveItsLowestWavenumber) {
    TurbulenceSpec spec;
    spec.spectrum = SpectrumKind::Paper;
    spec.strength = 3e-11;
    const Spectrum spectrum(spec, 12.5);
    EXPECT_EQ(spectrum(0), 0);
    EXPECT_EQ(spectrum(12.4 * 12.4), 0);
    for (const double k : {12.5, 13.0, 1e3})
        EXPECT_NEAR(spectrum(k * k) / (3e-11 * std::pow(k, -11.0 / 3)), 1, 1e-13) << k;
    EXPECT_EQ(Spectrum(spec, 0)(0), 0);
}

TEST(Spectrum, ZeroStrengthIsZero) {
    TurbulenceSpec spec = air(1, 0.01);
    spec.cn2 = 0;
    EXPECT_EQ(Spectrum(spec, 0)(10), 0);
    spec.spectrum = SpectrumKind::Paper;
    spec.strength = 0;
    EXPECT_EQ(Spectrum(spec, 0)(10), 0);
}

TEST(TemporalWeight, IsAGaussianOfTheEddysOwnRate) {
    EXPECT_NEAR(temporal_weight(3, 0.5, 16), std::exp(-9.0 / 8), 1e-15);
    EXPECT_EQ(temporal_weight(0, 0, 16), 1);
    EXPECT_EQ(temporal_weight(1e-9, 0, 16), 0);
    EXPECT_EQ(temporal_weight(1, 1e-300, 1e-300), 0);
    EXPECT_NEAR(temporal_weight(100, 1e12, 1), 1, 1e-7);
}

}  // namespace
}  // namespace eikonal
