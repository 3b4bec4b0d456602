/// Pictures through bent air, compared with closed forms: displacements, mirages, lenses, mirrors and glass; the marks
/// of rays that have no end; and the same bytes for any number of threads. Length: each effect needs a scene of its
/// own, whose picture is known in closed form.
#include "reference/trace/render.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <numeric>

#include "noise/blobs/blobs_spec.h"
#include "noise/profile/profile_spec.h"
#include "noise/surface/surface_spec.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "reference/trace/ray_tree.h"
#include "tests/reference/trace/render_scenes.h"

namespace eikonal::reference {
namespace {

// n = 1 + 1e-6 y over 500 m: the ray falls or rises by 0.125 m, seen 250 µrad off its place (PHYSICS.md#closed-forms).
TEST(Render, WeakGradientShiftsBy250Microradians) {
    Scene scene = scene_with({quad({0, 1.5, -500}, {0, 0, 1}, 1000)}, 2);
    ProfileSpec linear;
    linear.profile = ProfileKind::Linear;
    linear.slope = 1e-6;
    scene.media = {linear};
    const RenderedFrame frame = Renderer(scene, settings()).render(1);
    const double f = camera_of(scene).f_px;
    // Rays bend up towards the denser air: every pixel sees what lies higher, v < 0 since y is down.
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            EXPECT_NEAR(frame.v[at(x, y)], -250e-6 * f, 1e-3 * 250e-6 * f);
            EXPECT_NEAR(frame.u[at(x, y)], 0, 1e-4 * 250e-6 * f);
        }
}

// The length of a ray includes its straight stretches before, between and behind blobs. It is slightly longer than the
// straight ray.
TEST(Render, LengthIsThatOfTheWholeRay) {
    Scene scene = scene_with({quad({0, 1.5, -4}, {0, 0, 1}, 10)}, 30);
    BlobsSpec cloud;
    cloud.blobs = {{{0, 1.5, -1}, 0.1, 400}, {{0.2, 1.6, -2}, 0.1, 400}, {{-0.2, 1.6, -3}, 0.03, 400}};
    scene.media = {cloud};
    const Camera camera = camera_of(scene);
    for (const Integrator integrator : {Integrator::Adaptive, Integrator::Rk4, Integrator::Leapfrog, Integrator::Euler,
                                        Integrator::FirstOrder, Integrator::SecondOrder}) {
        RenderSettings s = settings();
        s.rays.integrator = integrator;
        s.colour = false;
        const RenderedFrame frame = Renderer(scene, s).render(1);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const double u = frame.u[at(x, y)], v = frame.v[at(x, y)];
                const double straight = 4 * glm::length(camera_ray(camera, x + 0.5 + u, y + 0.5 + v).direction);
                ASSERT_EQ(frame.depth[at(x, y)], 4);
                ASSERT_NEAR(frame.length[at(x, y)], straight, 1e-6) << name_of(integrator) << " at " << x << ", " << y;
            }
    }
}

TEST(Render, AirOfNoStrengthIsStraight) {
    Scene scene = mirage();
    TurbulenceSpec still;
    still.cn2 = 0;
    SurfaceSpec ambient;
    ambient.surface_temperature = 293.15;
    scene.media = {ambient, BlobsSpec{}, still};
    const RenderedFrame plain = Renderer(scene, straight(4)).render(1);
    const RenderedFrame bent = Renderer(scene, settings(4)).render(1);
    EXPECT_TRUE(same(plain.color, bent.color));
    for (std::size_t i = 0; i < bent.u.size(); ++i) {
        EXPECT_EQ(bent.u[i], 0);
        EXPECT_EQ(bent.v[i], 0);
        EXPECT_NEAR(bent.depth[i], plain.depth[i], 1e-6 * plain.depth[i]);
    }
}

