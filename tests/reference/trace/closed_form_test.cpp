/// Bent rays against closed forms (PHYSICS.md#closed-forms), at the finest tolerance.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "noise/medium/optics.h"
#include "noise/medium/refractivity.h"
#include "noise/profile/profile_spec.h"
#include "reference/trace/bent_ray.h"
#include "tests/reference/trace/bent_ray_scenes.h"

namespace eikonal::reference {
namespace {

TEST(ClosedForm, LuneburgFocusesOnItsFarSide) {
    const TestAir air({profile(ProfileKind::Luneburg)});
    const double y = 0.5, x = -std::sqrt(0.75);
    // x'' = -x inside: cos and sin of u. All rays along +x meet at (1, 0) a quarter turn on, at any height.
    const RayState at = end_of(air, {x, y, 0}, {1, 0, 0}, finest(), pi / 2);
    EXPECT_LE(distance(at, {1, 0, 0}, {-x, -y, 0}), kClosedFormError);
    // From outside, and beyond: straight on from the focus.
    const double way = x + 3;
    const RayState beyond = end_of(air, {-3, y, 0}, {1, 0, 0}, finest(), way + pi / 2 + 2);
    EXPECT_LE(distance(beyond, dvec3(1, 0, 0) + 2.0 * dvec3(-x, -y, 0), {-x, -y, 0}), kClosedFormError);
}

TEST(ClosedForm, FishEyeRaysAreCircles) {
    const double n0 = 2;
    ProfileSpec spec = profile(ProfileKind::FishEye);
    spec.n0 = n0;
    const TestAir air({spec});
    // (1, 0) at 120 degrees: a circle through (±1, 0) with centre (0, -1/√3·…): tangent at the start is perpendicular
    // to the radius, so the centre is (0, c) with (1, -c)·(-1/2, √3/2) = 0, c = -1/√3.
    const dvec3 start{1, 0, 0}, d{-0.5, std::sqrt(0.75), 0}, center{0, -1 / std::sqrt(3.0), 0};
    const double radius = std::sqrt(4.0 / 3);
    const auto wall = geometry({plane({-1, 0, 0}, {1, 0, 0})});
    double worst = 0;
    const BentHit hit = trace(air.now, wall.get(), start, d, finest(), nullptr, [&](const Step& step) {
        for (const double theta : {0.0, 0.3, 0.5, 0.8}) {
            const RayState at = step.at(theta);
            const double n = n0 / (1 + glm::dot(at.x, at.x));
            worst = std::max(worst, std::abs(glm::length(at.x - center) - radius));
            worst = std::max(worst, std::abs(glm::dot(at.p, at.p) - n * n));
        }
    });
    ASSERT_TRUE(hit.hit);
    EXPECT_LE(worst, kClosedFormError);
    EXPECT_LE(glm::length(hit.at.x - dvec3(-1, 0, 0)), kClosedFormError);
    EXPECT_LE(glm::length(hit.at.p - dvec3(-0.5, -std::sqrt(0.75), 0)), kClosedFormError);
    EXPECT_NEAR(hit.length, 2 * pi / 3 * radius, kClosedFormError);
}

TEST(ClosedForm, LinearSquaredIsAParabola) {
    ProfileSpec spec = profile(ProfileKind::LinearSquared);
    spec.axis = {0, 0, 1};
    spec.slope = 1;
    const TestAir air({spec});
    // n² = 1 + z, from the origin along x: x = u, z = u²/4 = x²/4.
    for (const double u : {0.3, 1.0, 4.0})
        EXPECT_LE(distance(end_of(air, {0, 0, 0}, {1, 0, 0}, finest(), u), {u, 0, u * u / 4}, {1, 0, u / 2}),
                  kClosedFormError);
    // Against the gradient: down to z = -sin², where it turns back, and up again.
    const double s = 0.6, c = 0.8;
    EXPECT_LE(distance(end_of(air, {0, 0, 0}, {c, 0, -s}, finest(), 4 * s), {4 * s * c, 0, 0}, {c, 0, s}),
              kClosedFormError);
}

TEST(ClosedForm, WeakGradientOverHalfAKilometre) {
    ProfileSpec spec = profile(ProfileKind::Linear);
    spec.slope = 1e-6;
    const TestAir air({spec});
    const auto wall = geometry({plane({500, 0, 0}, {-1, 0, 0})});
    const BentHit hit = trace(air.now, wall.get(), {0, 0, 0}, {1, 0, 0}, finest());
    ASSERT_TRUE(hit.hit);
    // n = 1 + gs in u: s'' = g(1 + gs), so s = (cosh gu - 1)/g and x = u.
    EXPECT_NEAR(hit.at.x.y, (std::cosh(5e-4) - 1) / 1e-6, kClosedFormError);
    EXPECT_NEAR(hit.at.x.y, 0.125, 1e-6);
    EXPECT_NEAR(hit.at.p.y / hit.at.p.x, 500e-6, 1e-9);
    EXPECT_NEAR(hit.at.x.y / 500, 250e-6, 1e-9);
    EXPECT_LE(hit.steps, 200);
    // Every method, at its own step: the bend is constant to 5e-4.
    for (const Integrator integrator :
         {Integrator::Rk4, Integrator::Leapfrog, Integrator::FirstOrder, Integrator::SecondOrder}) {
        TraceSettings settings = fixed(integrator, 10);
        const BentHit other = trace(air.now, wall.get(), {0, 0, 0}, {1, 0, 0}, settings);
        ASSERT_TRUE(other.hit);
        EXPECT_NEAR(other.at.x.y, 0.125, 1e-6) << static_cast<int>(integrator);
    }
}

TEST(ClosedForm, RodAndSechArePeriodic) {
    ProfileSpec rod = profile(ProfileKind::Rod);
    rod.axis = {1, 0, 0};
    rod.n0 = 1.5;
    rod.g = 0.5;
    const TestAir air({rod});
    // ρ'' = -n0² g² ρ in u, and the part of p along the axis stays.
    const double n = 1.5 * std::sqrt(1 - 0.25 * 0.25 * 0.25 * 4);
    const dvec3 start{0, 0.5, 0};
    const double period = 2 * pi / (1.5 * 0.5);
    EXPECT_LE(distance(end_of(air, start, {1, 0, 0}, finest(), period), {n * period, 0.5, 0}, {n, 0, 0}),
              kClosedFormError);

    ProfileSpec sech = profile(ProfileKind::Sech);
    sech.axis = {1, 0, 0};
    sech.g = 0.8;
    const TestAir other({sech});
    // sinh(gρ) = sinh(gρ0) cos(gz): every ray in a plane through the axis meets it a quarter period on.
    for (const double y : {0.3, 1.0}) {
        const auto wall = geometry({plane({0.5 * pi / 0.8, 0, 0}, {-1, 0, 0})});
        const BentHit hit = trace(other.now, wall.get(), {0, y, 0}, {1, 0, 0}, finest());
        ASSERT_TRUE(hit.hit);
        EXPECT_NEAR(hit.at.x.y, 0, kClosedFormError);
    }
}

TEST(ClosedForm, LayeredMediaKeepSnellsConstant) {
    ProfileSpec spec = profile(ProfileKind::Exponential);
    spec.slope = 0.3;
    const TestAir air({spec});
    double worst = 0;
    TraceSettings settings = finest();
    settings.far = 20;
    const dvec3 d = glm::normalize(dvec3(1, -0.7, 0.2));
    trace(air.now, nullptr, {0, 1, 0}, d, settings, nullptr, [&](const Step& step) {
        const RayState at = step.to();
        const double n = std::exp(0.3 * at.x.y), n1 = std::exp(0.3);
        worst = std::max(worst, std::abs(glm::length(at.p) / n - 1));
        worst = std::max(worst, glm::length(dvec3(at.p.x - n1 * d.x, 0, at.p.z - n1 * d.z)));
    });
    EXPECT_LE(worst, kClosedFormError);
}

TEST(ClosedForm, PaperConventionBendsHalfAsMuch) {
    OpticsSpec optics;
    optics.ray_equation = RayEquation::Paper;
    ProfileSpec spec = profile(ProfileKind::Linear);
    spec.slope = 0.01;
    const TestAir air({spec}, optics);
    // F = g/2 constant.
    EXPECT_LE(distance(end_of(air, {0, 0, 0}, {1, 0, 0}, finest(), 10), {10, 0.25, 0}, {1, 0.05, 0}), kClosedFormError);
}

}  // namespace
}  // namespace eikonal::reference
