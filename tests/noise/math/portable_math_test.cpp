// The elementary functions, compared with the C library's long double over the ranges and to the errors that their
// header states. Both versions of EIKONAL_CLONES must return the same bits.
#include "noise/math/portable_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "noise/base/instruction_sets.h"
#include "noise/math/fourier_random.h"
#include "noise/math/random.h"

namespace eikonal {
namespace {

TEST(PortableMath, SineAndCosineOfTurns) {
    std::mt19937_64 generator(1);
    for (const double range : {1e-300, 1e-9, 0.2, 1.0, 100.0, 0x1p40}) {
        std::uniform_real_distribution<double> uniform(-range, range);
        for (int i = 0; i < 20000; ++i) {
            const double x = uniform(generator);
            double s, c;
            portable::sincos_turns(x, s, c);
            const long double reduced = static_cast<long double>(x) - std::floor(x);
            EXPECT_NEAR(s, static_cast<double>(sinl(2 * M_PIl * reduced)), portable::kSincosError) << x;
            EXPECT_NEAR(c, static_cast<double>(cosl(2 * M_PIl * reduced)), portable::kSincosError) << x;
        }
    }
    for (int quarter = -9; quarter <= 9; ++quarter) {
        double s, c;
        portable::sincos_turns(0.25 * quarter, s, c);
        const int q = ((quarter % 4) + 4) % 4;
        EXPECT_EQ(s, q == 1 ? 1 : (q == 3 ? -1 : 0)) << quarter;
        EXPECT_EQ(c, q == 0 ? 1 : (q == 2 ? -1 : 0)) << quarter;
    }
}

TEST(PortableMath, Exponential) {
    std::mt19937_64 generator(2);
    for (const double range : {1e-12, 1e-3, 1.0, 50.0, 708.0}) {
        std::uniform_real_distribution<double> uniform(-range, range);
        for (int i = 0; i < 20000; ++i) {
            const double x = uniform(generator);
            const long double exact = expl(x);
            EXPECT_LT(std::abs(portable::exp(x) - exact), portable::kExpError * exact) << x;
        }
    }
    EXPECT_EQ(portable::exp(0), 1);
    EXPECT_EQ(portable::exp(-746), 0);
    EXPECT_EQ(portable::exp(-std::numeric_limits<double>::infinity()), 0);
    EXPECT_TRUE(std::isinf(portable::exp(710)));
    EXPECT_TRUE(std::isfinite(portable::exp(709.7)));
    EXPECT_NEAR(portable::exp(-744) / 5e-324, std::exp(-744) / 5e-324, 1);
    EXPECT_TRUE(std::isnan(portable::exp(std::nan(""))));
}

TEST(PortableMath, Logarithm) {
    std::mt19937_64 generator(3);
    std::uniform_real_distribution<double> exponent(-1074, 1023), near_one(0.5, 2);
    for (int i = 0; i < 40000; ++i)
        for (const double x : {std::exp2(exponent(generator)), near_one(generator)}) {
            const long double exact = logl(x);
            EXPECT_LE(std::abs(portable::log(x) - exact), portable::kLogError * std::max(std::abs(exact), 1e-300L))
                << x;
        }
    EXPECT_EQ(portable::log(1), 0);
    EXPECT_EQ(portable::log(0), -std::numeric_limits<double>::infinity());
    EXPECT_TRUE(std::isnan(portable::log(-1)));
    EXPECT_TRUE(std::isnan(portable::log(std::nan(""))));
    EXPECT_TRUE(std::isinf(portable::log(std::numeric_limits<double>::infinity())));
}

TEST(PortableMath, Power) {
    std::mt19937_64 generator(4);
    std::uniform_real_distribution<double> exponent(-60, 60), power(-4, 4);
    for (int i = 0; i < 20000; ++i) {
        const double x = std::exp2(exponent(generator)), y = power(generator);
        const long double exact = powl(x, y);
        const double bound = portable::kExpError + std::abs(y * std::log(x)) * (portable::kLogError + 1.2e-16);
        EXPECT_LT(std::abs(portable::pow(x, y) - exact), bound * exact) << x << ' ' << y;
    }
    EXPECT_EQ(portable::pow(0, 2), 0);
    EXPECT_EQ(portable::pow(0, 0), 1);
    EXPECT_TRUE(std::isinf(portable::pow(0, -1)));
}

/// What the clones must agree on: every function, through a loop that the compiler vectorises.
EIKONAL_CLONES
void dispatched(int n, const double* x, double* out) {
    for (int i = 0; i < n; ++i) {
        double s, c;
        portable::sincos_turns(x[i], s, c);
        out[i] = s * c + portable::exp(-x[i] * x[i]) + std::sqrt(x[i] * x[i] + 1);
    }
}

void baseline(int n, const double* x, double* out) {
    for (int i = 0; i < n; ++i) {
        double s, c;
        portable::sincos_turns(x[i], s, c);
        out[i] = s * c + portable::exp(-x[i] * x[i]) + std::sqrt(x[i] * x[i] + 1);
    }
}

TEST(Dispatch, ClonesReturnTheSameBits) {
    std::mt19937_64 generator(5);
    std::uniform_real_distribution<double> uniform(-30, 30);
    std::vector<double> x(10007), a(x.size()), b(x.size());
    for (auto& v : x) v = uniform(generator);
    dispatched(static_cast<int>(x.size()), x.data(), a.data());
    baseline(static_cast<int>(x.size()), x.data(), b.data());
    EXPECT_EQ(a, b);
}

// Fixed values. A processor, compiler flag or library that changes a bit fails here.
TEST(Dispatch, GaussiansAreTheSameEverywhere) {
    std::vector<float> one(1000, 1.0F), a(1000), b(1000);
    std::vector<std::uint32_t> counter(1000);
    std::iota(counter.begin(), counter.end(), 0U);
    gaussian_modes(0x0123456789abcdefULL, counter.data(), 1000, one.data(), a.data(), b.data());
    std::uint64_t digest = 0;
    for (int i = 0; i < 1000; ++i)
        digest = mix64(digest ^
                       (std::uint64_t{std::bit_cast<std::uint32_t>(a[i])} << 32 | std::bit_cast<std::uint32_t>(b[i])));
    EXPECT_EQ(digest, 7211950529656620736ULL);
}

}  // namespace
}  // namespace eikonal
