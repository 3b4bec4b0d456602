// The wind: spectrum, divergence, correlation in time, and particles on their exact paths.
#include "noise/blobs/wind.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <thread>

#include "noise/blobs/blobs_spec.h"
#include "noise/math/random.h"

namespace eikonal {
namespace {

dvec3 random_point(const RandomStream& stream, std::uint64_t i) {
    return {stream.uniform(3 * i), stream.uniform(3 * i + 1), stream.uniform(3 * i + 2)};
}

WindSpec wind_spec() {
    WindSpec spec;
    spec.seed = 5;
    spec.rms = 0.7;
    spec.outer_scale = 2;
    spec.rise = {0.1, 1.3, -0.2};
    return spec;
}

TEST(Eddies, RmsOfEachComponentIsOne) {
    // There are about 10³ independent cells in each of 300 realisations. The error is far below 1 %, between nodes too.
    std::array<double, 3> sum{};
    double count = 0;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        const EddyField field(seed);
        const RandomStream stream(seed, "test points");
        for (const double t : {0.0, 1.1, -77.3}) {
            const EddyInstant eddies = field.at(t);
            for (std::uint64_t i = 0; i < 1000; ++i, ++count) {
                const dvec3 v = eddies.velocity(random_point(stream, i));
                for (int c = 0; c < 3; ++c) sum[static_cast<std::size_t>(c)] += v[c] * v[c];
            }
        }
    }
    for (const double s : sum) EXPECT_NEAR(std::sqrt(s / count), 1, 0.01);
}

TEST(Eddies, DivergenceVanishesBetweenTheNodesToo) {
    const EddyInstant eddies = EddyField(3).at(0.4);
    const RandomStream stream(1, "test points");
    constexpr double h = 1e-4;  // of a period: the spline's kinks in its third derivative are well below the bound
    double gradient2 = 0, worst = 0;
    constexpr int n = 2000;
    for (std::uint64_t i = 0; i < n; ++i) {
        const dvec3 x = random_point(stream, i);
        double divergence = 0;
        for (int axis = 0; axis < 3; ++axis) {
            dvec3 step(0);
            step[axis] = h;
            const dvec3 slope = (eddies.velocity(x + step) - eddies.velocity(x - step)) / (2 * h * kEddyPeriod);
            divergence += slope[axis];
            gradient2 += glm::dot(slope, slope);
        }
        worst = std::max(worst, std::abs(divergence));
    }
    EXPECT_LE(worst, kEddyDivergence * std::sqrt(gradient2 / n));
    EXPECT_GT(gradient2 / n, 100);
}

/// Fourier modes of the eddies' velocity at the nodes, signed indices -kMostMode … kMostMode along each axis, by direct
/// sums along one axis after the other.
constexpr int kMostMode = 5, kModes = 2 * kMostMode + 1;
using ComplexVector = std::array<std::complex<double>, 3>;
std::vector<ComplexVector> velocity_modes(const EddyInstant& eddies) {
    constexpr int n = kEddySize;
    std::array<std::array<std::complex<double>, n>, kModes> wave;
    for (int m = -kMostMode; m <= kMostMode; ++m)
        for (int i = 0; i < n; ++i) wave[m + kMostMode][i] = std::polar(1.0 / n, -2 * M_PI * m * i / n);
    std::vector<ComplexVector> x(kModes * n * n), xy(kModes * kModes * n), xyz(kModes * kModes * kModes);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int l = 0; l < n; ++l) {
                const dvec3 v = eddies.velocity({double(i) / n, double(j) / n, double(l) / n});
                for (int a = 0; a < kModes; ++a)
                    for (int c = 0; c < 3; ++c) x[(a * n + j) * n + l][c] += wave[a][i] * v[c];
            }
    for (int a = 0; a < kModes; ++a)
        for (int b = 0; b < kModes; ++b)
            for (int j = 0; j < n; ++j)
                for (int l = 0; l < n; ++l)
                    for (int c = 0; c < 3; ++c)
                        xy[(a * kModes + b) * n + l][c] += wave[b][j] * x[(a * n + j) * n + l][c];
    for (int a = 0; a < kModes; ++a)
        for (int b = 0; b < kModes; ++b)
            for (int d = 0; d < kModes; ++d)
                for (int l = 0; l < n; ++l)
                    for (int c = 0; c < 3; ++c)
                        xyz[(a * kModes + b) * kModes + d][c] += wave[d][l] * xy[(a * kModes + b) * n + l][c];
    return xyz;
}

