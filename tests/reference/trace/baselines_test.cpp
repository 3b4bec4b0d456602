/// Rays over a heated surface: mirages in closed form, and the baselines that the paper names (layers, mirror),
/// compared with the bent ray.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "noise/base/error.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/medium/refractivity.h"
#include "reference/trace/baselines.h"
#include "tests/reference/trace/bent_ray_scenes.h"

namespace eikonal::reference {
namespace {

TEST(Mirage, CriticalAngle) {
    const TestAir air({road(0.01)}, at_zero());
    const auto floor = geometry({plane({0, 0, 0}, {0, 1, 0})});
    const IndexLaw law = index_law(at_zero());
    const double B = -law.above_ambient(305);
    double low = 0.5 * std::sqrt(2 * B), high = 2 * std::sqrt(2 * B);
    for (int i = 0; i < 40; ++i) {
        const double angle = 0.5 * (low + high);
        const BentHit hit = trace(air.now, floor.get(), {0, 1.5, 0}, {std::cos(angle), -std::sin(angle), 0}, finest());
        (hit.hit ? high : low) = angle;
    }
    EXPECT_NEAR(low / std::sqrt(2 * B), 1, 1e-3);
    // Exactly: n_a cosθ = n_S.
    EXPECT_NEAR(std::cos(low), 1 - B / (1 + law.ambient()), 1e-9);
}

/// Height of the ray 20 m beyond its lowest point, and that point, for a ray at half the critical angle.
struct Bounce {
    RayState lowest, after;
};
Bounce bounce(const TestAir& air, double start_height, double angle) {
    Bounce result;
    TraceSettings settings = finest();
    double lowest = kNever;
    settings.far = 2 * start_height / angle * 1.5 + 40;
    trace(air.now, nullptr, {0, start_height, 0}, {std::cos(angle), -std::sin(angle), 0}, settings, nullptr,
          [&](const Step& step) {
              for (double theta = 0; theta < 1; theta += 1.0 / 64)
                  if (step.position(theta).y < lowest) result.lowest = step.at(theta), lowest = result.lowest.x.y;
              result.after = step.to();
          });
    return result;
}

TEST(Mirage, SmallDropoffIsAMirrorLargeAParabola) {
    const double B = -index_law(at_zero()).above_ambient(305), angle = 0.5 * std::sqrt(2 * B);
    {  // Fig. 2, mirror: the outgoing part continues the mirrored incoming part to a few dropoffs.
        const TestAir air({road(1e-4)}, at_zero());
        const Bounce b = bounce(air, 0.1, angle);
        EXPECT_NEAR(b.after.p.y / b.after.p.x, std::tan(angle), 1e-9);
        const double mirrored = std::tan(angle) * b.after.x.x - 0.1;
        EXPECT_NEAR(b.after.x.y, mirrored, 5e-4);
        TraceSettings settings = usual();
        settings.integrator = Integrator::Mirror;
        settings.surface = road(1e-4);
        settings.far = glm::length(b.after.x);
        const BentHit hit = trace(air.now, nullptr, {0, 0.1, 0}, {std::cos(angle), -std::sin(angle), 0}, settings);
        EXPECT_NEAR(hit.at.p.y / hit.at.p.x, std::tan(angle), 1e-12);
        EXPECT_NEAR(std::tan(angle) * hit.at.x.x - 0.1, hit.at.x.y, 1e-4);
    }
    {  // Fig. 2, parabola: started within a large layer, where the gradient hardly changes.
        const TestAir air({road(10)}, at_zero());
        const double F = glm::length(air.now.force({0, 0.02, 0}, {1, 0, 0})), slope = std::sqrt(2 * F * 0.01);
        const Bounce b = bounce(air, 0.02, slope);
        EXPECT_NEAR(b.lowest.x.y, 0.01, 1e-4);
        const double x = 4;
        TraceSettings settings = finest();
        settings.u_end = x;
        const RayState at = trace(air.now, nullptr, {0, 0.02, 0}, {std::cos(slope), -std::sin(slope), 0}, settings).at;
        EXPECT_NEAR(at.x.y, 0.02 - slope * x + F * x * x / 2, 2e-3 * 0.01);
    }
}

TEST(Mirage, LayersConvergeToTheBentRay) {
    const TestAir air({road(0.01)}, at_zero());
    const auto wall = geometry({plane({60, 0, 0}, {-1, 0, 0})});
    const double B = -index_law(at_zero()).above_ambient(305);
    const auto height = [&](Integrator integrator, double step, double angle) {
        TraceSettings settings = finest();
        settings.integrator = integrator;
        settings.surface = baseline_surface(integrator, {road(0.01)});
        settings.step = step;
        settings.tolerance_px = 1e-6;
        const BentHit hit = trace(air.now, wall.get(), {0, 0.2, 0}, {std::cos(angle), -std::sin(angle), 0}, settings);
        EXPECT_TRUE(hit.hit);
        return hit.at.x.y;
    };
    const double turning = 0.7 * std::sqrt(2 * B);
    const double truth = height(Integrator::Adaptive, 0, turning);
    double before = kNever;
    for (const double slice : {2e-3, 2e-4, 2e-5}) {
        const double off = std::abs(height(Integrator::Layers, slice, turning) - truth);
        EXPECT_LT(off, before);
        before = off;
    }
    EXPECT_LT(before, 2e-3);
    // The ray turns at a boundary or anywhere in a slice. The order is 1/2 in the worst of many thicknesses.
    const auto worst = [&](double slice) {
        double off = 0;
        for (int i = 0; i < 24; ++i)
            off = std::max(off, std::abs(height(Integrator::Layers, slice * (1 + i / 48.0), turning) - truth));
        return off;
    };
    const double thick = worst(1e-3), thin = worst(1e-3 / 64);
    EXPECT_NEAR(std::log2(thick / thin) / 6, 0.5, 0.15);
    // The ray crosses all slices. The order is 2.
    const auto crossing = [&](Integrator integrator, double step) {
        TraceSettings settings = finest();
        settings.integrator = integrator;
        settings.surface = road(0.01);
        settings.step = step;
        const double angle = 1.5 * std::sqrt(2 * B);
        const auto low = geometry({plane({0, 0, 0}, {0, 1, 0})});
        return trace(air.now, low.get(), {0, 0.4, 0}, {std::cos(angle), -std::sin(angle), 0}, settings).at.x.x;
    };
    const double straight = crossing(Integrator::Adaptive, 0);
    const double coarse = std::abs(crossing(Integrator::Layers, 2e-3) - straight);
    const double fine = std::abs(crossing(Integrator::Layers, 5e-4) - straight);
    EXPECT_NEAR(std::log2(coarse / fine) / 2, 2, 0.2);
}

// First and second order perturb the straight ray, which goes on down where the bent ray turns back.
TEST(Mirage, PerturbationsKnowNoTurningRays) {
    const TestAir air({road(0.01)}, at_zero());
    const auto wall = geometry({plane({60, 0, 0}, {-1, 0, 0})}), floor = geometry({plane({0, 0, 0}, {0, 1, 0})});
    const double critical = std::sqrt(-2 * index_law(at_zero()).above_ambient(305));
    const auto end = [&](const Geometry& objects, Integrator integrator, double angle) {
        TraceSettings settings = finest();
        settings.integrator = integrator;
        settings.step = integrator == Integrator::Adaptive ? 0 : 0.001;
        return trace(air.now, &objects, {0, 0.2, 0}, {std::cos(angle), -std::sin(angle), 0}, settings).at.x;
    };
    const auto off = [&](const Geometry& objects, Integrator integrator, double angle) {
        return glm::length(end(objects, integrator, angle) - end(objects, Integrator::Adaptive, angle));
    };
    for (const Integrator integrator : {Integrator::FirstOrder, Integrator::SecondOrder})
        EXPECT_GT(off(*wall, integrator, 0.7 * critical), 0.05);
    // The steeper a ray, the smaller its error. It meets the floor in the direction of a straight ray. Where the floor
    // is oblique, second order is no better than first order.
    for (const Integrator integrator : {Integrator::FirstOrder, Integrator::SecondOrder}) {
        const double gentle = off(*floor, integrator, 2 * critical), steep = off(*floor, integrator, 10 * critical);
        EXPECT_LT(gentle, 0.02);
        EXPECT_LT(steep, gentle / 1000);
    }
}

TEST(Mirage, MirrorReflectsBelowTheCriticalAngleOnly) {
    const TestAir air({road(0.01)}, at_zero());
    const auto floor = geometry({plane({0, 0, 0}, {0, 1, 0}), plane({300, 0, 0}, {-1, 0, 0})});
    const double critical = std::sqrt(-2 * index_law(at_zero()).above_ambient(305));
    TraceSettings settings = usual();
    settings.integrator = Integrator::Mirror;
    settings.surface = road(0.01);
    for (const double part : {0.99, 1.01}) {
        const double angle = part * critical;
        const BentHit hit = trace(air.now, floor.get(), {0, 1, 0}, {std::cos(angle), -std::sin(angle), 0}, settings);
        ASSERT_TRUE(hit.hit);
        EXPECT_EQ(hit.surface.object, part < 1 ? 1 : 0);
        if (part < 1) {
            EXPECT_NEAR(hit.at.x.y, 300 * std::tan(angle) - 1, 1e-2);
        }
    }
}

TEST(Mirage, BaselinesRefuseOtherScenes) {
    for (const Integrator integrator : {Integrator::Layers, Integrator::Mirror}) {
        EXPECT_THROW(baseline_surface(integrator, {}), UserError);
        EXPECT_THROW(baseline_surface(integrator, {BlobsSpec{}}), UserError);
        EXPECT_THROW(baseline_surface(integrator, {road(0.01), road(0.01)}), UserError);
        EXPECT_TRUE(baseline_surface(integrator, {road(0.01)}));
    }
    EXPECT_FALSE(baseline_surface(Integrator::Adaptive, {}));
}

}  // namespace
}  // namespace eikonal::reference