TEST(Render, MirageShowsTheWallBelowTheHorizon) {
    const Scene scene = mirage();
    const RenderedFrame plain = Renderer(scene, straight()).render(1);
    RenderSettings with = settings();
    with.magnification = true;
    const RenderedFrame bent = Renderer(scene, with).render(1);
    int mirrored = 0;
    for (int y = 0; y < kHeight; ++y) {
        const std::size_t i = at(kWidth / 2, y);
        if (bent.magnification[i] < 0) {
            ++mirrored;
            // Straight rays would see the road. Bent rays see a higher place of the wall, at the wall's depth.
            EXPECT_EQ(bent.id[i], 1) << y;
            EXPECT_NEAR(bent.depth[i], 400, 1e-3);
            EXPECT_GT(bent.length[i], 400);
            EXPECT_LT(bent.v[i], 0);
        }
        EXPECT_GT(bent.error[i], -1e-30);
        EXPECT_LT(bent.error[i], 0.011);
    }
    EXPECT_GT(mirrored, 1);
    EXPECT_EQ(bent.folded() % kWidth, 0u) << "whole rows are folded";
    EXPECT_GT(bent.folded(), 0u);
    EXPECT_EQ(bent.trapped() + bent.without_index(), 0u);
    // Rays high above the road are not mirrored.
    EXPECT_GT(bent.magnification[at(kWidth / 2, 0)], 0);
}

// The shortcuts for a scene of one surface change nothing beyond the tolerance.
TEST(Render, LoneSurfaceGivesWhatTheFieldGives) {
    const Scene scene = mirage();
    for (const Integrator integrator : {Integrator::Adaptive, Integrator::FirstOrder}) {
        const SceneAir air(scene, {.integrator = integrator});
        const Camera camera = camera_of(scene);
        const AirInstant field = air.at(1);
        const Geometry geometry(scene, camera.position);
        const TraceSettings quick = air.trace_settings(camera);
        ASSERT_TRUE(quick.lone);
        TraceSettings plain = quick;
        plain.lone = nullptr;
        plain.tolerance_px *= 1e-3;
        if (integrator == Integrator::FirstOrder) plain.step = 0.05;  // its quadrature has no tolerance
        for (int y = 0; y < kHeight; y += 3) {
            const CameraRay ray = camera_ray(camera, 7.5, y + 0.5);
            const dvec3 d = glm::normalize(ray.direction);
            const BentHit a = trace(field, &geometry, ray.origin, d, quick);
            const BentHit b = trace(field, &geometry, ray.origin, d, plain);
            ASSERT_EQ(a.hit, b.hit) << y;
            if (!a.hit || a.surface.object != b.surface.object) continue;
            const dvec3 off = glm::normalize(a.at.x - ray.origin) - glm::normalize(b.at.x - ray.origin);
            EXPECT_LT(glm::length(off), quick.tolerance_px * quick.pixel) << y;
        }
    }
}

TEST(Render, RaysWithoutAnEndAreMarkedAndBlack) {
    for (const double exaggeration : {3e3, 1e5, 1e9, -1e5}) {
        Scene scene = scene_with({quad({0, 1.5, -20}, {0, 0, 1}, 100, {1, 1, 1})});
        BlobsSpec blobs;
        for (int i = 0; i < 20; ++i) blobs.blobs.push_back({{0.3 * (i % 5) - 0.6, 1 + 0.3 * (i / 5), -6}, 0.15, 2000});
        scene.media = {blobs};
        scene.optics.exaggeration = exaggeration;
        RenderSettings s = settings();
        s.rays.step_budget = 200;
        s.magnification = true;
        const RenderedFrame frame = Renderer(scene, s).render(1);
        expect_finite(frame);
        for (const float m : frame.magnification) ASSERT_TRUE(std::isfinite(m));
        std::size_t marked = 0;
        for (std::size_t i = 0; i < frame.id.size(); ++i) {
            if (frame.id[i] >= 0) continue;
            ++marked;
            EXPECT_TRUE(frame.id[i] == -1 || frame.id[i] == -2 || frame.id[i] == -3);
            EXPECT_TRUE(std::isinf(frame.depth[i]));
        }
        EXPECT_EQ(marked, frame.trapped() + frame.without_index());
        s.rays.step_budget = 10;
        EXPECT_GT(Renderer(scene, s).render(1).unfinished(), 0u) << exaggeration;
    }
    // A probe takes no more steps than it may, and it estimates the steps that are left.
    {
        Scene scene = scene_with({quad({0, 1.5, -20}, {0, 0, 1}, 100, {1, 1, 1})});
        ProfileSpec rod;
        rod.profile = ProfileKind::Rod;
        rod.g = 1e6;
        scene.media = {rod};
        const Probe probe = Renderer(scene, settings()).probe(1, {.first = 8, .most = 32, .seconds = 1e9, .steps = 50});
        EXPECT_EQ(probe.pixels.width, 32);
        EXPECT_EQ(probe.step_limit, 50);
        EXPECT_EQ(probe.pixels.unfinished(), 32u);
        EXPECT_EQ(probe.beyond, 32u);
        for (const float steps : probe.pixels.steps) EXPECT_LE(steps, 50);
        EXPECT_EQ(probe.steps_to_come, 32.0 * (kStepBudget - 50));
        EXPECT_NEAR(probe.time(64, 0) / (2 * probe.seconds / (1 + probe.samples)), kStepBudget / 50.0, 1e-6);
    }
    // The camera itself is at n <= 0, so all pixels are marked.
    Scene scene = scene_with({quad({0, 1.5, -20}, {0, 0, 1}, 100, {1, 1, 1})});
    ProfileSpec rod;
    rod.profile = ProfileKind::Linear;
    rod.n0 = 1;
    rod.slope = -1;
    scene.media = {rod};
    const RenderedFrame frame = Renderer(scene, settings()).render(1);
    EXPECT_EQ(frame.without_index(), frame.id.size());
    for (std::size_t i = 0; i < frame.color.size(); ++i) EXPECT_EQ(frame.color[i], i % 4 == 3 ? 1.0f : 0.0f);
}

