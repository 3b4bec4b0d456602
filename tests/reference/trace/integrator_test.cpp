/// Bent rays: order and error of every integrator, edges, surfaces met by curves, mirages, and what must never hang or
/// be passed over.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <sstream>

#include "noise/base/error.h"
#include "noise/medium/refractivity.h"
#include "reference/trace/baselines.h"
#include "reference/trace/bent_ray.h"
#include "reference/trace/path.h"
#include "reference/trace/perturbation.h"
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
    // Through Luneburg's sphere, with two jumps of F on the way, which must not spoil it.
    const std::pair<Integrator, double> methods[] = {
        {Integrator::Adaptive, 5}, {Integrator::Rk4, 4}, {Integrator::Leapfrog, 2}, {Integrator::Euler, 1}};
    for (const auto& [integrator, order] : methods) {
        // The highest order comes down to rounding soon.
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

// Among blobs steps are as long as these: what they miss by luck their own estimates do not see.
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
            // This curve is a polynomial: no method errs in it.
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
    // A ball in the curve's bow: its chords cut it, the curve does not; and one that it just touches.
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
    // Straight where there is no medium: one step to any distance.
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
        // Sooner, if it may: after 32 times round.
        settings.end_trapped = true;
        settings.step_budget = 100000;
        const BentHit seen = trace(air.now, nullptr, {1, 0, 0}, {0, 1, 0}, settings);
        EXPECT_EQ(seen.end, BentHit::End::Trapped);
        EXPECT_LE(seen.steps, 8 * 250);
    }
    // A ray in a guide at 80 degrees to its axis gets ahead, however often it turns.
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

// Air in which rays lose their way, from mere shimmer to no way at all: what arrives is what arrives without looking.
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
    // Towards it: turned back, or ended; never through, never hanging, always finite.
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

TEST(Path, IsWrittenSmoothlyUpToItsEnd) {
    const TestAir air({profile(ProfileKind::Luneburg)});
    TraceSettings settings = usual();
    settings.u_end = 5;
    const auto wall = geometry({plane({1.5, 0, 0}, {-1, 0, 0})});
    std::ostringstream text;
    const BentHit hit = write_path(air.now, wall.get(), {-2, 0.5, 0}, {1, 0, 0}, settings, text, "ray.csv");
    ASSERT_TRUE(hit.hit);
    std::istringstream lines(text.str());
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "u,x,y,z,px,py,pz");
    int rows = 0;
    double u_before = -1;
    std::array<double, 7> row{};
    dvec3 direction(1, 0, 0);
    while (std::getline(lines, line)) {
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream numbers(line);
        for (double& number : row) numbers >> number;
        EXPECT_GT(row[0], u_before);
        u_before = row[0];
        const dvec3 d = glm::normalize(dvec3(row[4], row[5], row[6]));
        EXPECT_LE(glm::length(d - direction), 1.2 * kPathTurn);
        direction = d;
        ++rows;
    }
    EXPECT_GT(rows, 40);
    EXPECT_EQ(row[0], hit.at.u);
    EXPECT_EQ(dvec3(row[1], row[2], row[3]), hit.at.x);
}

