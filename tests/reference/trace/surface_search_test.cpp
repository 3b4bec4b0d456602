/// Objects that bent rays meet, touch or miss.
#include "reference/trace/surface_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "reference/trace/bent_ray.h"
#include "tests/reference/trace/bent_ray_scenes.h"

namespace eikonal::reference {
namespace {

TEST(Surfaces, AreMetOnTheCurve) {
    ProfileSpec spec = profile(ProfileKind::LinearSquared);
    spec.axis = {0, 0, 1};
    spec.slope = 1;
    const TestAir air({spec});
    // Parabola z = x²/4 against a plane, a quad (as triangles) and a sphere, whatever the tolerance.
    const double x = 3, z = x * x / 4;
    const dvec3 tilted = glm::normalize(dvec3(-0.4, 0.1, -1));
    const dvec3 tangent = glm::normalize(dvec3(1, 0, x / 2)),
                center = dvec3(x, 0, z) + 0.5 * glm::normalize(tangent + dvec3(0.3, 0, 0.3));
    for (const double tolerance : {1e-9, 0.01, 10.0}) {
        TraceSettings settings = usual();
        settings.tolerance_px = tolerance;
        for (const ObjectSpec& object : {plane({x, 0, z}, tilted), quad({x, 0, z}, tilted, 0.5), sphere(center, 0.5)}) {
            const auto wall = geometry({object});
            const BentHit hit = trace(air.now, wall.get(), {0, 0, 0}, {1, 0, 0}, settings);
            ASSERT_TRUE(hit.hit) << tolerance;
            // This curve is a polynomial, which every method follows exactly.
            EXPECT_LE(glm::length(hit.at.x - dvec3(x, 0, z)), kClosedFormError) << tolerance;
            EXPECT_EQ(hit.at.x, hit.surface.point);
            EXPECT_NEAR(hit.at.u, x, kClosedFormError);
            EXPECT_NEAR(hit.at.p.z, x / 2, kClosedFormError);
            EXPECT_LT(glm::dot(hit.surface.normal, hit.at.p), 0);
            EXPECT_NEAR(hit.length, 0.5 * (x * std::sqrt(1 + x * x / 4) + 2 * std::asinh(x / 2)), 1e-5);
        }
    }
}

TEST(Surfaces, GrazedAreMetOrPassed) {
    ProfileSpec spec = profile(ProfileKind::LinearSquared);
    spec.axis = {0, 0, 1};
    spec.slope = 1;
    const TestAir air({spec});
    // The ray turns back at z = -s² above a floor, or below its level.
    const double s = 0.1, c = std::sqrt(1 - s * s);
    TraceSettings settings = usual();
    settings.far = 3;
    for (const double gap : {1e-3, 1e-6, 1e-9, -1e-6, -1e-3}) {
        const auto floor = geometry({plane({0, 0, -s * s - gap}, {0, 0, 1})});
        const BentHit hit = trace(air.now, floor.get(), {0, 0, 0}, {c, 0, -s}, settings);
        EXPECT_EQ(hit.hit, gap < 0) << gap;
        if (gap < 0) {
            EXPECT_NEAR(hit.at.u, 2 * s - 2 * std::sqrt(-gap), 1e-8) << gap;
        }
    }
    // One ball is cut by chords of the curve, but not by the curve. Another is just touched by the curve.
    for (const double gap : {1e-4, -1e-4}) {
        const dvec3 lowest{2 * s * c, 0, -s * s};
        const auto ball = geometry({sphere(lowest + dvec3(0, 0, 0.01 + gap), 0.01)});
        settings.tolerance_px = 200;  // coarse chords
        const BentHit hit = trace(air.now, ball.get(), {0, 0, 0}, {c, 0, -s}, settings);
        EXPECT_EQ(hit.hit, gap < 0) << gap;
    }
}

TEST(Surfaces, BehindTheTurnAreMetOnTheWayBack) {
    ProfileSpec spec = profile(ProfileKind::LinearSquared);
    spec.slope = 1;
    const TestAir air({spec});
    // Up against the gradient and down again, past where it started.
    const dvec3 d = glm::normalize(dvec3(0.01, -1, 0));
    const auto ceiling = geometry({plane({0, 2, 0}, {0, -1, 0})});
    const BentHit hit = trace(air.now, ceiling.get(), {0, 0, 0}, d, usual());
    ASSERT_TRUE(hit.hit);
    // y = d.y u + u²/4
    EXPECT_NEAR(hit.at.u, -2 * d.y + 2 * std::sqrt(d.y * d.y + 2), 1e-8);
}

TEST(Surfaces, CostFewSegmentsInWeakAir) {
    // Without a medium the ray is straight, and one step covers any distance.
    const TestAir none({});
    const auto wall = geometry({plane({1e5, 0, 0}, {-1, 0, 0})});
    const BentHit hit = trace(none.now, wall.get(), {0, 0, 0}, glm::normalize(dvec3(1, 0.1, 0)), usual());
    ASSERT_TRUE(hit.hit);
    EXPECT_EQ(hit.steps, 1);
    EXPECT_NEAR(hit.at.x.y, 1e4, 1e-8);
    const BentHit gone = trace(none.now, wall.get(), {0, 0, 0}, {-1, 0, 0}, usual());
    EXPECT_EQ(gone.end, BentHit::End::Escaped);
    EXPECT_EQ(gone.at.x, dvec3(-1e6, 0, 0));
}

}  // namespace
}  // namespace eikonal::reference