TEST(Eddies, SpectrumIsVonKarmans) {
    // The expectation is 2 |k'|² Φ_A(k), with k' = 3 sin θ/((2 + cos θ) cell) the slope of a cubic spline at its nodes.
    // Modes are pooled in shells of |m| over 60 realisations. Every shell holds over 1000 independent squares: 4 %.
    constexpr int n = kEddySize, most = kMostMode;
    constexpr double cell = kEddyPeriod / n, k1 = 2 * M_PI / kEddyPeriod, km = 5.92 / kEddyInnerScale;
    const auto spline_wavenumber = [](int m) {
        const double theta = 2 * M_PI * m / n;
        return 3 * std::sin(theta) / ((2 + std::cos(theta)) * cell);
    };
    std::array<double, most + 1> energy{}, expected{};
    double solenoidal = 0, total = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const std::vector<ComplexVector> modes = velocity_modes(EddyField(seed).at(0.3));
        for (int a = -most; a <= most; ++a)
            for (int b = -most; b <= most; ++b)
                for (int d = -most; d <= most; ++d) {
                    const double m2 = a * a + b * b + d * d, shell = std::round(std::sqrt(m2));
                    if (m2 == 0 || shell > most) continue;
                    const ComplexVector& v = modes[((a + most) * kModes + b + most) * kModes + d + most];
                    const double k2 = k1 * k1 * m2;
                    const dvec3 slope(spline_wavenumber(a), spline_wavenumber(b), spline_wavenumber(d));
                    energy[static_cast<std::size_t>(shell)] += std::norm(v[0]) + std::norm(v[1]) + std::norm(v[2]);
                    expected[static_cast<std::size_t>(shell)] +=
                        glm::dot(slope, slope) * std::pow(k2 + 4 * M_PI * M_PI, -17.0 / 6) * std::exp(-k2 / (km * km));
                    solenoidal += std::norm(slope.x * v[0] + slope.y * v[1] + slope.z * v[2]);
                    total += glm::dot(slope, slope) * (std::norm(v[0]) + std::norm(v[1]) + std::norm(v[2]));
                }
    }
    double sum = 0, expected_sum = 0;
    for (std::size_t s = 1; s <= most; ++s) {
        sum += energy[s];
        expected_sum += expected[s];
    }
    for (std::size_t s = 1; s <= most; ++s)
        EXPECT_NEAR(energy[s] / expected[s] * expected_sum / sum, 1, s == 1 ? 0.12 : 0.05) << s;
    EXPECT_LT(std::sqrt(solenoidal / total), 1e-5);
}

