/// Random amplitudes of Fourier modes: their moments, and that they depend on key and counter alone.
///
/// kWorstZ is the two-sided 1e-4 quantile of a z-score after Bonferroni's correction for some 200 comparisons. Seeds
/// are fixed.
#include "noise/math/fourier_random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "noise/math/random.h"

namespace eikonal {
namespace {

constexpr double kWorstZ = 5.0;

TEST(FourierRandom, MomentsOfAStandardGaussian) {
    constexpr int kRow = 65, kRows = 40000;
    const std::vector<float> one(kRow, 1.0F);
    std::vector<float> a(kRow), b(kRow), last(kRow);
    std::vector<std::uint32_t> counter(kRow);
    std::iota(counter.begin(), counter.end(), 0U);
    std::array<double, 5> moment{};
    double product = 0, squares = 0, neighbour = 0, across = 0;
    float largest = 0;
    const RandomStream stream(3, "test");
    for (int r = 0; r < kRows; ++r) {
        last = a;
        gaussian_modes(stream.bits(static_cast<std::uint64_t>(r)), counter.data(), kRow, one.data(), a.data(),
                       b.data());
        for (int i = 0; i < kRow; ++i) {
            for (const float x : {a[i], b[i]}) {
                double power = 1;
                for (auto& m : moment) m += (power *= x);
                largest = std::max(largest, std::abs(x));
            }
            product += a[i] * b[i];
            squares += (a[i] * a[i] - 1) * (b[i] * b[i] - 1);
            across += a[i] * last[i];
            if (i > 0) neighbour += a[i] * a[i - 1];
        }
    }
    const double n = 2.0 * kRow * kRows;
    // variances of x, x² - 1, x³, x⁴ - 3, x⁵ of a Gaussian
    EXPECT_LT(std::abs(moment[0] / n), kWorstZ * std::sqrt(1 / n));
    EXPECT_LT(std::abs(moment[1] / n - 1), kWorstZ * std::sqrt(2 / n));
    EXPECT_LT(std::abs(moment[2] / n), kWorstZ * std::sqrt(15 / n));
    EXPECT_LT(std::abs(moment[3] / n - 3), kWorstZ * std::sqrt(96 / n));
    EXPECT_LT(std::abs(moment[4] / n), kWorstZ * std::sqrt(945 / n));
    EXPECT_LT(std::abs(product / n), kWorstZ * std::sqrt(0.5 / n));
    EXPECT_LT(std::abs(squares / n), kWorstZ * std::sqrt(2 / n));
    EXPECT_LT(std::abs(neighbour / n), kWorstZ * std::sqrt(0.5 / n));
    EXPECT_LT(std::abs(across / n), kWorstZ * std::sqrt(0.5 / n));
    EXPECT_LE(largest, kGaussianLimit);
    EXPECT_GT(largest, 4.5F);
}

TEST(FourierRandom, AModeDependsOnlyOnItsKeyAndIndex) {
    std::vector<float> one(40, 1.0F), a(40), b(40), c(40), d(40);
    std::vector<std::uint32_t> counter(40);
    std::iota(counter.begin(), counter.end(), 0U);
    gaussian_modes(77, counter.data(), 40, one.data(), a.data(), b.data());
    gaussian_modes(77, counter.data() + 9, 31, one.data(), c.data(), d.data());
    for (int i = 0; i < 31; ++i) {
        EXPECT_EQ(c[i], a[i + 9]);
        EXPECT_EQ(d[i], b[i + 9]);
    }
}

}  // namespace
}  // namespace eikonal
