// Displacement under a moving camera. It is consistent from frame to frame (the paper's Fig. 7), or it is refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "noise/base/error.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "tests/warp/displace/displacement_scenes.h"
#include "warp/displace/displacer.h"

namespace eikonal {
namespace {

class MovingCamera : public ::testing::Test {
  protected:
    std::filesystem::path file_ = std::filesystem::path(::testing::TempDir()) / "eikonal_displacement_test.chan";
    void TearDown() override { std::filesystem::remove(file_); }

    /// One key a line: frame tx ty tz rx ry rz.
    Scene moving(Scene scene, const std::string& keys) {
        std::ofstream(file_) << keys;
        scene.camera.path = file_;
        return scene;
    }
};

TEST_F(MovingCamera, ASidewaysMoveShiftsAScreenByItsParallax) {
    Scene scene = long_view();
    auto& spec = (*scene.media[0].get_if<TurbulenceSpec>());
    spec.outer_scale = 50;
    spec.lattice = {{256, 256, 1, 1}};  // a single screen at 40 m of 80
    const DisplacerSettings settings = sized(128, 96, 80);
    const double pixel = 40 / Displacer(scene, settings).camera(1).f_px;
    const Displacer displacer(
        moving(scene, fmt::format("1 0 0 0 0 0 0\n2 {0:.17g} {1:.17g} 0 0 0 0\n", 16 * pixel, 8 * pixel)), settings);
    const Map a = map_of(displacer, 1, {0, 0, 64, 48}, 80), b = map_of(displacer, 2, {-16, 8, 64, 48}, 80);
    // Each ray has a slant factor of its own, which differs by a few parts in 10^5 here.
    EXPECT_LT(difference(a, b), 2e-3 * rms(a));
}

TEST_F(MovingCamera, APanShiftsThePattern) {
    const DisplacerSettings settings = sized(128, 96, 300);
    const double f = Displacer(long_view(), settings).camera(1).f_px;
    const double degrees = std::atan(20 / f) * 180 / M_PI;
    const Displacer displacer(moving(long_view(), fmt::format("1 0 0 0 0 0 0\n2 0 0 0 0 {:.17g} 0\n", -degrees)),
                              settings);
    const Map a = map_of(displacer, 1, {52, 30, 40, 36}, 300), b = map_of(displacer, 2, {32, 30, 40, 36}, 300);
    EXPECT_LT(difference(a, b), 0.03 * rms(a)) << "off by the projection's own curvature only";
    EXPECT_GT(difference(a, map_of(displacer, 2, {52, 30, 40, 36}, 300)), 0.5 * rms(a));
}

TEST_F(MovingCamera, ADollyThroughScreensNeverPops) {
    const Displacer displacer(moving(long_view(), "1 0 0 0 0 0 0\n801 0 0 -40 0 0 0\n"), sized(64, 48, 300));
    Map before = map_of(displacer, 1, {0, 0, 64, 48}, 200);
    double largest = 0, typical = 0;
    int frames = 0;
    for (double frame = 1.25; frame < 120; frame += 0.25, ++frames) {
        const Map after = map_of(displacer, frame, {0, 0, 64, 48}, 200);
        largest = std::max(largest, difference(before, after));
        typical += difference(before, after);
        before = after;
    }
    EXPECT_LT(largest, 8 * typical / frames);
    EXPECT_LT(largest, 0.2 * rms(before));
}

TEST_F(MovingCamera, TurningAwayIsRefusedWithARemedy) {
    const Displacer displacer(moving(long_view(), "1 0 0 0 0 0 0\n2 0 0 0 0 90 0\n"), sized(64, 48, 300));
    EXPECT_THROW(displacer.at(2, 300, 300), FrameError);
}

}  // namespace
}  // namespace eikonal
