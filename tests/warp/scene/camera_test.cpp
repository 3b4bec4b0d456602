// Cameras: pixels to rays and back, axes, .chan files.
#include "warp/scene/camera.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <glm/geometric.hpp>
#include <string>

#include "noise/base/error.h"
#include "noise/math/portable_math.h"

namespace eikonal {
namespace {

constexpr double kExact = 1e-12;

void expect_near(dvec3 a, dvec3 b, double tolerance = kExact) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

void expect_orthonormal(const Camera& c) {
    EXPECT_NEAR(glm::length(c.right), 1, kExact);
    EXPECT_NEAR(glm::length(c.up), 1, kExact);
    EXPECT_NEAR(glm::dot(c.right, c.up), 0, kExact);
    expect_near(glm::cross(c.right, c.up), -c.forward);
}

std::string error_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const UserError& error) {
        return error.what();
    }
    return "no error";
}

std::string chan_error(const std::string& text) {
    return error_of([&] { parse_chan(text, "moves.chan"); });
}

/// A .chan file that lives as long as the test.
class ChanFile {
  public:
    explicit ChanFile(const std::string& text) {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        path_ = std::filesystem::temp_directory_path() /
                ("eikonal_" + std::string(info->name()) + "_" + std::to_string(::getpid()) + ".chan");
        std::ofstream(path_) << text;
    }
    ~ChanFile() { std::filesystem::remove(path_); }
    CameraSpec spec() const {
        CameraSpec s;
        s.path = path_;
        return s;
    }

  private:
    std::filesystem::path path_;
};

TEST(Camera, DefaultLooksAlongMinusZ) {
    const Camera c = CameraPath(CameraSpec{}, 1920, 1080).at(7);
    expect_near(c.position, {0, 1.5, 0});
    expect_near(c.right, {1, 0, 0});
    expect_near(c.up, {0, 1, 0});
    expect_near(c.forward, {0, 0, -1});
    EXPECT_NEAR(c.f_px, 960 / std::tan(kDefaultHorizontalFov * portable::kPi / 360), 1e-9);
}

TEST(Camera, SlopeAndPixelAreInverse) {
    const Camera c = CameraPath(CameraSpec{}, 1920, 1080, 2.0).at(1);
    for (const double x : {-100.0, 0.5, 960.0, 1919.5})
        for (const double y : {-3.0, 0.5, 540.0, 1079.5}) {
            const dvec2 p = c.pixel(c.slope(x, y));
            EXPECT_NEAR(p.x, x, 1e-9);
            EXPECT_NEAR(p.y, y, 1e-9);
        }
    EXPECT_EQ(c.slope(960, 540), dvec2(0, 0));
    EXPECT_GT(c.slope(1000, 540).x, 0);  // right of the centre
    EXPECT_GT(c.slope(960, 500).y, 0);   // above it
    // Pixels twice as wide as high: n of them side by side span twice the angle of n stacked ones.
    EXPECT_NEAR(c.slope(970, 540).x, 2 * c.slope(960, 530).y, kExact);
}

TEST(Camera, EdgeOfThePictureIsHalfTheFieldOfView) {
    CameraSpec spec;
    spec.horizontal_fov = 90;
    EXPECT_NEAR(CameraPath(spec, 1000, 500).at(1).slope(1000, 250).x, 1, kExact);
    EXPECT_NEAR(CameraPath(spec, 1000, 500, 1, 60).at(1).slope(1000, 250).x, std::tan(portable::kPi / 6), kExact);
}

TEST(Camera, FocalLengthAndSensor) {
    CameraSpec spec;
    spec.focal_length = 300;
    EXPECT_NEAR(CameraPath(spec, 1920, 1080).at(1).f_px, 1920 * 300.0 / 36, 1e-9);
    spec.sensor_width = 24;
    EXPECT_NEAR(CameraPath(spec, 1920, 1080).at(1).f_px, 1920 * 300.0 / 24, 1e-9);
    EXPECT_NEAR(CameraPath(spec, 1920, 1080, 1, 90).at(1).f_px, 960, 1e-9);
}

