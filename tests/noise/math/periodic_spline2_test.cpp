/// The doubly periodic spline: its samples, gradient and stated error, whole rows, and any finite position.
#include "noise/math/periodic_spline2.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "noise/math/periodic_spline3.h"
#include "noise/math/random.h"

namespace eikonal {
namespace {

constexpr double kTau = 2 * M_PI;

/// One mode cos(2π(a x/Lx + b y/Ly) + phase of value) of amplitude 2|value| (b > 0).
FftVector<complex32> one_mode(int nx, int ny, int a, int b, complex32 value) {
    FftVector<complex32> s(static_cast<std::size_t>(nx) * (ny / 2 + 1));
    s[static_cast<std::size_t>((a + nx) % nx) * (ny / 2 + 1) + b] = value;
    return s;
}

PeriodicSpline2 random_spline(int nx, int ny, double Lx, double Ly, int highest) {
    FftVector<complex32> s(static_cast<std::size_t>(nx) * (ny / 2 + 1));
    const RandomStream stream(4, "spline test");
    for (int a = -highest; a <= highest; ++a)
        for (int b = 1; b <= highest; ++b) {
            double re, im;
            stream.gaussians(static_cast<std::uint64_t>((a + 100) * 1000 + b), re, im);
            s[static_cast<std::size_t>((a + nx) % nx) * (ny / 2 + 1) + b] =
                complex32(re, im) / static_cast<float>(a * a + b * b);
        }
    return {std::move(s), nx, ny, Lx, Ly};
}

TEST(PeriodicSpline2, PassesThroughTheSamplesOfTheTrigonometricSum) {
    const int nx = 24, ny = 20;
    const double Lx = 3, Ly = 2;
    const complex32 z(0.3f, -0.8f);
    for (const auto& [a, b] : {std::pair{1, 1}, {-5, 3}, {11, 9}, {0, 7}}) {
        const PeriodicSpline2 f(one_mode(nx, ny, a, b, z), nx, ny, Lx, Ly);
        for (int i = -3; i < nx + 3; ++i)
            for (int j = -3; j < ny + 3; ++j) {
                const double phase = kTau * (double(a) * i / nx + double(b) * j / ny);
                const double expected = 2 * (z.real() * std::cos(phase) - z.imag() * std::sin(phase));
                EXPECT_NEAR(f.sample(i * Lx / nx, j * Ly / ny).value, expected, 3e-5) << i << ' ' << j;
            }
    }
}

TEST(PeriodicSpline2, GradientErrorOfAModeIsTheStatedOne) {
    const int n = 48;
    const RandomStream stream(1, "spline test");
    for (const int pad : {1, 2})
        for (const int mode : {3, 6, 8, 12, 18}) {
            const PeriodicSpline2 f(one_mode(n, n, 0, mode, 0.5f), n, n, 1, 1, pad);
            double error = 0, power = 0;
            for (int i = 0; i < 4000; ++i) {
                const double x = stream.uniform(2 * i), y = stream.uniform(2 * i + 1);
                const double exact = -kTau * mode * std::sin(kTau * mode * y);
                const double d = f.sample(x, y).dy - exact;
                error += d * d;
                power += exact * exact;
            }
            const double stated = spline_slope_error(double(mode) / (n * pad));
            EXPECT_NEAR(std::sqrt(error / power), stated, 0.06 * stated + 3e-6) << mode << ' ' << pad;
        }
    // The figures in the header
    for (const auto& [omega, error] :
         {std::pair{M_PI / 8, 4e-4}, {M_PI / 4, 3.3e-3}, {M_PI / 3, 0.009}, {M_PI / 2, 0.04}, {3 * M_PI / 4, 0.23}})
        EXPECT_NEAR(spline_slope_error(omega / kTau), error, 0.2 * error) << omega;
}

TEST(PeriodicSpline2, GradientIsTheDerivativeOfTheValue) {
    const PeriodicSpline2 f = random_spline(32, 40, 2, 3, 9);
    const double h = 1e-3;
    for (int i = 0; i < 100; ++i) {
        const double x = 0.0371 * i - 1, y = 0.0513 * i - 2;
        const auto s = f.sample(x, y);
        EXPECT_NEAR((f.sample(x + h, y).value - f.sample(x - h, y).value) / (2 * h), s.dx, 0.01);
        EXPECT_NEAR((f.sample(x, y + h).value - f.sample(x, y - h).value) / (2 * h), s.dy, 0.01);
    }
}

TEST(PeriodicSpline2, BatchesAgreeWithSamples) {
    const PeriodicSpline2 f = random_spline(32, 40, 2, 3, 9);
    float largest = 0;
    for (int i = 0; i < 1000; ++i) largest = std::max(largest, std::abs(f.sample(0.017 * i, 0.031 * i).dx));
    struct Case {
        double x0, y0, dx, dy;
        int n;
    };
    for (const Case& c : {Case{0.1, 0.2, 0.03, 0, 333},
                          {-5.7, 9.1, -0.021, 0.017, 200},
                          {1e7, -1e7, 0.05, 0, 65},
                          {0.3, 0.4, 0, 0, 5},
                          {0.5, 1.5, 0.0003, -0.0004, 1000},
                          {-0.01, 2.99, 0.0009, 0, 500},
                          {1, 1, 3, 7, 100}}) {
        std::vector<float> uv(2 * c.n, 1.0f), values(c.n, 2.0f), row(c.n, 2.0f);
        const auto columns = f.columns(c.x0, c.dx, c.n);
        f.add_row_gradients(columns, c.y0, 0.5f, uv.data());
        f.add_row_values(columns, c.y0, 0.5f, row.data());
        f.add_values(c.x0, c.y0, c.dx, c.dy, c.n, 0.5f, values.data());
        const double tolerance = largest * (std::abs(c.x0) > 1e6 ? 1e-4 : 1e-6);
        for (int i = 0; i < c.n; ++i) {
            const auto s = f.sample(c.x0 + i * c.dx, c.y0);
            EXPECT_NEAR(uv[2 * i], 1 + 0.5f * s.dx, tolerance) << i << ' ' << c.dx;
            EXPECT_NEAR(uv[2 * i + 1], 1 + 0.5f * s.dy, tolerance) << i << ' ' << c.dx;
            EXPECT_NEAR(row[i], 2 + 0.5f * s.value, 1e-4) << i;
            EXPECT_NEAR(values[i], 2 + 0.5f * f.sample(c.x0 + i * c.dx, c.y0 + i * c.dy).value, 1e-4) << i;
        }
    }
}

TEST(PeriodicSpline2, AnyFinitePositionIsSafe) {
    const PeriodicSpline2 f = random_spline(8, 9, 0.7, 0.3, 3);
    for (const double x : {1e300, -1e300, 0.7, -0.7, -1e-300, 0.7 * (1 - 1e-16), 1e17}) {
        EXPECT_TRUE(std::isfinite(f.sample(x, -x).dx));
        std::vector<float> uv(40);
        f.add_row_gradients(f.columns(x, -x, 20), -x, 1, uv.data());
        f.add_values(x, -x, -x, x, 20, 1, uv.data());
        for (const float v : uv) EXPECT_TRUE(std::isfinite(v));
    }
    EXPECT_EQ(PeriodicSpline2().sample(1, 2).value, 0);
}

}  // namespace
}  // namespace eikonal
