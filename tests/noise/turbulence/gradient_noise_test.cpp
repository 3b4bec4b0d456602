// Gradient noise: variance, structure function, gradient, evolution and motion.
#include "noise/turbulence/gradient_noise/gradient_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "noise/base/error.h"
#include "noise/math/random.h"
#include "noise/turbulence/parameters/spectrum.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {
namespace {

TurbulenceSpec noise_spec() {
    TurbulenceSpec spec;
    spec.form = TurbulenceForm::GradientNoise;
    spec.cn2 = 1e-12;
    spec.outer_scale = 2;
    spec.inner_scale = 0.01;
    spec.alpha = 0.04;
    return spec;
}

dvec3 random_point(const RandomStream& stream, std::uint64_t i, double extent) {
    return extent * dvec3(stream.uniform(3 * i), stream.uniform(3 * i + 1), stream.uniform(3 * i + 2));
}

TEST(GradientNoise, VarianceIsThatOfTheSpectrum) {
    // Also a test of kGradientNoiseVariance: a single octave, then many. 4e4 cells: 1 % at three sigma.
    for (const double inner : {0.6, 0.02}) {
        TurbulenceSpec spec = noise_spec();
        spec.inner_scale = inner;
        const GradientNoiseField field(spec);
        const RandomStream stream(7, "test points");
        double sum = 0;
        constexpr int n = 100000;
        for (int i = 0; i < n; ++i) {
            const double value = field.sample(random_point(stream, i, 1e4), 0.37 * i).n;
            sum += value * value;
        }
        EXPECT_NEAR(sum / n / field.variance(), 1, 0.02) << inner;
    }
}

TEST(GradientNoise, VarianceMatchesClosedForm) {
    // ∫Φ d³k for l0 → 0: 2π 0.0330054 Cn² k0^(-2/3) B(3/2, 1/3)
    TurbulenceSpec spec = noise_spec();
    spec.inner_scale = 1e-6;
    const double beta = std::tgamma(1.5) * std::tgamma(1.0 / 3) / std::tgamma(11.0 / 6);
    const double expected =
        2 * M_PI * kKolmogorovConstant * spec.cn2 * std::pow(2 * M_PI / spec.outer_scale, -2.0 / 3) * beta;
    EXPECT_NEAR(GradientNoiseField(spec).variance() / expected, 1, 1e-3);
    spec.spectrum = SpectrumKind::Paper;
    spec.lowest_wavenumber = 3;
    spec.inner_scale = 0.01;
    const double kl = 3 * 2 * M_PI / spec.outer_scale, kh = 592;
    EXPECT_NEAR(GradientNoiseField(spec).variance() /
                    (6 * M_PI * spec.strength * (std::pow(kl, -2.0 / 3) - std::pow(kh, -2.0 / 3))),
                1, 1e-3);
    spec.lowest_wavenumber = 0;
    EXPECT_THROW(GradientNoiseField{spec}, UserError);
}

TEST(GradientNoise, GradientIsTheDerivativeOfTheValue) {
    TurbulenceSpec spec = noise_spec();
    spec.falloff = Falloff{{0, 0, 0}, {0, 1, 0}, 0.7};
    spec.velocity = {0.1, 0.2, -0.3};
    const GradientNoiseField field(spec);
    const RandomStream stream(3, "test points");
    const double h = 1e-5;
    for (int i = 0; i < 200; ++i) {
        const dvec3 x = random_point(stream, i, 3) + dvec3(0, 0.01, 0);
        const IndexSample s = field.sample(x, 1.7);
        dvec3 difference;
        for (int axis = 0; axis < 3; ++axis) {
            dvec3 e(0);
            e[axis] = h;
            difference[axis] = (field.sample(x + e, 1.7).n - field.sample(x - e, 1.7).n) / (2 * h);
        }
        EXPECT_LT(glm::length(difference - s.gradient),
                  1e-4 * glm::length(s.gradient) + 1e-4 * std::sqrt(field.variance()) / 0.1);
    }
}

TEST(GradientNoise, StructureFunctionIsKolmogorov) {
    const TurbulenceSpec spec = noise_spec();
    const GradientNoiseField field(spec);
    const RandomStream stream(5, "test points");
    double first = 0, last = 0, r_first = 0, r_last = 0;
    for (double r = 2 * spec.inner_scale; r <= spec.outer_scale / 8 * 1.0001; r *= std::sqrt(2.0)) {
        double sum = 0;
        constexpr int n = 20000;
        for (int i = 0; i < n; ++i) {
            const dvec3 x = random_point(stream, 2 * i, 1e4);
            const dvec3 direction = glm::normalize(random_point(stream, 2 * i + 1, 2) - dvec3(1, 1, 1));
            const double d = field.sample(x + r * direction, 0.37 * i).n - field.sample(x, 0.37 * i).n;
            sum += d * d;
        }
        const double structure = sum / n;
        EXPECT_NEAR(structure / (spec.cn2 * std::pow(r, 2.0 / 3)), 1, kStructureError) << r;
        if (first == 0) first = structure, r_first = r;
        last = structure, r_last = r;
    }
    EXPECT_NEAR(std::log(last / first) / std::log(r_last / r_first), 2.0 / 3, 0.08);
}

TEST(GradientNoise, EvolvesAtTheRateOfAlpha) {
    // <(∂n/∂t)²> = (α/2) <|∇n|²> for modes of correlation exp(-αk²t²/4)
    const TurbulenceSpec spec = noise_spec();
    const GradientNoiseField field(spec);
    const RandomStream stream(9, "test points");
    double rate2 = 0, gradient2 = 0;
    const double h = 1e-4;
    for (int i = 0; i < 50000; ++i) {
        const dvec3 x = random_point(stream, i, 1e4);
        const double t = 0.37 * i;  // every phase of the time cells
        const double rate = (field.sample(x, t + h).n - field.sample(x, t - h).n) / (2 * h);
        const IndexSample s = field.sample(x, t);
        rate2 += rate * rate;
        gradient2 += glm::dot(s.gradient, s.gradient);
    }
    EXPECT_NEAR(rate2 / (0.5 * spec.alpha * gradient2), 1, 0.04);
}

TEST(GradientNoise, VelocityTranslatesAndFrozenStays) {
    TurbulenceSpec spec = noise_spec();
    spec.alpha = 0;
    const GradientNoiseField still(spec);
    spec.velocity = {0.3, -0.2, 0.1};
    const GradientNoiseField moving(spec);
    const double scale = std::sqrt(still.variance());
    for (int i = 0; i < 50; ++i) {
        const dvec3 x = random_point(RandomStream(1, "test points"), i, 5);
        EXPECT_EQ(still.sample(x, 0).n, still.sample(x, 100).n);
        EXPECT_NEAR(moving.sample(x + 7.3 * spec.velocity, 7.3).n, still.sample(x, 0).n, 1e-9 * scale);
    }
}

TEST(GradientNoise, SeedsDifferAndFarPointsAreFinite) {
    TurbulenceSpec spec = noise_spec();
    const GradientNoiseField a(spec), same(spec);
    spec.seed = 2;
    const GradientNoiseField b(spec);
    const dvec3 x(0.3, 0.4, 0.5);
    EXPECT_EQ(a.sample(x, 1).n, same.sample(x, 1).n);
    EXPECT_NE(a.sample(x, 1).n, b.sample(x, 1).n);
    const double bound = 20 * std::sqrt(a.variance());
    for (const double far : {1e9, -1e9, 1e30, -1e300}) {
        const IndexSample s = a.sample({far, 1, -far}, far);
        EXPECT_LT(std::abs(s.n), bound);
        EXPECT_TRUE(std::isfinite(glm::length(s.gradient)));
    }
    // still varies 1e9 m away
    EXPECT_NE(a.sample({1e9, 0, 0}, 0).n, a.sample({1e9 + 0.001, 0, 0}, 0).n);
}

TEST(GradientNoise, ZeroStrengthIsZero) {
    TurbulenceSpec spec = noise_spec();
    spec.cn2 = 0;
    const IndexSample s = GradientNoiseField(spec).sample({1, 2, 3}, 4);
    EXPECT_EQ(s.n, 0);
    EXPECT_EQ(glm::length(s.gradient), 0);
}

}  // namespace
}  // namespace eikonal
