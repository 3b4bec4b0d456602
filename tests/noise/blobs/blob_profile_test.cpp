/// The single-precision profile of a blob against the kernel in double precision, to the errors that its header states.
#include "noise/blobs/blob_profile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "noise/base/instruction_sets.h"
#include "noise/blobs/blob_kernel.h"
#include "tests/noise/blobs/random_numbers.h"

namespace eikonal {
namespace {

// Profile in double, and the integrals of |s| in place of s.
struct ExactProfile {
    double i1, j2, e, g, size_j2, size_g;
};

ExactProfile exact_profile(double a, double c) {
    const BlobIntegrals f = blob_integrals(1, -a, c - a);
    if (!(a < 0 && c > 0)) return {f.I1, f.J2, f.dI1, f.dJ2, std::abs(f.J2), std::abs(f.dJ2)};
    const BlobIntegrals before = blob_integrals(1, -a, -a), after = blob_integrals(1, 0, c);
    return {f.I1, f.J2, f.dI1, f.dJ2, after.J2 - before.J2 - c * before.dJ2, after.dJ2 - before.dJ2};
}

// The largest error in units of the stated bound.
double profile_error(float a, float c) {
    const BlobProfile got = blob_profile(a, c);
    const ExactProfile exact = exact_profile(a, c);
    const auto ratio = [](float value, double truth, double size) {
        return std::isfinite(value) ? std::abs(value - truth) / (kBlobProfileError * size + 1e-30) : 1e9;
    };
    return std::max({ratio(got.i1, exact.i1, exact.i1), ratio(got.j2, exact.j2, exact.size_j2),
                     ratio(got.e, exact.e, exact.e), ratio(got.g, exact.g, exact.size_g)});
}

TEST(BlobProfile, Gaussian) {
    double worst = 0;
    for (float x = -9.2999F; x < 9.3F; x += 0.00037F) {
        const double exact = std::exp(-static_cast<double>(x) * x);
        worst = std::max(worst, std::abs(gaussian_f(x) - exact) / exact);
    }
    EXPECT_LT(worst, kGaussianFloatError);
    EXPECT_EQ(gaussian_f(0), 1);
    for (const float x : {9.37F, -9.37F, 1e20F, std::numeric_limits<float>::max()}) EXPECT_EQ(gaussian_f(x), 0);
}

TEST(BlobProfile, WithinTheStatedErrorOfTheDoubleForm) {
    Random random(6);
    double worst = 0;
    for (int i = 0; i < 400000; ++i) {
        const double delta = i % 3 == 0 ? decades(random, -6, 6) : decades(random, -1, 1.2);
        const auto a = static_cast<float>(i % 4 == 0 ? sign(random) * decades(random, -6, 6)
                                                     : uniform(random, -10 - delta * (i & 1), 10));
        const auto c = static_cast<float>(a + delta);
        const double error = profile_error(a, c);
        ASSERT_LT(error, 1) << a << ' ' << c;
        worst = std::max(worst, error);
    }
    EXPECT_GT(worst, 0.3) << "the stated error is far from what is reached";
    for (float a = -11; a < 11; a += 0.043F) {
        for (const double edge : {1.4999, 1.5001}) {  // δ (|a| + |c|), where the forms meet
            const double delta = a >= 0         ? std::sqrt(a * a + edge) - a
                                 : a * a > edge ? -a - std::sqrt(a * a - edge)
                                                : std::sqrt(edge);
            ASSERT_LT(profile_error(a, static_cast<float>(a + delta)), 1) << a;
        }
    }
}

TEST(BlobProfile, FromAfar) {
    Random random(7);
    for (int i = 0; i < 200000; ++i) {
        const auto c =
            static_cast<float>(i % 2 == 0 ? uniform(random, -9.2, 12) : sign(random) * decades(random, -6, 6));
        // This is i1 from a = -1e4. The part of the ray from there to -∞ is negligible.
        const double exact = c > -9000 ? blob_integrals(1, 1e4, c + 1e4).I1 : 0;
        ASSERT_LT(std::abs(blob_lateral_from_afar(c) - exact), kBlobProfileError * exact + 1e-30) << c;
    }
    for (float c = 0; c < 20; c += 0.01F) {
        const double exact = blob_integrals(1, kBlobAfar, c + kBlobAfar).I1;
        ASSERT_LT(std::abs(blob_lateral_from_afar(c) - exact), kBlobProfileError * exact) << c;
        if (c < kBlobAfar) continue;
        ASSERT_LT(std::abs(c * portable::kSqrtPi - exact), kBlobProfileError * exact) << c;
    }
}

EIKONAL_CLONES void profiles(const float* a, const float* c, int count, float* i1, float* j2, float* e, float* g,
                             float* afar) {
    for (int i = 0; i < count; ++i) {
        const BlobProfile f = blob_profile(a[i], c[i]);
        i1[i] = f.i1;
        j2[i] = f.j2;
        e[i] = f.e;
        g[i] = f.g;
        afar[i] = blob_lateral_from_afar(c[i]);
    }
}

TEST(BlobProfile, LoopsForNewProcessorsGiveTheSameBitsAndStayFinite) {
    Random random(8);
    constexpr int kCount = 20001;
    std::vector<float> a(kCount), c(kCount);
    constexpr std::array<float, 9> kEnds = {
        0, 1e-45F, 1e-38F, 1e-20F, 1, 1e15F, 1e20F, 3e38F, std::numeric_limits<float>::max()};
    for (int i = 0; i < kCount; ++i) {
        const auto any = [&] {
            return static_cast<float>(i % 4 == 0 ? sign(random) * kEnds[random() % kEnds.size()]
                                                 : sign(random) * decades(random, -3, 1.2));
        };
        a[i] = any();
        c[i] = any();
        if (a[i] > c[i]) std::swap(a[i], c[i]);
    }
    std::array<std::vector<float>, 5> out;
    for (auto& column : out) column.resize(kCount);
    profiles(a.data(), c.data(), kCount, out[0].data(), out[1].data(), out[2].data(), out[3].data(), out[4].data());
    for (int i = 0; i < kCount; ++i) {
        const BlobProfile f = blob_profile(a[i], c[i]);
        const std::array<float, 5> expected = {f.i1, f.j2, f.e, f.g, blob_lateral_from_afar(c[i])};
        for (int k = 0; k < 5; ++k) {
            ASSERT_EQ(std::bit_cast<std::uint32_t>(out[k][i]), std::bit_cast<std::uint32_t>(expected[k]))
                << a[i] << ' ' << c[i];
            ASSERT_TRUE(std::isfinite(out[k][i])) << a[i] << ' ' << c[i];
        }
    }
}

}  // namespace
}  // namespace eikonal
