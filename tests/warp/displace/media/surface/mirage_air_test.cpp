/// The effect of other media on the rays of mirages, compared with rays that are followed through the sum of all media.
#include "warp/displace/media/surface/mirage_air.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "noise/blobs/blobs_spec.h"
#include "noise/medium/medium_spec.h"
#include "noise/surface/surface_spec.h"
#include "tests/warp/displace/displacement_scenes.h"

namespace eikonal {
namespace {

constexpr int kWidth = 64, kHeight = 96;
constexpr PixelWindow kPicture{0, 0, kWidth, kHeight};

struct View {
    dvec3 up{0, 1, 0};
    dvec3 normal{0, 1, 0};
    double temperature = 325, dropoff = 0.02;
    Projection projection = Projection::Perspective;
};

/// 1.5 m from the plane, looking along it through a lens of 0.5 degrees, or parallel to it near by.
Scene scene_over(const View& view, const std::vector<MediumSpec>& others) {
    Scene scene;
    SurfaceSpec surface;
    surface.normal = view.normal;
    surface.surface_temperature = view.temperature;
    surface.dropoff = view.dropoff;
    scene.media.push_back(surface);
    scene.media.insert(scene.media.end(), others.begin(), others.end());
    scene.camera.position = 1.5 * view.normal;
    scene.camera.look_at = scene.camera.position + dvec3(0, 0, -1);
    scene.camera.up = view.up;
    scene.camera.projection = view.projection;
    scene.camera.horizontal_fov = 0.5;
    return scene;
}

/// Blobs between the camera and an object at 800 m, near the plane and up to the height of the camera, before and
/// behind where rays turn.
BlobsSpec blobs_over(const dvec3& normal, double temperature) {
    const dvec3 side = glm::cross(normal, dvec3(0, 0, -1));
    BlobsSpec blobs;
    const auto add = [&](double height, double aside, double ahead) {
        blobs.blobs.push_back({height * normal + aside * side + dvec3(0, 0, -ahead), 0.25, temperature});
    };
    add(0.6, 0.3, 150);
    add(0.9, -0.2, 160);
    add(0.8, 0.8, 500);
    add(1.2, -1.2, 600);
    add(0.4, 0.1, 620);
    return blobs;
}

struct Measured {
    Map uv;
    StatedError error;
};
Measured measured(const Scene& scene, double depth, std::optional<Model> model = {}) {
    DisplacerSettings settings = sized(kWidth, kHeight, depth);
    settings.model = model;
    const Displacer displacer(scene, settings);
    const Displacer::Instant instant = displacer.at(scene.time.first_frame, depth, depth);
    Measured m{Map(2 * kPicture.area()), {}};
    instant.map(kPicture, depth, DepthMeeting::Own, m.uv.data());
    m.error = instant.stated_error(kPicture, depth, DepthMeeting::Own, m.uv.data());
    return m;
}

TEST(MirageAir, AgreesWithRaysThroughAllMedia) {
    struct Case {
        std::string name;
        View view;
    };
    View wall, rolled, cold;
    wall.normal = {1, 0, 0};
    rolled.up = {0.5, 0.8, 0};
    cold.temperature = 275;
    cold.dropoff = 0.8;
    for (const Case& c : {Case{"road", {}}, Case{"wall", wall}, Case{"rolled camera", rolled}, Case{"cold", cold}}) {
        const Map alone = measured(scene_over(c.view, {}), 800).uv;
        for (const std::optional<Model> model : {std::optional<Model>{}, std::optional{Model::SecondOrder}}) {
            const auto [uv, error] = measured(scene_over(c.view, {blobs_over(c.view.normal, 380)}), 800, model);
            const double effect = difference(uv, alone);
            EXPECT_GT(effect, 0.1) << c.name;
            EXPECT_LT(error.p50, 0.01 * effect) << c.name;
            EXPECT_LT(error.p95, 0.05 * effect) << c.name;
        }
    }
}

// A hot blob spreads what lies behind it, also in the mirror. There the part above the blob appears below it, and what
// the plate shows is upside down, so that it moves the same way. The part to the left stays to the left.
TEST(MirageAir, TurnsRoundInTheMirror) {
    constexpr double kDistance = 600, kAside = 0.18;  // [m] where a blob bends most
    BlobsSpec blob;
    blob.blobs.push_back({{0, 1, -kDistance}, 0.25, 320});
    const Map alone = measured(scene_over({}, {}), 800).uv, both = measured(scene_over({}, {blob}), 800).uv;
    const double px = 0.5 * kWidth / std::tan(0.25 * 3.14159265358979 / 180) / kDistance;  // of a metre there
    const double row = 0.5 * kHeight + 0.5 * px, mirrored = 0.5 * kHeight + 2.5 * px;
    const auto shift = [&](double x, double y, std::size_t c) {
        const auto i = 2 * (static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)) + c;
        return double{both[i]} - alone[i];
    };
    const double up = shift(32, row - kAside * px, 1), left = shift(32 - kAside * px, row, 0);
    EXPECT_GT(std::abs(up), 0.03);
    EXPECT_LT(up * shift(32, row + kAside * px, 1), 0);
    EXPECT_NEAR(shift(32, mirrored + kAside * px, 1), up, 0.4 * std::abs(up));
    EXPECT_NEAR(shift(32, mirrored - kAside * px, 1), -up, 0.4 * std::abs(up));
    EXPECT_NEAR(shift(32 - kAside * px, mirrored, 0), left, 0.4 * std::abs(left));
}

TEST(MirageAir, DependsOnNoWindow) {
    const Scene scene = scene_over({}, {blobs_over({0, 1, 0}, 320)});
    const Displacer displacer(scene, sized(kWidth, kHeight, 800));
    const Displacer::Instant instant = displacer.at(scene.time.first_frame, 800, 800);
    Map whole(2 * kPicture.area());
    instant.map(kPicture, 800.0, DepthMeeting::Own, whole.data());
    const PixelWindow part{13, 41, 22, 50};
    Map cut(2 * part.area());
    instant.map(part, 800.0, DepthMeeting::Own, cut.data());
    for (int y = 0; y < part.height; ++y)
        for (int i = 0; i < 2 * part.width; ++i)
            ASSERT_EQ(cut[static_cast<std::size_t>(2 * y * part.width + i)],
                      whole[static_cast<std::size_t>(2 * ((y + part.y0) * kWidth + part.x0) + i)]);
}

}  // namespace
}  // namespace eikonal