TEST(Camera, Orthographic) {
    CameraSpec spec;
    spec.projection = Projection::Orthographic;
    spec.width = 4;
    const Camera c = CameraPath(spec, 400, 200).at(1);
    EXPECT_EQ(c.f_px, 100);
    EXPECT_EQ(c.slope(400, 0), dvec2(2, 1));
    EXPECT_EQ(error_of([&] { CameraPath(spec, 400, 200, 1, 40); }),
              "`fov`: an orthographic camera has no field of view; set camera.width");
}

TEST(Camera, LookAtGivesAxes) {
    CameraSpec spec;
    spec.position = {1, 2, 3};
    spec.look_at = {5, 2, 3};  // along +x: right is +z
    Camera c = CameraPath(spec, 100, 100).at(1);
    expect_near(c.forward, {1, 0, 0});
    expect_near(c.right, {0, 0, 1});
    expect_near(c.up, {0, 1, 0});
    spec.look_at = {-4, 7, 0.5};
    spec.up = {0.3, 5, 0};
    c = CameraPath(spec, 100, 100).at(1);
    expect_orthonormal(c);
    EXPECT_GT(glm::dot(c.up, spec.up), 0);
}

TEST(Camera, RefusesDegenerateViews) {
    CameraSpec spec;
    spec.look_at = spec.position;
    EXPECT_THROW(CameraPath(spec, 10, 10), UserError);
    spec.look_at = spec.position + dvec3(0, -3, 0);
    EXPECT_THROW(CameraPath(spec, 10, 10), UserError);
    for (const double fov : {kSmallestFov, kLargestFov}) {
        const double f_px = CameraPath(CameraSpec{}, 10, 10, 1, fov).at(1).f_px;
        EXPECT_TRUE(f_px > 0 && std::isfinite(f_px)) << fov;
    }
    for (const double fov : {0.0, 1e-320, 179.999, 180.0, -5.0, std::nan("")})
        EXPECT_THROW(CameraPath(CameraSpec{}, 10, 10, 1, fov), UserError) << fov;
}

// Nuke's ZXY: a camera that pans looks to the left for positive y, tilts up for positive x, and rolls about its own
// view.
TEST(Chan, RotationOrderIsNukes) {
    const auto axes = [](const std::string& angles) {
        const auto keys = parse_chan("1 0 0 0 " + angles, "moves.chan");
        return glm::mat3_cast(keys[0].orientation);  // columns: right, up, backward
    };
    expect_near(-axes("0 0 0")[2], {0, 0, -1});
    expect_near(-axes("0 90 0")[2], {-1, 0, 0});  // pan left
    expect_near(-axes("90 0 0")[2], {0, 1, 0});   // tilt up
    expect_near(axes("0 0 90")[0], {0, 1, 0});    // roll: right turns up
    expect_near(-axes("0 0 90")[2], {0, 0, -1});
    // Pan after tilt: the horizon stays level, and the view climbs by the tilt whatever the pan.
    const auto panned = axes("30 90 0");
    expect_near(-panned[2], {-std::sqrt(0.75), 0.5, 0});
    expect_near(panned[0], {0, 0, -1});
    // Roll first: all three against the product of matrices R = Ry Rx Rz worked out by hand for 90° each.
    const auto all = axes("90 90 90");  // x -> Rz: y -> Rx: z -> Ry: x;  y -> -x -> -x -> z;  z -> z -> -y -> -y
    expect_near(all[0], {1, 0, 0});
    expect_near(all[1], {0, 0, 1});
    expect_near(all[2], {0, -1, 0});
}

TEST(Chan, CommentsBlankLinesTabsAndBothColumnCounts) {
    const auto seven = parse_chan("# frame t r\n\n1\t0 1 2\t0 0 0\r\n 2.5 +1e0 1 2 0 0 0 # end\n   \n", "a.chan");
    ASSERT_EQ(seven.size(), 2u);
    EXPECT_EQ(seven[1].frame, 2.5);
    EXPECT_EQ(seven[1].position, dvec3(1, 1, 2));
    EXPECT_EQ(seven[1].vertical_fov, 0);
    EXPECT_EQ(parse_chan("-4 0 0 0 0 0 0 35", "a.chan")[0].vertical_fov, 35);
}

