// Air over a heated plane, compared with long double over all ranges; the critical angle.
#include "noise/surface/surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "noise/math/random.h"
#include "noise/medium/optics.h"
#include "noise/surface/surface_spec.h"

namespace eikonal {
namespace {

constexpr double kHalfPi = 1.5707963267948966;

/// Eq. 4 and Eq. 3 in 80 bits, straight from their definition.
struct Exact {
    long double Ta, Ts, d0, A;

    Exact(const SurfaceSpec& s, const IndexLaw& law)
        : Ta(law.ambient_temperature),
          Ts(s.surface_temperature),
          d0(s.dropoff),
          A((long double)law.refractivity * law.T0) {}
    long double D(long double h) const { return (Ts - Ta) * std::exp(-h / d0); }
    long double T(long double h) const { return Ts * std::exp(-h / d0) - Ta * std::expm1(-h / d0); }
    long double above(long double h) const { return -A * D(h) / (T(h) * Ta); }
    long double slope(long double h) const { return A * D(h) / (T(h) * T(h) * d0); }
    long double curvature(long double h) const { return A * D(h) * (D(h) - Ta) / (T(h) * T(h) * T(h) * d0 * d0); }
    long double curvature_scale(long double h) const {
        return A * std::abs(D(h)) * (std::abs(D(h)) + Ta) / (T(h) * T(h) * T(h) * d0 * d0);
    }
};

SurfaceSpec level(double temperature, double dropoff) {
    SurfaceSpec s;
    s.surface_temperature = temperature;
    s.dropoff = dropoff;
    return s;
}

IndexLaw law_at(double ambient) {
    return index_law(OpticsSpec{.ambient_temperature = ambient});
}

TEST(Surface, IsTheClosedFormOverExtremes) {
    for (const double Ta : {1e-3, 1.0, 293.15, 1e6, 1e12})
        for (const double Ts : {1e-3, 200.0, 293.15001, 305.0, 1e4, 1e12})
            for (const double d0 : {1e-12, 0.01, 3.0, 1e12}) {
                const SurfaceSpec spec = level(Ts, d0);
                const SurfaceIndex layer(spec, law_at(Ta));
                const Exact exact(spec, law_at(Ta));
                for (const double part : {0.0, 1e-15, 1e-6, 0.01, 0.3, 0.6, 1.0, 3.0, 10.0, 30.0, 80.0}) {
                    const double h = part * d0;
                    const auto near = [&](double value, long double truth, long double scale) {
                        EXPECT_LE(std::abs(value - truth), kSurfaceError * scale + 1e-290L)
                            << Ta << ' ' << Ts << ' ' << d0 << ' ' << part;
                    };
                    near(layer.above_ambient(h), exact.above(h), std::abs(exact.above(h)));
                    near(layer.slope(h), exact.slope(h), std::abs(exact.slope(h)));
                    near(layer.curvature(h), exact.curvature(h), exact.curvature_scale(h));
                    EXPECT_LE(std::abs(layer.slope(h)), layer.largest_slope() * (1 + 1e-12));
                }
            }
}

TEST(Surface, DerivativesAreThoseOfFiniteDifferences) {
    for (const double Ts : {250.0, 305.0, 1500.0, 1e5}) {
        const SurfaceSpec spec = level(Ts, 0.02);
        const SurfaceIndex layer(spec, law_at(293.15));
        const Exact exact(spec, law_at(293.15));
        for (const double h : {0.001, 0.01, 0.05, 0.1, 0.3}) {
            const long double step = 1e-6L;
            const long double slope = (exact.above(h + step) - exact.above(h - step)) / (2 * step);
            const long double curvature = (exact.slope(h + step) - exact.slope(h - step)) / (2 * step);
            EXPECT_NEAR(layer.slope(h), slope, 1e-8 * std::abs(slope));
            EXPECT_NEAR(layer.curvature(h), curvature,
                        1e-8 * std::abs(curvature) + 1e-8 * layer.largest_slope() / 0.02);
        }
    }
}

TEST(Surface, WorksInAnyPlane) {
    SurfaceSpec spec = level(330, 0.05);
    spec.origin = {1, 2, 3};
    spec.normal = glm::normalize(dvec3(1, -2, 0.5));
    const SurfaceIndex layer(spec, law_at(300));
    const RandomStream stream(1, "surface test");
    for (std::uint64_t i = 0; i < 200; ++i) {
        const auto u = [&](int c) { return stream.uniform(8 * i + c) - 0.5; };
        const double h = 0.2 * stream.uniform(8 * i + 3);
        const dvec3 side = glm::cross(spec.normal, dvec3(u(0), u(1), u(2)));
        const dvec3 x = spec.origin + h * spec.normal + side;
        EXPECT_NEAR(layer.height(x), h, 1e-14);
        const IndexJet jet = layer.jet(x);
        const IndexSample sample = layer.sample(x);
        EXPECT_EQ(jet.n, sample.n);
        EXPECT_EQ(jet.gradient, sample.gradient);
        EXPECT_NEAR(jet.n, layer.above_ambient(h), 1e-12 * std::abs(jet.n));
        EXPECT_NEAR(glm::dot(jet.gradient, spec.normal), layer.slope(h), 1e-11 * layer.largest_slope());
        EXPECT_LT(glm::length(glm::cross(jet.gradient, spec.normal)), 1e-14 * layer.largest_slope());
        // the trace of the Hessian of a function of height alone
        EXPECT_NEAR(jet.hessian[0][0] + jet.hessian[1][1] + jet.hessian[2][2], layer.curvature(h),
                    1e-10 * layer.largest_slope() / spec.dropoff);
    }
}

TEST(Surface, BelowItselfHasItsOwnIndexAndNoGradient) {
    const SurfaceIndex layer(level(310, 0.01), law_at(290));
    const IndexJet below = layer.jet({4, -1e-9, 2});
    EXPECT_EQ(below.n, layer.above_ambient(0));
    EXPECT_EQ(below.gradient, dvec3(0));
    EXPECT_EQ(below.hessian, glm::dmat3(0));
    EXPECT_NEAR(below.n, law_at(290).above_ambient(310), 1e-14 * std::abs(below.n));
    EXPECT_GT(layer.slope(0), 0);
    EXPECT_LT(SurfaceIndex(level(270, 0.01), law_at(290)).slope(0), 0);
    EXPECT_FALSE(SurfaceIndex(level(290, 0.01), law_at(290)).bends());
}

TEST(Surface, TopLeavesNothingAbove) {
    for (const double Ta : {1e-3, 293.15, 1e9})
        for (const double Ts : {1e-3, 100.0, 293.2, 305.0, 1e12}) {
            if (Ts == Ta) continue;
            const SurfaceSpec spec = level(Ts, 0.5);
            const SurfaceIndex layer(spec, law_at(Ta));
            const Exact exact(spec, law_at(Ta));
            const long double largest = std::abs(exact.above(0)), there = std::abs(exact.above(layer.top()));
            EXPECT_NEAR(static_cast<double>(there / largest), kNegligibleIndex, 1e-3 * kNegligibleIndex);
            long double steepest = 0;
            for (int i = 0; i <= 4000; ++i)
                steepest = std::max(steepest, std::abs(exact.slope(layer.top() * i / 4000)));
            EXPECT_LE(std::abs(exact.slope(layer.top())), 5 * kNegligibleIndex * steepest) << Ta << ' ' << Ts;
            EXPECT_LE(steepest, layer.largest_slope() * (1 + 1e-12));
        }
}

// n(H) cosθ = n(0), in 80 bits.
TEST(Surface, CriticalSlopeIsThatOfTheInvariant) {
    for (const double Ta : {0.01, 250.0, 293.15})
        for (const double Ts : {100.0, 293.16, 305.0, 5000.0})
            for (const double H : {1e-9, 1e-4, 0.02, 1.5, 1e6})
                for (const double exaggeration : {1.0, 50.0}) {
                    const SurfaceSpec spec = level(Ts, 0.01);
                    const SurfaceIndex layer(spec, law_at(Ta));
                    const Exact exact(spec, law_at(Ta));
                    // n(H) - n(0), by expm1 so that H << d0 keeps its digits
                    const long double rise = exaggeration * exact.A * (exact.Ts - exact.Ta) *
                                             -std::expm1(-H / exact.d0) / (exact.T(H) * exact.Ts);
                    const long double n = 1 + exact.A / exact.Ta + exaggeration * exact.above(H);
                    for (const RayEquation equation : {RayEquation::Physical, RayEquation::Paper}) {
                        const double angle = layer.critical_slope(H, exaggeration, equation);
                        if (rise <= 0) {
                            EXPECT_EQ(angle, 0);
                            continue;
                        }
                        if (rise >= n) {
                            EXPECT_NEAR(angle, kHalfPi, 1e-12);
                            continue;
                        }
                        long double part = rise / n;
                        if (equation == RayEquation::Paper) part = -std::expm1(0.5L * std::log1p(-part));
                        const long double truth = 2 * std::asin(std::sqrt(part / 2));
                        EXPECT_NEAR(angle, static_cast<double>(truth), kCriticalSlopeError * static_cast<double>(truth))
                            << Ta << ' ' << Ts << ' ' << H << ' ' << exaggeration;
                    }
                }
}

TEST(Surface, CriticalSlopeIsTheRootOfTwiceTheStepOfTheIndex) {
    const SurfaceIndex layer(level(305, 0.01), law_at(273));
    const double B = -layer.above_ambient(0);
    EXPECT_NEAR(layer.critical_slope(2), std::sqrt(2 * B), 1e-3 * std::sqrt(2 * B));
    EXPECT_NEAR(layer.critical_slope(2, 1, RayEquation::Paper), std::sqrt(B), 1e-3 * std::sqrt(B));
    EXPECT_EQ(layer.critical_slope(0), 0);
    EXPECT_EQ(SurfaceIndex(level(260, 0.01), law_at(273)).critical_slope(2), 0);
}

}  // namespace
}  // namespace eikonal