TEST(Eddies, CorrelationInTimeIsThatOfTheSpectrum) {
    // Σ Φ_v R(k, t), R the lattice's sum over its frequencies for exp(-k²t²/4), against products of velocities.
    double expected = 0, norm = 0, product = 0, square = 0;
    constexpr double t = 0.15;
    for (int a = -10; a <= 10; ++a)
        for (int b = -10; b <= 10; ++b)
            for (int d = -10; d <= 10; ++d) {
                const double k1 = 2 * M_PI / kEddyPeriod, k2 = k1 * k1 * (a * a + b * b + d * d);
                const double km = 5.92 / kEddyInnerScale;
                const double w = k2 * std::pow(k2 + 4 * M_PI * M_PI, -17.0 / 6) * std::exp(-k2 / (km * km));
                double correlation = 0, weights = 0;
                for (int j = -kEddyTimes / 2; k2 > 0 && j <= kEddyTimes / 2; ++j) {
                    const double kappa = 2 * M_PI * j / kEddyLoop;
                    const double weight = std::exp(-kappa * kappa / k2) * (2 * std::abs(j) == kEddyTimes ? 0.5 : 1);
                    correlation += weight * std::cos(kappa * t);
                    weights += weight;
                }
                if (k2 > 0) expected += w * correlation / weights;
                norm += w;
            }
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const EddyField field(seed);
        const EddyInstant before = field.at(2), after = field.at(2 + t);
        const RandomStream stream(seed, "test points");
        for (std::uint64_t i = 0; i < 1000; ++i) {
            const dvec3 x = random_point(stream, i), v = before.velocity(x);
            product += glm::dot(v, after.velocity(x));
            square += glm::dot(v, v);
        }
    }
    EXPECT_NEAR(product / square, expected / norm, 0.02);
}

TEST(Eddies, DriftKeepsLoopsApart) {
    for (int loop = 1; loop <= kEddyLoopsApart; ++loop) {
        double distance2 = 0;
        for (const double drift : kEddyDrift) {
            const double x = loop * drift - std::round(loop * drift);
            distance2 += x * x;
        }
        EXPECT_GE(std::sqrt(distance2) * kEddyPeriod, 0.5) << loop;
    }
}

TEST(Wind, HasTheRmsAndTheRise) {
    WindSpec spec = wind_spec();
    dvec3 sum(0), sum2(0);
    double count = 0;
    for (spec.seed = 0; spec.seed < 60; ++spec.seed) {
        const Wind wind(spec, 5);
        const RandomStream stream(spec.seed, "test points");
        for (int k = 0; k < 3; ++k) {
            const WindInterval interval = wind.intervals(11 * k - 5, 1).front();
            for (std::uint64_t i = 0; i < 300; ++i, ++count) {
                const dvec3 v = interval.velocity(30.0 * random_point(stream, i), 0) - spec.rise;
                sum += v;
                sum2 += v * v;
            }
        }
    }
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(sum[c] / count / spec.rms, 0, 0.02);
        EXPECT_NEAR(std::sqrt(sum2[c] / count) / spec.rms, 1, 0.02);
    }
}

TEST(Wind, LosesLittleBetweenGridTimes) {
    WindSpec spec = wind_spec();
    double grid = 0, middle = 0;
    for (spec.seed = 0; spec.seed < 40; ++spec.seed) {
        const WindInterval interval = Wind(spec, 5).intervals(7, 1).front();
        const RandomStream stream(spec.seed, "test points");
        for (std::uint64_t i = 0; i < 500; ++i) {
            const dvec3 x = 30.0 * random_point(stream, i);
            const dvec3 v0 = interval.velocity(x, 0) - spec.rise, v = interval.velocity(x, 0.5) - spec.rise;
            grid += glm::dot(v0, v0);
            middle += glm::dot(v, v);
        }
    }
    EXPECT_GE(std::sqrt(middle / grid), 1 - kWindBlendLoss);
    EXPECT_LE(std::sqrt(middle / grid), 1);
}

TEST(Wind, IsContinuousInTime) {
    const WindSpec spec = wind_spec();
    const Wind wind(spec, 5);
    const auto intervals = wind.intervals(-3, 2);
    const RandomStream stream(2, "test points");
    for (std::uint64_t i = 0; i < 50; ++i) {
        const dvec3 x = 10.0 * random_point(stream, i);
        EXPECT_EQ(intervals[0].velocity(x, 1), intervals[1].velocity(x, 0));
        const double t = -2 * wind.step();
        EXPECT_LT(glm::length(wind.velocity(x, t * (1 + 1e-9)) - wind.velocity(x, t * (1 - 1e-9))), 1e-4);
    }
}

