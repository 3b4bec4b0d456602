/// Bent rays: order and error of every integrator, perturbation theory and edges. No ray may run for ever or step over
/// a thin medium.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "noise/base/error.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/medium/optics.h"
#include "noise/medium/refractivity.h"
#include "noise/profile/profile_spec.h"
#include "noise/surface/surface_spec.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "reference/trace/bent_ray.h"
#include "tests/reference/trace/bent_ray_scenes.h"

namespace eikonal::reference {
namespace {

// ---- Order and tolerance

double luneburg_error(const TraceSettings& settings) {
    static const TestAir air({profile(ProfileKind::Luneburg)});
    const double x = -std::sqrt(0.75);
    return distance(end_of(air, {-1.5, 0.5, 0}, {1, 0, 0}, settings, x + 1.5 + pi / 2 + 0.3),
                    dvec3(1, 0, 0) + 0.3 * dvec3(-x, -0.5, 0), {-x, -0.5, 0});
}

TEST(Order, ShowsWhenStepsAreHalved) {
    // The way through Luneburg's sphere has two jumps of F, which must not lower the order.
    const std::pair<Integrator, double> methods[] = {
        {Integrator::Adaptive, 5}, {Integrator::Rk4, 4}, {Integrator::Leapfrog, 2}, {Integrator::Euler, 1}};
    for (const auto& [integrator, order] : methods) {
        // The highest order soon reaches rounding.
        const int halvings = order == 5 ? 1 : 3;
        const double first = luneburg_error(fixed(integrator, 0.1));
        const double last = luneburg_error(fixed(integrator, 0.1 / (1 << halvings)));
        EXPECT_NEAR(std::log2(first / last) / halvings, order, 0.3) << static_cast<int>(integrator);
    }
}

TEST(Order, LeapfrogIsSymplectic) {
    // |p|² - n² oscillates but does not drift: a hundred periods of the rod are as good as one.
    ProfileSpec rod = profile(ProfileKind::Rod);
    rod.axis = {1, 0, 0};
    const TestAir air({rod});
    for (const Integrator integrator : {Integrator::Leapfrog, Integrator::Rk4}) {
        double early = 0, late = 0;
        TraceSettings settings = fixed(integrator, 0.1);
        settings.far = kNever;
        settings.u_end = 200 * pi;
        trace(air.now, nullptr, {0, 0.5, 0}, {1, 0, 0}, settings, nullptr, [&](const Step& step) {
            const double off = std::abs(glm::dot(step.from.p, step.from.p) - 1 + step.from.x.y * step.from.x.y);
            (step.from.u < 2 * pi ? early : late) = std::max(step.from.u < 2 * pi ? early : late, off);
        });
        if (integrator == Integrator::Leapfrog)
            EXPECT_LT(late, 1.01 * early);
        else
            EXPECT_GT(late, 10 * early);
    }
}

TEST(Tolerance, BoundsTheErrorAndIsReported) {
    const TestAir air({profile(ProfileKind::FishEye)});
    const auto wall = geometry({plane({-1, 0, 0}, {1, 0, 0})});
    const dvec3 d{-0.5, std::sqrt(0.75), 0};
    int steps = 0;
    for (const double tolerance : {1.0, 0.1, 1e-2, 1e-4, 1e-6}) {
        TraceSettings settings = usual();
        settings.tolerance_px = tolerance;
        const BentHit hit = trace(air.now, wall.get(), {1, 0, 0}, d, settings);
        ASSERT_TRUE(hit.hit);
        const double error = glm::length(hit.at.x - dvec3(-1, 0, 0)) / hit.length / settings.pixel;
        EXPECT_LE(error, tolerance);
        EXPECT_LE(error, hit.error_px);
        EXPECT_LE(hit.error_px, 10 * tolerance);
        EXPECT_GE(hit.steps, steps);
        steps = hit.steps;
    }
    // The same for parallel rays, in metres.
    TraceSettings settings = usual();
    settings.perspective = false;
    settings.pixel = 0.01;
    settings.far = 4;
    const BentHit hit = trace(air.now, wall.get(), {1, 0, 0}, d, settings);
    EXPECT_LE(glm::length(hit.at.x - dvec3(-1, 0, 0)), settings.tolerance_px * settings.pixel);
}

// Among blobs, steps are as long as a blob. The estimates of the steps do not contain what lies between the steps.
TEST(Tolerance, TheErrorIsNoLessThanItIsSaidToBe) {
    BlobsSpec blobs;
    blobs.blobs = {{{0, 0.8, -30}, 0.3, 600}, {{0.4, 0.7, -60}, 0.2, 700}, {{-0.6, 0.5, -50}, 0.25, 500}};
    const TestAir air({blobs});
    const auto wall = geometry({plane({0, 0, -300}, {0, 0, 1})});
    for (const double tolerance : {0.1, 0.01}) {
        TraceSettings settings = usual(), exact = usual();
        settings.tolerance_px = tolerance;
        exact.tolerance_px = 1e-6;
        int beyond = 0, rays = 0;
        for (double x = -1; x <= 1; x += 0.125)
            for (double y = 0; y <= 1.2; y += 0.125) {
                const dvec3 from(0, 1.2, 0), d = glm::normalize(dvec3(x, y, -60) - from);
                const BentHit a = trace(air.now, wall.get(), from, d, settings),
                              b = trace(air.now, wall.get(), from, d, exact);
                const double error = glm::distance(a.at.x, b.at.x) / a.length / settings.pixel;
                EXPECT_LE(error, tolerance);
                if (error > a.error_px) ++beyond;
                ++rays;
            }
        EXPECT_LE(beyond, 0.05 * rays) << tolerance;
    }
}

TEST(Tolerance, FixedStepsEstimateTheirErrors) {
    const TestAir air({profile(ProfileKind::FishEye)});
    const auto wall = geometry({plane({-1, 0, 0}, {1, 0, 0})});
    const dvec3 d{-0.5, std::sqrt(0.75), 0};
    for (const Integrator integrator : {Integrator::Rk4, Integrator::Leapfrog, Integrator::Euler}) {
        const BentHit hit = trace(air.now, wall.get(), {1, 0, 0}, d, fixed(integrator, 0.02));
        ASSERT_TRUE(hit.hit);
        const double error = glm::length(hit.at.x - dvec3(-1, 0, 0)) / hit.length;
        EXPECT_LE(error, 3 * hit.error_px) << static_cast<int>(integrator);
        EXPECT_GE(error, 0.02 * hit.error_px) << static_cast<int>(integrator);
    }
}

// ---- Surfaces met by curves

// ---- Perturbation

TEST(Perturbation, ErrsByTheNextPowerOfTheStrength) {
    const dvec3 d = glm::normalize(dvec3(1, 0.004, 0.003));
    const auto wall = geometry({plane(10.0 * d, -d)});
    const auto error = [&](Integrator integrator, double exaggeration) {
        OpticsSpec optics;
        optics.exaggeration = exaggeration;
        const TestAir air({one_blob({4, -0.06, 0}, 0.1)}, optics);
        TraceSettings settings = finest();
        const BentHit truth = trace(air.now, wall.get(), {0, 0, 0}, d, settings);
        settings.integrator = integrator;
        settings.step = 0.01;
        const BentHit hit = trace(air.now, wall.get(), {0, 0, 0}, d, settings);
        return glm::length(hit.at.x - truth.at.x);
    };
    for (const auto& [integrator, order] : {std::pair{Integrator::FirstOrder, 2.0}, {Integrator::SecondOrder, 3.0}})
        EXPECT_NEAR(std::log2(error(integrator, 20) / error(integrator, 5)) / 2, order, 0.2) << order;
}

TEST(Perturbation, QuadratureIsOfOrderFour) {
    const TestAir air({one_blob({1, -0.3, 0}, 0.4)});
    const auto wall = geometry({plane({2, 0, 0}, {-1, 0, 0})});
    for (const Integrator integrator : {Integrator::FirstOrder, Integrator::SecondOrder}) {
        const auto at = [&](double step) {
            return trace(air.now, wall.get(), {0, 0, 0}, {1, 0, 0}, fixed(integrator, step)).at.x;
        };
        const dvec3 truth = at(0.005);
        const double order = std::log2(glm::length(at(0.125) - truth) / glm::length(at(0.0625) - truth));
        EXPECT_NEAR(order, 4, 0.5) << static_cast<int>(integrator);
    }
}

TEST(Perturbation, AWholePassBendsAsInClosedForm) {
    // PHYSICS.md#blobs: 13.804 µrad for n_j = -1e-5, σ = 0.1, b = 0.05. T for that n_j with the default index law.
    const IndexLaw law = index_law(OpticsSpec{});
    const double T = 1 / (1 / law.ambient_temperature - 1e-5 / (law.refractivity * law.T0));
    const TestAir air({one_blob({2, -0.05, 0}, 0.1, T)});
    TraceSettings settings = finest();
    settings.far = 4;
    const BentHit bent = trace(air.now, nullptr, {0, 0, 0}, {1, 0, 0}, settings);
    // Hot air pushes the ray away from its middle. n∇n over n²: the angle is ∇n's over n.
    EXPECT_NEAR(bent.at.p.y / bent.at.p.x, 13.804e-6, 0.01e-6);
}

// ---- Nothing is passed over, nothing hangs

TEST(Steps, NeverSkipThinThings) {
    const auto wall = geometry({plane({200, 0, 0}, {-1, 0, 0})});
    {  // A layer of 1 mm, met after 100 m.
        const SurfaceSpec thin = road(1e-3);
        const TestAir air({thin}, at_zero());
        const double angle = 0.5 * std::sqrt(-2 * index_law(at_zero()).above_ambient(305));
        const dvec3 origin{0, 100 * std::tan(angle), 0}, d{std::cos(angle), -std::sin(angle), 0};
        for (const Integrator integrator : kTrueIntegrators) {
            TraceSettings settings = usual();
            settings.integrator = integrator;
            const BentHit hit = trace(air.now, wall.get(), origin, d, settings);
            ASSERT_TRUE(hit.hit);
            // Euler, too, turns back, but gains energy in a bend of few steps.
            EXPECT_NEAR(hit.at.p.y / hit.at.p.x, std::tan(angle), integrator == Integrator::Euler ? 3e-3 : 1e-5)
                << static_cast<int>(integrator);
        }
    }
    {  // A blob of 1 mm at 100 m, hit at its steepest.
        const double sigma = 1e-3;
        const TestAir air({one_blob({100, -sigma / std::sqrt(2.0), 0}, sigma)});
        const double nj = index_law(OpticsSpec{}).above_ambient(1000);
        const double expected = -2 * std::sqrt(pi) * nj * std::sqrt(0.5) * std::exp(-0.5);
        for (const Integrator integrator : kTrueIntegrators) {
            TraceSettings settings = usual();
            settings.integrator = integrator;
            settings.tolerance_px = 1e-4;
            const BentHit hit = trace(air.now, wall.get(), {0, 0, 0}, {1, 0, 0}, settings);
            EXPECT_NEAR(hit.at.p.y / hit.at.p.x, expected, 0.02 * expected) << static_cast<int>(integrator);
        }
    }
}

TEST(Steps, TrappedRaysEnd) {
    ProfileSpec eye = profile(ProfileKind::FishEye);
    eye.n0 = 2;
    const TestAir air({eye});
    // (Euler's spirals out instead.)
    for (const Integrator integrator : {Integrator::Adaptive, Integrator::Rk4, Integrator::Leapfrog}) {
        TraceSettings settings = usual();
        settings.integrator = integrator;
        settings.step_budget = 500;
        settings.far = 1e9;
        const BentHit hit = trace(air.now, nullptr, {1, 0, 0}, {0, 1, 0}, settings);
        EXPECT_EQ(hit.end, BentHit::End::Unfinished);
        EXPECT_EQ(hit.steps, 500);
        EXPECT_TRUE(std::isfinite(hit.at.x.x + hit.at.p.x + hit.error_px));
        // If it is allowed to, the ray ends sooner, after 32 turns.
        settings.end_trapped = true;
        settings.step_budget = 100000;
        const BentHit seen = trace(air.now, nullptr, {1, 0, 0}, {0, 1, 0}, settings);
        EXPECT_EQ(seen.end, BentHit::End::Trapped);
        EXPECT_LE(seen.steps, 8 * 250);
    }
    // A ray in a guide at 80 degrees to the axis advances, however often it turns.
    ProfileSpec rod = profile(ProfileKind::Rod);
    rod.n0 = 1.5;
    rod.g = 0.3;
    rod.axis = {0, 1, 0};
    const TestAir guide({rod});
    const auto wall = geometry({plane({0, 100, 0}, {0, -1, 0})});
    TraceSettings settings = usual();
    settings.end_trapped = true;
    const BentHit far = trace(guide.now, wall.get(), {0, 0, 0}, {std::sin(1.4), std::cos(1.4), 0}, settings);
    EXPECT_EQ(far.end, BentHit::End::Surface);
}

// Air from weak shimmer to air in which every ray is trapped. Rays that arrive are the same with and without the early
// end of trapped rays.
TEST(Steps, OnlyTrappedRaysAreEndedEarly) {
    const auto wall = geometry({plane({0, 0, -3}, {0, 0, 1})});
    int arrived = 0, ended = 0;
    for (const double cn2 : {1e-12, 1e-4, 1e-3, 3e-3, 1e-2, 1.0, 1e12}) {
        TurbulenceSpec spec;
        spec.form = TurbulenceForm::Lattice;
        spec.lattice = {32, 32, 32, 1};
        spec.period = {1.0, 1.0, 1.0, 1.0};
        spec.outer_scale = 0.5;
        spec.inner_scale = 0.06;
        spec.cn2 = cn2;
        const TestAir air({spec});
        for (int i = 0; i < 12; ++i) {
            const dvec3 d = glm::normalize(dvec3(0.05 * (i % 4) - 0.1, 0.05 * (i / 4) - 0.05, -1));
            TraceSettings settings = usual();
            settings.tolerance_px = 0.1;
            settings.step_budget = 50000;
            settings.end_trapped = true;
            const BentHit seen = trace(air.now, wall.get(), {0.3, 0.4, 0}, d, settings);
            settings.end_trapped = false;
            if (seen.end == BentHit::End::Trapped) {
                ++ended;
                EXPECT_LE(seen.steps, 50000);
                if (i >= 2) continue;
                EXPECT_FALSE(trace(air.now, wall.get(), {0.3, 0.4, 0}, d, settings).ended()) << cn2;
                continue;
            }
            const BentHit whole = trace(air.now, wall.get(), {0.3, 0.4, 0}, d, settings);
            EXPECT_EQ(seen.end, whole.end);
            EXPECT_EQ(seen.at.x, whole.at.x);
            arrived += seen.hit;
        }
    }
    EXPECT_GE(arrived, 12);
    EXPECT_GE(ended, 12);
}

TEST(Steps, EndWhereThereIsNoIndex) {
    OpticsSpec absurd;
    absurd.exaggeration = 1e5;
    const TestAir air({one_blob({0, 0, 0}, 0.1)}, absurd);
    const BentHit inside = trace(air.now, nullptr, {0, 0, 0}, {1, 0, 0}, usual());
    EXPECT_EQ(inside.end, BentHit::End::NoIndex);
    // A ray towards n <= 0 is turned back or ended. It never goes through or runs for ever, and it is always finite.
    for (const Integrator integrator : {Integrator::Adaptive, Integrator::Rk4, Integrator::Leapfrog, Integrator::Euler,
                                        Integrator::FirstOrder, Integrator::SecondOrder}) {
        for (int i = 0; i < 50; ++i) {
            TraceSettings settings = usual();
            settings.integrator = integrator;
            settings.step_budget = 3000;
            const BentHit hit = trace(air.now, nullptr, {-2, 0.01 * i - 0.25, 0}, {1, 0, 0}, settings);
            EXPECT_TRUE(std::isfinite(glm::length(hit.at.x) + glm::length(hit.at.p) + hit.length + hit.error_px));
            EXPECT_LE(hit.steps, 3000);
        }
    }
}

TEST(Steps, StartAnywhere) {
    // Inside a medium, on an edge, leaving a surface.
    const TestAir lens({profile(ProfileKind::Luneburg)});
    EXPECT_LE(distance(end_of(lens, {0, 0.5, 0}, {1, 0, 0}, finest(), 0.5),
                       {std::sqrt(1.75) * std::sin(0.5), 0.5 * std::cos(0.5), 0},
                       {std::sqrt(1.75) * std::cos(0.5), -0.5 * std::sin(0.5), 0}),
              kClosedFormError);
    const TestAir air({road(0.01)}, at_zero());
    const auto floor = geometry({plane({0, 0, 0}, {0, 1, 0}), plane({50, 0, 0}, {-1, 0, 0})});
    Hit hit;
    hit.point = {0, 0, 0};
    hit.normal = {0, 1, 0};
    const BentHit up = trace(air.now, floor.get(), floor->leave(hit), {std::cos(0.02), std::sin(0.02), 0}, usual());
    ASSERT_TRUE(up.hit);
    EXPECT_EQ(up.surface.object, 1);
    EXPECT_GT(up.at.x.y, 0.9);
}

// ---- The path as text

}  // namespace
}  // namespace eikonal::reference