// x0(u) + x1(u) from the origin on, and p its derivative; what second order adds is closer to the bent ray.
TEST(Path, OfFirstAndSecondOrderIsThePerturbedCurve) {
    const double sigma = 0.3;
    OpticsSpec strong;
    strong.exaggeration = 20;
    const TestAir air({one_blob({2, -0.2, 0}, sigma)}, strong);
    const auto wall = geometry({plane({5, 0, 0}, {-1, 0, 0.3})});
    const dvec3 origin{0, 0, 0}, d{1, 0, 0};
    const double speed = air.now.speed(origin);
    TraceSettings settings = usual();
    settings.perspective = false;
    settings.tolerance_px = 1e-6;
    settings.pixel = 1;
    settings.u_end = 10;
    std::ostringstream ignored;
    const BentHit truth = write_path(air.now, wall.get(), origin, d, settings, ignored, "ray.csv");
    double error[2];
    for (const bool second : {false, true}) {
        settings.integrator = second ? Integrator::SecondOrder : Integrator::FirstOrder;
        std::stringstream text;
        const BentHit hit = write_path(air.now, wall.get(), origin, d, settings, text, "ray.csv");
        ASSERT_TRUE(hit.hit);
        EXPECT_NEAR(glm::dot(hit.at.x - dvec3(5, 0, 0), glm::normalize(dvec3(-1, 0, 0.3))), 0, 1e-12);
        EXPECT_GT(hit.length, glm::length(hit.at.x));
        error[second] = glm::length(hit.at.x - truth.at.x);
        std::string line;
        std::getline(text, line);
        std::vector<RayState> rows;
        while (std::getline(text, line)) {
            std::replace(line.begin(), line.end(), ',', ' ');
            std::istringstream numbers(line);
            RayState& row = rows.emplace_back();
            numbers >> row.u >> row.x.x >> row.x.y >> row.x.z >> row.p.x >> row.p.y >> row.p.z;
        }
        ASSERT_GT(rows.size(), 10u);
        EXPECT_EQ(rows.front().u, 0);
        EXPECT_EQ(rows.front().x, origin);
        EXPECT_EQ(rows.front().p, speed * d);
        EXPECT_EQ(rows.back().x, hit.at.x);
        for (std::size_t i = 1; i < rows.size(); ++i) {
            const double h = rows[i].u - rows[i - 1].u;
            const dvec3 mean = 0.5 * (rows[i].p + rows[i - 1].p);
            EXPECT_LE(glm::length((rows[i].x - rows[i - 1].x) / h - mean), 2e-4) << i;
        }
        if (second) continue;
        // By Simpson's rule: x1(u) = ∫ (u - w) F(x0(w)) dw.
        const RayState& end = rows.back();
        constexpr int kParts = 2000;
        dvec3 x1(0);
        for (int i = 0; i <= kParts; ++i) {
            const double w = end.u * i / kParts, weight = i == 0 || i == kParts ? 1 : i % 2 ? 4 : 2;
            x1 += weight * (end.u - w) * air.now.force(origin + w * speed * d, speed * d);
        }
        x1 *= end.u / (3 * kParts);
        EXPECT_LE(glm::length(origin + end.u * speed * d + x1 - end.x), 1e-6);
        EXPECT_GT(glm::length(x1), 1e-3);
    }
    EXPECT_LT(error[1], 0.3 * error[0]);
}

// In a rod F = -w² x⊥, w = n0 g, so that x1 and x2 of a straight ray are polynomials.
TEST(Path, OfFirstAndSecondOrderKeepsTheTolerance) {
    ProfileSpec rod = profile(ProfileKind::Rod);
    rod.axis = {0, 0, 1};
    rod.n0 = 1.5;
    rod.g = 0.05;
    const TestAir air({rod});
    const dvec3 origin{0.5, 0.2, 0}, d = glm::normalize(dvec3(0.05, 0, 1));
    const double u = 20, w2 = 1.5 * 1.5 * 0.05 * 0.05, speed = air.now.speed(origin);
    for (const bool second : {false, true})
        for (const double tolerance : {1e-5, 1e-8, 1e-11}) {
            TraceSettings settings = usual();
            settings.integrator = second ? Integrator::SecondOrder : Integrator::FirstOrder;
            settings.perspective = false;
            settings.pixel = 1;
            settings.tolerance_px = tolerance;
            settings.u_end = u;
            std::ostringstream ignored;
            const BentHit end = write_path(air.now, nullptr, origin, d, settings, ignored, "ray.csv");
            EXPECT_EQ(end.end, BentHit::End::Escaped);
            for (int k = 0; k < 2; ++k) {
                const double a = origin[k], b = speed * d[k];
                double x = a + b * u - w2 * (a * u * u / 2 + b * std::pow(u, 3) / 6);
                if (second) x += w2 * w2 * (a * std::pow(u, 4) / 24 + b * std::pow(u, 5) / 120);
                EXPECT_NEAR(end.at.x[k], x, tolerance) << second << k;
            }
        }
}

}  // namespace
}  // namespace eikonal::reference