// The number of steps that a probed ray still needs is estimated from the air ahead. Here that is a layer of some
// height.
TEST(Render, AProbeKnowsTheStepsToCome) {
    Scene scene = scene_with({quad({0, 0, -300}, {0, 0, 1}, 10)}, 20);
    TurbulenceSpec air;
    air.form = TurbulenceForm::Lattice;
    air.cn2 = 1e-13;
    air.outer_scale = 0.5;
    air.inner_scale = 0.02;
    air.lattice = {16, 16, 16, 2};
    air.period = {1, 1, 1, 1};
    air.falloff = Falloff{.length = 0.1};
    scene.media = {air};
    scene.camera.look_at = {0, 1.7, -1};
    RenderSettings s = settings(0);
    s.colour = false;
    const Renderer renderer(scene, s);
    const Probe probe = renderer.probe(1, {.first = 256, .most = 256, .steps = 40});
    const RenderedFrame frame = renderer.render(1);
    const auto mean = [](const std::vector<float>& steps) {
        return std::accumulate(steps.begin(), steps.end(), 0.0) / static_cast<double>(steps.size());
    };
    const double tried = mean(probe.pixels.steps), expected = tried + probe.steps_to_come / 256;
    EXPECT_GT(mean(frame.steps), 3 * tried);
    EXPECT_NEAR(expected / mean(frame.steps), 1, 0.2);
    EXPECT_EQ(probe.beyond, 0u);
}

// Parallel rays meet on the sphere, opposite to where they enter.
TEST(Render, LuneburgLensFocusesParallelRays) {
    Scene scene = scene_with({sphere({0, 1.5, -6}, 0.05, {1, 0, 0}), quad({0, 1.5, -20}, {0, 0, 1}, 100)});
    ProfileSpec lens;
    lens.profile = ProfileKind::Luneburg;
    lens.center = {0, 1.5, -5};
    scene.media = {lens};
    scene.camera.projection = Projection::Orthographic;
    scene.camera.width = 3;
    const RenderedFrame frame = Renderer(scene, settings()).render(1);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const double r = std::hypot(x + 0.5 - kWidth / 2, y + 0.5 - kHeight / 2) * 3 / kWidth;
            if (r < 0.95) {
                EXPECT_EQ(frame.id[at(x, y)], 1) << x << ' ' << y;
            } else if (r > 1) {
                EXPECT_EQ(frame.id[at(x, y)], 2);
                EXPECT_EQ(frame.u[at(x, y)], 0);
            }
        }
}

TEST(Render, OrthographicShiftIsInMetresOfThePicture) {
    Scene scene = scene_with({quad({0, 1.5, -500}, {0, 0, 1}, 1000)});
    scene.camera.projection = Projection::Orthographic;
    scene.camera.width = 4.8;
    ProfileSpec linear;
    linear.profile = ProfileKind::Linear;
    linear.slope = 1e-6;
    scene.media = {linear};
    const RenderedFrame frame = Renderer(scene, settings()).render(1);
    for (const float v : frame.v) EXPECT_NEAR(v, -0.125 * kWidth / 4.8, 1e-3);
}

