// Path tables, compared with Eq. 7 integrated along straight rays through the trigonometric sum (its own
// double-precision code); the kernel h(k, u), compared with quadrature in long double; the aperture's jinc, compared
// with its integral.
#include "noise/turbulence/lattice/path_tables.h"

#include <gtest/gtest.h>

#include <cmath>

#include "noise/math/bessel.h"
#include "noise/math/random.h"
#include "noise/turbulence/lattice/path_kernel.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "tests/noise/trigonometric_sum.h"

namespace eikonal {
namespace {

TurbulenceSpec air() {
    TurbulenceSpec spec;
    spec.cn2 = 1e-12;
    spec.outer_scale = 0.7;
    spec.inner_scale = 0.2;
    spec.alpha = 0.5;
    spec.velocity = {0.2, 0.1, -0.3};
    return spec;
}

/// 16-point Gauss-Legendre abscissae and weights on [0, 1], by Newton on the Legendre polynomial.
const std::vector<std::pair<long double, long double>>& gauss() {
    static const auto rule = [] {
        constexpr int n = 16;
        std::vector<std::pair<long double, long double>> out;
        for (int i = 1; i <= n; ++i) {
            long double x = cosl(M_PIl * (i - 0.25L) / (n + 0.5L)), slope = 1;
            for (int iteration = 0; iteration < 20; ++iteration) {
                long double p0 = 1, p1 = x;
                for (int k = 2; k <= n; ++k) {
                    const long double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
                    p0 = p1;
                    p1 = p2;
                }
                slope = n * (x * p1 - p0) / (x * x - 1);
                x -= p1 / slope;
            }
            out.emplace_back((1 + x) / 2, 1 / ((1 - x * x) * slope * slope));
        }
        return out;
    }();
    return rule;
}

template <class F>
auto integrate(F&& f, long double length, int panels) {
    decltype(f(0.0L)) sum{};
    for (int p = 0; p < panels; ++p)
        for (const auto& [x, w] : gauss()) sum += f((p + x) * length / panels) * (w * length / panels);
    return sum;
}

TEST(PathKernel, EqualsItsIntegralOverManyDecades) {
    using Complex = std::complex<long double>;
    for (int decade = -18; decade <= 2; ++decade)
        for (const double mantissa : {1.0, 1.7, 3.3, 9.99, 6.283185307179586}) {
            const double theta = mantissa * std::pow(10.0, decade);
            for (const double u : {1.0, 1e-9, 37.5, 1e9})
                for (const int sign : {1, -1}) {
                    const double k = sign * (theta / u);
                    const int panels = 2 + static_cast<int>(theta / 2);
                    const long double phase = static_cast<long double>(k * u);
                    const auto wave = [&](long double w) { return Complex(cosl(phase * w), sinl(phase * w)); };
                    const Complex h = integrate([&](long double w) { return (1 - w) * wave(w); }, 1, panels);
                    const Complex slope = integrate(wave, 1, panels);
                    const auto scaled = Complex(path_kernel(k, u)) / (static_cast<long double>(u) * u);
                    const auto scaled_slope = Complex(path_kernel_derivative(k, u)) / static_cast<long double>(u);
                    EXPECT_LT(std::abs(scaled - h), kPathKernelError * std::abs(h)) << k << ' ' << u;
                    EXPECT_LT(std::abs(scaled_slope - slope), kPathKernelError * std::abs(slope) + 1e-15L)
                        << k << ' ' << u;
                }
        }
}

TEST(PathKernel, Limits) {
    EXPECT_EQ(path_kernel(0, 3), std::complex<double>(4.5, 0));
    EXPECT_EQ(path_kernel_derivative(0, 3), std::complex<double>(3, 0));
    EXPECT_EQ(path_kernel(7, 0), std::complex<double>(0, 0));
    EXPECT_EQ(path_kernel_derivative(7, 0), std::complex<double>(0, 0));
    // u → ∞: iu/k
    EXPECT_NEAR(path_kernel(1, 1e9).imag(), 1e9, 2);
    EXPECT_NEAR(path_kernel(1e9, 1e9).imag(), 1, 1e-12);
    for (const double k : {5e-324, 1e-300, 1e-9, 1.0, 1e9, 1e150, 1e300})
        for (const double u : {0.0, 5e-324, 1e-200, 1.0, 1e9, 1e100}) {
            const auto h = path_kernel(k, u), slope = path_kernel_derivative(k, u);
            EXPECT_TRUE(std::isfinite(h.real()) && std::isfinite(h.imag())) << k << ' ' << u;
            EXPECT_TRUE(std::isfinite(slope.real()) && std::isfinite(slope.imag())) << k << ' ' << u;
        }
}

TEST(Jinc, EqualsItsIntegral) {
    EXPECT_EQ(jinc(0), 1);
    // 2 J1(x)/x = (2/π) ∫₀^π cos(x cos θ) sin²θ dθ; the trapezoidal rule is exact once it has more points than x
    for (double x = 1e-8; x < 3000; x = x * 1.013 + 0.003) {
        const int points = 64 + static_cast<int>(x);
        long double sum = 0;
        for (int i = 1; i < points; ++i) {
            const long double theta = M_PIl * i / points;
            sum += cosl(x * cosl(theta)) * sinl(theta) * sinl(theta);
        }
        EXPECT_NEAR(jinc(x), static_cast<double>(2 * sum / points), kJincError) << x;
        EXPECT_EQ(jinc(-x), jinc(x));
    }
    for (const double x : {1e8, 1e12, 1e15, 1e300}) EXPECT_LT(std::abs(jinc(x)), 1.7 * std::pow(x, -1.5) + 1e-18);
}

/// Eq. 7 and its derivative, and the potentials, along a ray through the trigonometric sum.
struct Reference {
    std::array<double, 2> displacement{}, slope{};
    double potential = 0, potential_slope = 0;
};
Reference integrate_ray(const TrigonometricSum& sum, const PathRays& rays, dvec3 start, double u) {
    const auto lateral = rays.lateral();
    start[rays.axis] = rays.z0;
    Reference out;
    const int panels = 2 + static_cast<int>(4 * u);
    for (int p = 0; p < panels; ++p)
        for (const auto& [x, weight] : gauss()) {
            const auto w = static_cast<double>((p + x) * u / panels), dw = static_cast<double>(weight * u / panels);
            dvec3 at = start;
            at[rays.axis] += rays.sign * w;
            const IndexSample s = sum.sample(at);
            for (int e = 0; e < 2; ++e) {
                out.displacement[e] += dw * (u - w) * s.gradient[lateral[e]];
                out.slope[e] += dw * s.gradient[lateral[e]];
            }
            out.potential += dw * (u - w) * s.n;
            out.potential_slope += dw * s.n;
        }
    return out;
}

struct Case {
    std::array<int, 4> size;
    PathRays rays;
};

class PathTables : public testing::TestWithParam<Case> {};

TEST_P(PathTables, EqualQuadratureAtNodesAndBetween) {
    const auto& [size, rays] = GetParam();
    const LatticeGeometry g{size, {1.0, 1.3, 0.9, 2.0}};
    TurbulenceSpec spec = air();
    spec.falloff = Falloff{{0, 0, 0}, {0, 1, 0}, 1e9};
    const LatticeField field(spec, g);
    constexpr double kTime = 0.37;
    const TrigonometricSum sum(field.spectrum_at(kTime), g);
    const std::vector<double> u{0, 0.01, 0.3, 1.7};
    const auto tables = path_tables(field, kTime, rays, u);
    ASSERT_EQ(tables.size(), u.size());
    const auto lateral = rays.lateral();
    for (std::size_t i = 0; i < u.size(); ++i) {
        ASSERT_EQ(tables[i].u, u[i]);
        for (const bool node : {true, false}) {
            std::array<double, 6> error{}, total{};
            constexpr int kRays = 30;
            for (int r = 0; r < kRays; ++r) {
                const RandomStream stream(7, "rays", static_cast<std::uint64_t>(r));
                dvec3 start(0);
                for (int e = 0; e < 2; ++e) {
                    const double cells = stream.uniform(static_cast<std::uint64_t>(e)) * g.size[lateral[e]];
                    start[lateral[e]] = (node ? std::floor(cells) : cells) * g.spacing(lateral[e]);
                }
                const Reference ref = integrate_ray(sum, rays, start, u[i]);
                const double a = start[lateral[0]] / g.period[lateral[0]], b = start[lateral[1]] / g.period[lateral[1]];
                const std::array<double, 6> expected{ref.displacement[0], ref.displacement[1], ref.slope[0],
                                                     ref.slope[1],        ref.potential,       ref.potential_slope};
                const std::array<double, 6> got{
                    tables[i].displacement[0].sample(a, b).value, tables[i].displacement[1].sample(a, b).value,
                    tables[i].slope[0].sample(a, b).value,        tables[i].slope[1].sample(a, b).value,
                    tables[i].potential->sample(a, b).value,      tables[i].potential_slope->sample(a, b).value};
                for (int q = 0; q < 6; ++q) {
                    error[q] += std::pow(got[q] - expected[q], 2);
                    total[q] += std::pow(expected[q], 2);
                }
            }
            for (int q = 0; q < 6; ++q)
                EXPECT_LE(std::sqrt(error[q]), kPathTableError * std::sqrt(total[q]))
                    << "u " << u[i] << " quantity " << q << " node " << node;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(AxesAndSizes, PathTables,
                         testing::Values(Case{{12, 10, 14, 4}, {2, 1, 0.13, 0}},
                                         Case{{12, 10, 14, 4}, {2, -1, -3.3, 0}}, Case{{12, 10, 14, 4}, {0, 1, 0.4, 0}},
                                         Case{{12, 10, 14, 4}, {0, -1, 0, 0}}, Case{{12, 10, 14, 4}, {1, 1, 0.2, 0}},
                                         Case{{12, 10, 14, 4}, {1, -1, 7.7, 0}}, Case{{11, 9, 7, 3}, {2, 1, 0.1, 0}},
                                         Case{{11, 9, 7, 3}, {0, 1, 0.1, 0}}, Case{{7, 16, 9, 1}, {1, -1, 0.1, 0}}));

TEST(PathTables, SliceIsTheForceOnItsPlane) {
    const LatticeGeometry g{{12, 10, 14, 4}, {1.0, 1.3, 0.9, 2.0}};
    const LatticeField field(air(), g);
    const TrigonometricSum sum(field.spectrum_at(0.2), g);
    for (int axis = 0; axis < 3; ++axis) {
        const PathRays rays{axis, -1, 0.3, 0};
        const SliceTable slice = slice_table(field, 0.2, rays, 0.17);
        const auto lateral = rays.lateral();
        dvec3 x(0);
        x[axis] = 0.3 - 0.17;
        x[lateral[0]] = 0.41;
        x[lateral[1]] = -0.77;
        const dvec3 force = sum.sample(x).gradient;
        for (std::size_t e = 0; e < 2; ++e)
            EXPECT_NEAR(
                slice.force[e].sample(x[lateral[0]] / g.period[lateral[0]], x[lateral[1]] / g.period[lateral[1]]).value,
                force[lateral[e]], 5 * kPathTableError * std::sqrt(slice_variance(field, rays)[e]));
    }
}

// An ensemble of realisations, compared with the discrete expectation: 40 seeds × all nodes of a table.
TEST(PathTables, VarianceIsTheDiscreteExpectationWithAndWithoutAperture) {
    const LatticeGeometry g{{12, 10, 14, 1}, {1.0, 1.3, 0.9, 2.0}};
    for (const double aperture : {0.0, 0.25})
        for (int axis = 0; axis < 3; ++axis) {
            const PathRays rays{axis, 1, 0, aperture};
            const auto lateral = rays.lateral();
            constexpr int kSeeds = 200;
            std::array<double, 2> sum{}, sum2{};
            for (int seed = 0; seed < kSeeds; ++seed) {
                TurbulenceSpec spec = air();
                spec.seed = static_cast<std::uint64_t>(seed);
                const LatticeField field(spec, g);
                const auto table = path_tables(field, 0, rays, std::array{0.6}, 1);
                std::array<double, 2> one{};
                const int na = g.size[lateral[0]], nb = g.size[lateral[1]];
                for (int i = 0; i < na; ++i)
                    for (int j = 0; j < nb; ++j)
                        for (int e = 0; e < 2; ++e)
                            one[e] +=
                                std::pow(table[0].displacement[e].sample(double(i) / na, double(j) / nb).value, 2) /
                                (na * nb);
                for (int e = 0; e < 2; ++e) {
                    sum[e] += one[e];
                    sum2[e] += one[e] * one[e];
                }
            }
            TurbulenceSpec spec = air();
            const auto expected = LatticeField(spec, g).displacement_variance(axis, 0.6, aperture);
            for (int e = 0; e < 2; ++e) {
                const double mean = sum[e] / kSeeds, error = std::sqrt((sum2[e] / kSeeds - mean * mean) / kSeeds);
                EXPECT_LT(std::abs(mean - expected[e]), 4.5 * error) << axis << ' ' << aperture;
                EXPECT_LT(error, 0.06 * expected[e]);
            }
        }
}

TEST(PathTables, RmsGrowsAsTheSquareThenAsThePowerThreeHalves) {
    TurbulenceSpec spec = air();
    spec.outer_scale = 0.4;
    const LatticeGeometry g{{32, 32, 512, 1}, {1, 1, 16, 1}};
    const LatticeField field(spec, g);
    const auto exponent = [&](double u) {
        return 0.5 * std::log2(field.displacement_variance(2, 2 * u, 0)[0] / field.displacement_variance(2, u, 0)[0]);
    };
    EXPECT_NEAR(exponent(0.002), 2, 0.01);
    EXPECT_NEAR(exponent(0.01), 2, 0.02);
    EXPECT_NEAR(exponent(3), 1.5, 0.06);
    EXPECT_NEAR(exponent(5), 1.5, 0.05);
}

}  // namespace
}  // namespace eikonal
