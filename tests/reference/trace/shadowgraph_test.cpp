/// Sunlight through hot and cold air, on a wall: uniform without air, and bright and dark where a blob bends it.
#include "reference/trace/shadowgraph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "noise/blobs/blobs_spec.h"
#include "reference/trace/render.h"
#include "tests/reference/trace/render_scenes.h"

namespace eikonal::reference {
namespace {

/// A wall of 2 m at z = -5, lit along -z by a sun that comes from behind the camera.
Scene shadow_scene() {
    Scene scene = scene_with({quad({0, 1.5, -5}, {0, 0, 1}, 2, dvec3(1))}, 20);
    scene.light = LightSpec{.direction = {0, 0, -1}, .color = dvec3(1), .ambient = dvec3(0)};
    return scene;
}

Hit on_wall(double u, double v) {
    Hit hit;
    hit.object = 0;
    hit.uv = {u, v};
    return hit;
}

/// The map of a scene's first quad.
struct Lit {
    SceneAir air;
    AirInstant field;
    Geometry geometry;
    Shadowgraph map;
    explicit Lit(const Scene& scene, int rays)
        : air(scene, {}),
          field(air.at(1)),
          geometry(scene, scene.camera.position),
          map(scene, geometry, air, field, air.trace_settings(camera_of(scene)), rays) {}

    double mean(int n = 64) const {
        double sum = 0;
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) sum += *map.irradiance(on_wall((i + 0.5) / n, (j + 0.5) / n));
        return sum / n / n;
    }
};

TEST(Shadowgraph, StraightLightIsUniform) {
    const Lit lit(shadow_scene(), 512);
    for (double v = 0.02; v < 1; v += 0.04)
        for (double u = 0.02; u < 1; u += 0.04) EXPECT_NEAR(*lit.map.irradiance(on_wall(u, v)), 1, 0.01);
    EXPECT_NEAR(lit.mean(), 1, 0.005);
    EXPECT_FALSE(lit.map.irradiance([] {
        Hit other;
        other.object = 7;
        return other;
    }()));
}

// A hot blob is a weak diverging lens: n = 1 + n_j e^{-r²/σ²}, a whole pass bends by θ(b) = -2√π n_j (b/σ) e^{-b²/σ²}
// outwards, so at distance z the centre is lit by 1/(1 + z dθ/db)², dθ/db = 2√π |n_j|/σ.
TEST(Shadowgraph, AHotBlobCastsADarkCentreAndABrightRing) {
    for (const double z : {3.0, 12.0}) {  // between wall and camera, and behind it
        Scene scene = shadow_scene();
        const double sigma = 0.15;
        BlobsSpec blobs;
        blobs.blobs = {{{0, 1.5, -5 + z}, sigma, 600}};
        scene.media = {blobs};
        scene.optics.exaggeration = 300 / z;
        const Lit lit(scene, 1024);
        const IndexLaw law = index_law(scene.optics);
        const double n = 300 / z * std::abs(law.above_ambient(600));
        const double spread = z * 2 * std::sqrt(std::numbers::pi) * n / sigma;
        EXPECT_NEAR(*lit.map.irradiance(on_wall(0.5, 0.5)), 1 / ((1 + spread) * (1 + spread)), 0.03);
        double brightest = 0, where = 0;
        for (double r = 0; r < 0.4; r += 0.002)
            if (const double e = *lit.map.irradiance(on_wall(0.5 + r, 0.5)); e > brightest) brightest = e, where = r;
        EXPECT_GT(brightest, 1.1);
        EXPECT_GT(2 * where, sigma);  // the wall is 2 m wide
        EXPECT_LT(2 * where, 4 * sigma);
        EXPECT_NEAR(lit.mean(), 1, 0.01);
    }
}

// A cold one focuses: at z = 1/(2√π n_j/σ) the centre is a caustic, far brighter than at half the distance.
TEST(Shadowgraph, AColdBlobFocusesAtItsFocalLength) {
    const auto centre = [](double part) {
        Scene scene = shadow_scene();
        scene.optics.exaggeration = 100;
        const double sigma = 0.2, n = 100 * index_law(scene.optics).above_ambient(200);
        const double focal = sigma / (2 * std::sqrt(std::numbers::pi) * n);
        BlobsSpec blobs;
        blobs.blobs = {{{0, 1.5, -5 + part * focal}, sigma, 200}};
        scene.media = {blobs};
        const Lit lit(scene, 1024);
        EXPECT_NEAR(lit.mean(), 1, 0.01);
        return *lit.map.irradiance(on_wall(0.5, 0.5));
    };
    const double at_focus = centre(1), beyond = centre(2);
    EXPECT_NEAR(centre(0.5), 4, 1);  // 1/(1 - 1/2)²
    EXPECT_GT(at_focus, 3 * 4);
    // Beyond it a ring of the blob, b = σ √ln(z/f), still meets on the axis: a line of light, thinner than the focus.
    EXPECT_GT(beyond, 3 * 4);
    EXPECT_LT(beyond, at_focus);
}

TEST(Shadowgraph, IsWhatTheWallShows) {
    Scene scene = shadow_scene();
    BlobsSpec blobs;
    blobs.blobs = {{{0, 1.5, -3}, 0.15, 600}};
    scene.media = {blobs};
    scene.optics.exaggeration = 100;
    RenderSettings s = settings(4);
    s.light_rays = 512;
    const RenderedFrame lit = Renderer(scene, s).render(1);
    s.light_rays = 0;
    const RenderedFrame plain = Renderer(scene, s).render(1);
    EXPECT_NEAR(colour(plain, kWidth / 2, kHeight / 2).r, 1, 1e-3);
    EXPECT_LT(colour(lit, kWidth / 2, kHeight / 2).r, 0.6);
}

}  // namespace
}  // namespace eikonal::reference
