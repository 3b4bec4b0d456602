/// Neighbours of a bent ray (ray differentials), compared with rays traced beside it and with closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "noise/blobs/blobs_spec.h"
#include "noise/medium/optics.h"
#include "noise/profile/profile_spec.h"
#include "tests/reference/trace/bent_ray_scenes.h"

namespace eikonal::reference {
namespace {

TEST(Differentials, AgreeWithNeighbouringRays) {
    OpticsSpec optics;
    optics.exaggeration = 30;
    BlobsSpec blobs;
    blobs.blobs = {{{2, -0.1, 0.05}, 0.3, 900}, {{3, 0.2, -0.1}, 0.4, 700}, {{4, 0, 0}, 0.5, 1200}};
    const TestAir air({blobs, road(2, 330)}, optics);
    const auto wall = geometry({plane({6, 0, 0}, glm::normalize(dvec3(-1, 0.3, 0.2)))});
    const dvec3 origin{0, 0.5, 0}, d = glm::normalize(dvec3(1, -0.05, 0.01)), right{0, 0, 1}, up = glm::cross(right, d);
    TraceSettings settings = finest();
    for (const bool perspective : {true, false}) {
        Bundle pixels;
        for (std::size_t i = 0; i < 2; ++i) (perspective ? pixels[i].p : pixels[i].x) = i == 0 ? right : up;
        Bundle bundle = pixels;
        const BentHit hit = trace(air.now, wall.get(), origin, d, settings, &bundle);
        ASSERT_TRUE(hit.hit);
        const Bundle there = on_surface(bundle, hit.at, hit.surface.normal);
        for (std::size_t i = 0; i < 2; ++i) {
            const auto at = [&](double part) {
                const BentHit other = trace(air.now, wall.get(), origin + part * pixels[i].x,
                                            glm::normalize(d + part * pixels[i].p), settings);
                return other.at.x;
            };
            constexpr double kPart = 1e-4;
            const dvec3 difference = (at(kPart) - at(-kPart)) / (2 * kPart);
            EXPECT_LE(glm::length(difference - there[i].x), 1e-5 * glm::length(difference)) << perspective << i;
        }
    }
}

TEST(Differentials, PassJumpsOfTheForce) {
    // All parallel rays meet in Luneburg's focus. The cross-section of the bundle is zero there and negative behind it.
    const TestAir air({profile(ProfileKind::Luneburg)});
    for (const double y : {0.0, 0.3, -0.6}) {
        Bundle pixels;
        pixels[0].x = {0, 0, 1};
        pixels[1].x = {0, 1, 0};
        TraceSettings settings = finest();
        const double x = -std::sqrt(1 - y * y);
        settings.u_end = x + 3 + pi / 2;
        Bundle bundle = pixels;
        const BentHit focus = trace(air.now, nullptr, {-3, y, 0}, {1, 0, 0}, settings, &bundle);
        const dvec3 d = glm::normalize(focus.at.p);
        for (const Differential& one : bundle) EXPECT_LE(glm::length(one.x - glm::dot(one.x, d) * d), 1e-6) << y;
        settings.u_end += 1;
        bundle = pixels;
        const BentHit behind = trace(air.now, nullptr, {-3, y, 0}, {1, 0, 0}, settings, &bundle);
        // Heights y' spread from the focus at sines y': over 1 m, area |d(sin)| / cosθ … exactly 1/cosθ of each height.
        const double cosine = std::sqrt(1 - y * y);
        EXPECT_NEAR(magnification(pixels, {1, 0, 0}, behind.at, bundle, behind.length), cosine, 1e-5) << y;
    }
}

Bundle pixels_of(dvec3 right, dvec3 up) {
    return {Differential{{0, 0, 0}, right}, Differential{{0, 0, 0}, up}};
}

TEST(Differentials, MagnifyAndFold) {
    // On the axis of a sech medium neighbours go as cos u: at 1/4 and 3/4 of the half period, with two folds between.
    ProfileSpec sech = profile(ProfileKind::Sech);
    sech.axis = {1, 0, 0};
    const TestAir air({sech});
    Bundle parallel;
    parallel[0].x = {0, 0, 1};
    parallel[1].x = {0, 1, 0};
    for (const double part : {0.25, 0.75}) {
        TraceSettings settings = finest();
        settings.u_end = part * pi;
        Bundle bundle = parallel;
        const BentHit end = trace(air.now, nullptr, {0, 0, 0}, {1, 0, 0}, settings, &bundle);
        EXPECT_NEAR(magnification(parallel, {1, 0, 0}, end.at, bundle, end.length), 2, 2 * kBundleError);
    }
    // Without any bend the magnification is 1.
    const TestAir none({});
    const Bundle fan = pixels_of({0, 0, 1}, {0, 1, 0});
    Bundle bundle = fan;
    const BentHit end = trace(none.now, nullptr, {0, 0, 0}, {1, 0, 0}, usual(), &bundle);
    EXPECT_NEAR(magnification(fan, {1, 0, 0}, end.at, bundle, end.length), 1, 1e-14);
    // The picture of a mirage is upside down, and that of a ray above it is not. Neighbouring rays give the
    // magnification.
    const TestAir hot({road(0.01)}, at_zero());
    const auto wall = geometry({plane({600, 0, 0}, {-1, 0, 0})});
    const double critical = std::sqrt(-2 * index_law(at_zero()).above_ambient(305));
    for (const double angle : {0.6 * critical, 0.05 * critical}) {
        const auto direction = [](double a) { return dvec3(std::cos(a), -std::sin(a), 0); };
        const auto height = [&](double a) {
            return trace(hot.now, wall.get(), {0, 1.5, 0}, direction(a), finest()).at.x.y;
        };
        const Bundle pixels = pixels_of({0, 0, 1}, {std::sin(angle), std::cos(angle), 0});
        Bundle arrived = pixels;
        const BentHit hit = trace(hot.now, wall.get(), {0, 1.5, 0}, direction(angle), finest(), &arrived);
        const double slope = (height(angle - 1e-6) - height(angle + 1e-6)) / 2e-6 / 600;
        const double found = magnification(pixels, direction(angle), hit.at, arrived, hit.length);
        EXPECT_NEAR(found * slope, 1, 1e-3);
        EXPECT_EQ(found<0, angle> 0.1 * critical);
    }
}

}  // namespace
}  // namespace eikonal::reference