TEST(Render, AMirrorShowsWhatItReflects) {
    // A mirror across the view at 45 degrees; to its right, a red wall. Behind it, blue.
    ObjectSpec mirror = quad({0, 1.5, -5}, glm::normalize(dvec3(1, 0, 1)), 20);
    mirror.mirror = 1;
    const Scene scene = scene_with(
        {mirror, quad({30, 1.5, -5}, {-1, 0, 0}, 100, {1, 0, 0}), quad({0, 1.5, -40}, {0, 0, 1}, 9, {0, 0, 1})});
    for (const auto& s : {settings(), straight()}) {
        const RenderedFrame frame = Renderer(scene, s).render(1);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) EXPECT_EQ(colour(frame, x, y), dvec3(1, 0, 0));
    }
    Scene half = scene;
    half.objects[0].mirror = 0.25;
    half.objects[0].color = {0, 1, 0};
    const dvec3 c = colour(Renderer(half, settings()).render(1), kWidth / 2, kHeight / 2);
    EXPECT_NEAR(c.r, 0.25, 1e-6);
    EXPECT_NEAR(c.g, 0.75, 1e-6);
}

TEST(Render, FresnelAtNormalIncidenceAndGrazing) {
    EXPECT_NEAR(fresnel_reflectance(1, 1, 1.5, 1), 0.04, 1e-15);
    EXPECT_NEAR(fresnel_reflectance(1.5, 1, 1, 1), 0.04, 1e-15);
    EXPECT_NEAR(fresnel_reflectance(1, 1e-9, 1.5, std::sqrt(1 - 1 / 2.25)), 1, 1e-7);
    // A black pane behind glass, seen along its normal, shows only the reflection of the white wall behind the camera.
    Scene scene =
        scene_with({glass(quad({0, 1.5, -5}, {0, 0, 1}, 4), 1.5), quad({0, 1.5, 3}, {0, 0, -1}, 100, dvec3(1))}, 0.5);
    const dvec3 c = colour(Renderer(scene, straight()).render(1), kWidth / 2, kHeight / 2);
    EXPECT_NEAR(c.r, 0.04, 1e-4);
}

// A ray through a sphere of glass at height b above its axis is turned by 2 (α - β), sin α = b/r = n sin β.
TEST(Render, AGlassSphereRefractsBySnell) {
    const double n = 1.5, r = 1, distance = 10;
    Scene scene = scene_with({glass(sphere({0, 1.5, -5}, r), n)});
    // A screen behind it whose colour tells the height: two halves with their edge at `edge`.
    const auto seen = [&](double edge, int y) {
        Scene s = scene;
        ObjectSpec low = quad({0, 1.5 + edge - 50, -5 - distance}, {0, 0, 1}, 100, {0, 1, 0});
        ObjectSpec high = quad({0, 1.5 + edge + 50, -5 - distance}, {0, 0, 1}, 100, {0, 0, 1});
        s.objects.push_back(low);
        s.objects.push_back(high);
        s.camera.projection = Projection::Orthographic;
        s.camera.width = 3;
        const Renderer renderer(s, straight(256));
        const dvec3 c = colour(renderer.render(1), kWidth / 2, y);
        return c.b > c.g;
    };
    for (const int y : {14, 10, 7}) {
        const double b = (kHeight / 2 - y - 0.5) * 3 / kWidth, x0 = 0.5 * 3 / kWidth;
        const double h = std::hypot(b, x0);  // from the axis: the ray stays in the plane through it
        const double alpha = std::asin(h / r), beta = std::asin(h / (n * r)), turn = 2 * (alpha - beta);
        // It leaves at the angle α - turn about the centre, and meets the screen lower by tan.
        const double leave = 2 * beta - alpha;
        const double exit = r * std::sin(leave) * -1, back = r * std::cos(leave);
        const double height = (-exit - (distance - back) * std::tan(turn)) * b / h;
        EXPECT_TRUE(seen(height - 0.25, y)) << y << ' ' << height;
        EXPECT_FALSE(seen(height + 0.25, y)) << y << ' ' << height;
    }
}