TEST(Chan, ErrorsNameFileAndLine) {
    EXPECT_EQ(chan_error("1 0 0 0 0 0 0\n2 0 0 0 0 0\n"),
              "moves.chan:2: 6 columns; expected 7 or 8: frame tx ty tz rx ry rz [vertical_fov]");
    EXPECT_EQ(chan_error("1 0 0 0 0 0 0 40 1"),
              "moves.chan:1: more than 8 columns; expected: frame tx ty tz rx ry rz [vertical_fov]");
    EXPECT_EQ(chan_error("\n2 0 0 0 0 0 0\n2 0 0 0 0 0 0\n"),
              "moves.chan:3: frame 2 after frame 2; frames must increase");
    EXPECT_EQ(chan_error("1 0 0 0 0 0 0\n2 0 0 0 0 0 0 40\n"), "moves.chan:2: 8 columns, but 7 in the lines before");
    EXPECT_EQ(chan_error("1 0 0 0 0 0 0 180"),
              "moves.chan:1: vertical field of view 180, must be >= 1e-06 and <= 179.99 degrees");
    EXPECT_EQ(chan_error("1 0 x 0 0 0 0"), "moves.chan:1: column 3: 'x' is no number within ±1000000000000");
    for (const char* bad : {"nan", "inf", "1e13", "1e999", "+", "1,2", "0x10"})
        EXPECT_NE(chan_error("1 0 " + std::string(bad) + " 0 0 0 0").find("moves.chan:1: column 3"), std::string::npos)
            << bad;
    EXPECT_NE(chan_error("# nothing\n").find("no camera key"), std::string::npos);
    CameraSpec spec;
    spec.path = "no/such/moves.chan";
    EXPECT_EQ(error_of([&] { CameraPath(spec, 10, 10); }),
              "no/such/moves.chan: cannot read the camera path: No such file or directory");
}

TEST(CameraPath, KeysAreMetInterpolatedAndClamped) {
    const ChanFile file("10 0 0 0 0 0 0\n20 10 2 0 0 60 0\n");
    const CameraPath path(file.spec(), 1000, 500);
    EXPECT_TRUE(path.moving());
    expect_near(path.at(-5).position, {0, 0, 0});
    expect_near(path.at(10).forward, {0, 0, -1});
    expect_near(path.at(15).position, {5, 1, 0});
    expect_near(path.at(20).position, {10, 2, 0});
    expect_near(path.at(99).position, {10, 2, 0});
    expect_near(path.reference().position, {0, 0, 0});
    for (double f = 10; f <= 20; f += 0.125) {  // a pan at constant speed: 6 degrees a frame
        const double angle = (f - 10) * 6 * portable::kPi / 180;
        const Camera c = path.at(f);
        expect_near(c.forward, {-std::sin(angle), 0, -std::cos(angle)});
        expect_orthonormal(c);
    }
}

TEST(CameraPath, TurnsTheShortWay) {
    const ChanFile file("0 0 0 0 0 170 0\n10 0 0 0 0 -170 0\n20 0 0 0 0 350 0\n");
    const CameraPath path(file.spec(), 100, 100);
    expect_near(path.at(5).forward, {0, 0, 1});  // through 180, not through 0
    for (double f = 0; f <= 20; f += 0.5) expect_orthonormal(path.at(f));
}

TEST(CameraPath, FieldOfViewColumnAndOverride) {
    const ChanFile file("1 0 0 0 0 0 0 90\n3 0 0 0 0 0 0 53.13010235415598\n");  // tan of the halves: 1 and 1/2
    EXPECT_NEAR(CameraPath(file.spec(), 1000, 500).at(1).f_px, 250, 1e-9);
    EXPECT_NEAR(CameraPath(file.spec(), 1000, 500).at(2).f_px, 375, 1e-9);
    EXPECT_NEAR(CameraPath(file.spec(), 1000, 500).at(3).f_px, 500, 1e-9);
    EXPECT_NEAR(CameraPath(file.spec(), 1000, 500, 2).at(1).f_px, 125, 1e-9);  // vertical scale is f_px * aspect
    EXPECT_NEAR(CameraPath(file.spec(), 1000, 500, 1, 90).at(1).f_px, 500, 1e-9);

    const ChanFile without("1 0 0 0 0 0 0\n");
    CameraSpec spec = without.spec();
    spec.horizontal_fov = 90;
    EXPECT_NEAR(CameraPath(spec, 1000, 500).at(1).f_px, 500, 1e-9);
}

}  // namespace
}  // namespace eikonal