TEST(Wind, RiseCarriesTheEddiesAlong) {
    WindSpec calm = wind_spec();
    calm.rise = {0, 0, 0};
    const WindSpec spec = wind_spec();
    const Wind rising(spec, 5), still(calm, 5);
    const RandomStream stream(2, "test points");
    for (std::uint64_t i = 0; i < 20; ++i) {
        const dvec3 x = 10.0 * random_point(stream, i);
        const double t = 3.3 * static_cast<double>(i) - 20;
        EXPECT_LT(glm::length(rising.velocity(x + spec.rise * t, t) - spec.rise - still.velocity(x, t)), 1e-5);
    }
}

TEST(Wind, CarriesAlongTheExactPath) {
    // Against steps a 40th as long, through half a turnover.
    WindSpec spec = wind_spec();
    const int steps = static_cast<int>(kWindStepsPerTurnover / 2);
    double error2 = 0, way2 = 0, count = 0;
    for (spec.seed = 0; spec.seed < 20; ++spec.seed) {
        const Wind wind(spec, 5);
        const auto intervals = wind.intervals(100, steps);
        const RandomStream stream(spec.seed, "test points");
        for (std::uint64_t i = 0; i < 30; ++i, ++count) {
            const dvec3 start = 10.0 * random_point(stream, i);
            dvec3 x = start, exact = start;
            for (const WindInterval& interval : intervals) {
                x = interval.carry(x, 0, 1);
                for (int j = 0; j < 40; ++j) exact = interval.carry(exact, j / 40.0, (j + 1) / 40.0);
            }
            const dvec3 way = exact - start - spec.rise * (steps * wind.step());
            error2 += glm::dot(x - exact, x - exact);
            way2 += glm::dot(way, way);
        }
    }
    EXPECT_LE(std::sqrt(error2 / count), kWindTrackError * spec.outer_scale);
    EXPECT_GE(std::sqrt(way2 / count), 0.3 * spec.outer_scale);
}

TEST(Wind, LongLivesTakeBoundedSteps) {
    WindSpec spec = wind_spec();
    EXPECT_DOUBLE_EQ(Wind(spec, 5).step(), spec.outer_scale / spec.rms / kWindStepsPerTurnover);
    spec.rms = 1e6;
    const Wind wind(spec, 1000);
    EXPECT_DOUBLE_EQ(wind.step(), 1000 / kMostWindSteps);
    EXPECT_TRUE(std::isfinite(wind.velocity({1, 2, 3}, 1e9).x));
}

TEST(Wind, IsAFunctionOfPlaceAndTimeAlone) {
    const WindSpec spec = wind_spec();
    const std::vector<double> times{0, 1e9, -3, 0.01, 17, -1e9, 12345.678, 0.02};
    const dvec3 x{0.3, 40, -7};
    std::vector<dvec3> fresh;
    for (const double t : times) fresh.push_back(Wind(spec, 5).velocity(x, t));
    const Wind wind(spec, 5);
    for (std::size_t i = times.size(); i-- > 0;) EXPECT_EQ(wind.velocity(x, times[i]), fresh[i]);
    for (const int threads : {1, 2}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(Wind(spec, 5).velocity(x, times[i]), fresh[i]);
    }
    std::vector<std::thread> users;
    std::array<bool, 4> same{};
    for (std::size_t u = 0; u < same.size(); ++u)
        users.emplace_back([&, u] {
            bool all = true;
            for (int round = 0; round < 40; ++round) {
                const std::size_t i = (static_cast<std::size_t>(round) * (u + 1) + u) % times.size();
                all &= wind.velocity(x, times[i]) == fresh[i];
            }
            same[u] = all;
        });
    for (std::thread& user : users) user.join();
    for (const bool s : same) EXPECT_TRUE(s);
}

}  // namespace
}  // namespace eikonal
