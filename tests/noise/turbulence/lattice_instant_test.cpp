/// One instant of a lattice as a continuous function: its nodes, gradient, interpolation error and falloff.
#include "noise/turbulence/lattice/lattice_instant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "noise/math/random.h"
#include "noise/turbulence/lattice/lattice.h"
#include "tests/noise/trigonometric_sum.h"
#include "tests/noise/turbulence/lattice_boxes.h"

namespace eikonal {
namespace {

TEST(LatticeInstant, PassesThroughTheNodesAndHasItsOwnGradient) {
    for (const auto& g : {box(16, 12, 18, 4), box(9, 7, 5, 4), box(2, 2, 2, 2)})
        for (const int padding : {1, 2}) {
            const LatticeField field(air(), g);
            const LatticeInstant instant(field, 0.3, padding);
            const auto nodes = samples_of(field.bending_spectrum_at(0.3), g);
            const double scale = rms(node_field(field, 0.3, Component::Index));
            std::size_t at = 0;
            for (int x = 0; x < g.size[0]; ++x)
                for (int y = 0; y < g.size[1]; ++y)
                    for (int z = 0; z < g.size[2]; ++z, ++at) {
                        const IndexSample s =
                            instant.sample({x * g.spacing(0), y * g.spacing(1), (z - g.size[2]) * g.spacing(2)});
                        ASSERT_NEAR(s.n, nodes[at], 1e-5 * scale);
                        ASSERT_GE(s.n, instant.lower_bound());
                        ASSERT_LE(s.n, instant.upper_bound());
                    }
            for (const dvec3& x : {dvec3(0.11, 0.71, -5.3), dvec3(-17.3, 2.22, 0.456)})
                for (int axis = 0; axis < 3; ++axis) {
                    dvec3 h(0);
                    h[axis] = 1e-3;  // the spline is evaluated in float: a smaller step measures its rounding
                    const double slope = (instant.sample(x + h).n - instant.sample(x - h).n) / 2e-3;
                    EXPECT_NEAR(instant.sample(x).gradient[axis], slope,
                                1e-4 * scale / g.spacing(axis) + 1e-3 * std::abs(slope));
                }
        }
}

TEST(LatticeInstant, InterpolationErrorIsAsStated) {
    // single modes along x: rms over a cell of spline against e^{ikx}; padding along x alone, and not along x
    constexpr int n = 16;
    for (const auto& [m, padding] :
         {std::pair{1, Padding{1, 1, 1}}, std::pair{2, Padding{1, 3, 2}}, std::pair{4, Padding{1, 1, 1}},
          std::pair{6, Padding{1, 2, 2}}, std::pair{4, Padding{2, 1, 1}}, std::pair{6, Padding{3, 1, 2}}}) {
        FftVector<complex32> spectrum(static_cast<std::size_t>(n * 2 * 2));
        spectrum[static_cast<std::size_t>(m * 4)] = spectrum[static_cast<std::size_t>((n - m) * 4)] = {0.5F, 0};
        const PeriodicSpline3 spline(spectrum, {n, 2, 2}, padding);
        double value = 0, slope = 0;
        constexpr int kPoints = 4096;
        for (int i = 0; i < kPoints; ++i) {
            const double x = (i + 0.5) / kPoints, phase = 2 * M_PI * m * x, k = 2 * M_PI * m;
            const auto s = spline.sample({x, 0, 0});
            value += std::pow(s.value - std::cos(phase), 2) / kPoints;
            slope += std::pow(s.gradient.x / k + std::sin(phase), 2) / kPoints;
        }
        // rms of a cosine is 1/√2
        const double turns = static_cast<double>(m) / (n * padding[0]);
        EXPECT_NEAR(std::sqrt(2 * value), spline_error(turns), 1e-6 + 1e-3 * spline_error(turns));
        EXPECT_NEAR(std::sqrt(2 * slope), spline_slope_error(turns), 1e-6 + 1e-3 * spline_slope_error(turns));
    }
    // the field itself: less with padding, and small
    const auto g = box(16, 16, 16, 1);
    const LatticeField field(air(), g);
    const TrigonometricSum exact(field.spectrum_at(0), g);
    double previous = 1;
    for (const int padding : {1, 2, 4}) {
        const LatticeInstant instant(field, 0, padding);
        double error = 0, total = 0;
        for (int i = 0; i < 200; ++i) {
            const RandomStream stream(1, "points", static_cast<std::uint64_t>(i));
            const dvec3 x(stream.uniform(0), stream.uniform(1), stream.uniform(2));
            const IndexSample s = instant.sample(x), e = exact.sample(x);
            error += glm::dot(s.gradient - e.gradient, s.gradient - e.gradient);
            total += glm::dot(e.gradient, e.gradient);
        }
        const double relative = std::sqrt(error / total);
        EXPECT_LT(relative, 0.2 * previous) << padding;
        previous = relative;
    }
    EXPECT_LT(previous, 2e-3);
}

TEST(LatticeInstant, FalloffMultipliesThePotential) {
    const auto g = box(12, 10, 8, 1);
    TurbulenceSpec spec = air();
    const LatticeField bare(spec, g);
    spec.falloff = Falloff{{0, 0.2, 0}, {0, 1, 0}, 0.3};
    const LatticeField field(spec, g);
    const LatticeInstant instant(field, 0), plain(bare, 0);
    for (const dvec3& x : {dvec3(0.3, 0.1, 0.2), dvec3(0.5, 0.9, 0.7), dvec3(0.1, 2.9, 0.4)}) {
        const double factor = x.y > 0.2 ? std::exp(-(x.y - 0.2) / 0.3) : 1;
        EXPECT_NEAR(instant.sample(x).n, factor * plain.sample(x).n, 1e-12);
        for (int axis = 0; axis < 3; ++axis) {
            dvec3 h(0);
            h[axis] = 1e-3;
            const double slope = (instant.sample(x + h).n - instant.sample(x - h).n) / 2e-3;
            EXPECT_NEAR(instant.sample(x).gradient[axis], slope, 1e-4 * std::abs(slope) + 1e-10);
        }
    }
    // node fields: same product
    const auto index = samples_of(bare.bending_spectrum_at(0), g), fy = node_field(bare, 0, Component::ForceY);
    const auto scaled = node_field(field, 0, Component::ForceY);
    const auto at = static_cast<std::size_t>((3 * 10 + 7) * 8 + 2);
    const double y = 7 * g.spacing(1), factor = std::exp(-(y - 0.2) / 0.3);
    EXPECT_NEAR(scaled[at], factor * (fy[at] - index[at] / 0.3), 1e-5 * rms(fy));
}

}  // namespace
}  // namespace eikonal