// Air in which rays fold magnifies their errors. The rays' own estimates do not show it, but rays that are traced again
// do.
TEST(Render, TellsWhereTheAirSpreadsErrors) {
    for (const bool strong : {false, true}) {
        TurbulenceSpec air;
        air.form = TurbulenceForm::Lattice;
        air.cn2 = strong ? 0.02 : 1e-6;
        air.outer_scale = 1;
        air.inner_scale = 0.4;
        air.lattice = {16, 16, 16, 1};
        air.period = {4, 4, 4, 1};
        Scene scene = scene_with({quad({0, 1.5, -12}, {0, 0, 1}, 100, {1, 1, 1})});
        scene.media = {air};
        std::optional<Probe> told;
        FrameWatch watch;
        watch.probed = [&](const Probe& probe) { told = probe; };
        Renderer(scene, settings()).render(1, watch);
        ASSERT_TRUE(told);
        EXPECT_GT(told->again, 32U);
        if (strong)
            EXPECT_GT(told->off, 0U);
        else
            EXPECT_EQ(told->off, 0U);
        EXPECT_EQ(told->farthest_off > kPessimism * settings().rays.tolerance_px, strong);
    }
}

TEST(Render, SameBytesForAnyNumberOfThreads) {
    Scene scene = mirage();
    scene.media.emplace_back(TurbulenceSpec{});
    scene.light = LightSpec{};
    scene.objects[0].emissive = false;
    RenderSettings s = settings(4);
    s.light_rays = 64;
    s.magnification = true;
    const auto render = [&](int threads) {
        const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                                static_cast<std::size_t>(threads));
        return Renderer(scene, s).render(3);
    };
    EXPECT_TRUE(same(render(1), render(2)));
}

TEST(Render, TheAirMovesOnAndTheCameraToo) {
    Scene scene = scene_with({quad({0, 1.5, -50}, {0, 0, 1}, 100)});
    BlobsSpec blobs;
    BlobSourceSpec source;
    source.from = {-1, 0, -10};
    source.to = {1, 0, -10};
    blobs.sources = {source};
    blobs.wind = WindSpec{};
    scene.media = {blobs};
    const Renderer renderer(scene, settings());
    const RenderedFrame first = renderer.render(100);
    EXPECT_FALSE(same(first.v, renderer.render(112).v));
    EXPECT_TRUE(same(first, renderer.render(100)));
}

// u and v lead to the pixel where straight rays of the same frame's camera see the same point.
TEST(Render, AMovingCameraMeasuresAgainstItsOwnStraightRays) {
    ObjectSpec wall = quad({0, 0, -9}, {0.3, 0.2, 1}, 200);  // oblique: depth tells the place
    Scene scene = scene_with({wall});
    const auto path = std::filesystem::path(testing::TempDir()) / fmt::format("eikonal_render_{}.chan", ::getpid());
    std::ofstream(path) << "1 0 1.5 0 0 0 0\n9 2 1 1 10 -15 20\n";
    scene.camera.path = path;
    BlobsSpec blobs;
    for (int i = 0; i < 60; ++i) blobs.blobs.push_back({{0.5 * (i % 10) - 1.5, 0.5 * (i / 10) + 0.5, -4}, 0.3, 1500});
    scene.media = {blobs};
    scene.optics.exaggeration = 50;
    const Renderer renderer(scene, settings());
    const Geometry geometry(scene, {0, 1.5, 0});
    std::filesystem::remove(path);
    for (const int frame : {1, 4, 9}) {
        const RenderedFrame bent = renderer.render(frame);
        double furthest = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const std::size_t i = at(x, y);
                const double u = bent.u[i], v = bent.v[i];
                furthest = std::max(furthest, std::hypot(u, v));
                const CameraRay ray = camera_ray(renderer.camera(frame), x + 0.5 + u, y + 0.5 + v);
                const auto seen = geometry.intersect(ray.origin, ray.direction, 0, 1e3);
                ASSERT_TRUE(seen);
                EXPECT_NEAR(bent.depth[i] / seen->t, 1, 3e-7) << frame;
            }
        EXPECT_GT(furthest, 0.5) << frame;
    }
}

}  // namespace
}  // namespace eikonal::reference
