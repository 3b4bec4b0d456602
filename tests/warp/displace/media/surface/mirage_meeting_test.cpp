/// Mirages on a picture with a depth buffer: the objects that their rays meet, and what is shown in place of hidden
/// ones.
#include "warp/displace/media/surface/mirage_meeting.h"

#include <gtest/gtest.h>

#include <cmath>

#include "noise/surface/surface_spec.h"
#include "tests/warp/displace/media/surface/mirage_scenes.h"
#include "warp/displace/media/surface/mirage_row.h"

namespace eikonal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A plate: flat ground to the horizon, a post 300 m away beside the axis, hills at 4000 m.
constexpr double kHeight = 1.5, kFocal = 6000, kPost = 300, kHills = 4000;
constexpr PixelWindow kPlate{0, 0, 160, 360};
constexpr int kHorizon = 180;
bool is_post(int x, int y, double tall = 4) {
    const double height = kHeight - kPost * (y + 0.5 - kHorizon) / kFocal;
    return x >= 60 && x < 100 && height > 0 && height < tall;
}

DepthPlane plate_depth(double tall) {
    std::vector<float> metres;
    for (int y = 0; y < kPlate.height; ++y)
        for (int x = 0; x < kPlate.width; ++x) {
            const double v = y + 0.5 - kHorizon, ground = v > 0 ? kHeight * kFocal / v : kInfinity;
            metres.push_back(static_cast<float>(std::min({is_post(x, y, tall) ? kPost : kInfinity, ground, kHills})));
        }
    return {kPlate, std::move(metres)};
}

struct Plate {
    DepthPlane depth;
    std::vector<Mirage> mirages;
    explicit Plate(const SurfaceSpec& spec, double tall = 4)
        : depth(plate_depth(tall)),
          mirages{mirage_of(spec, level(kHeight, kFocal, kPlate.width, kPlate.height), kHills)} {}

    std::vector<float> map(const PixelWindow& tile, DepthMeeting how = DepthMeeting::March,
                           const std::vector<DisplacementGrid>& grids = {}) const {
        const int reach = static_cast<int>(mirages[0].largest_shift(kPlate)) + 4;
        const TileMeeting meeting(depth, tile, how, reach, mirage_meeting(depth, tile, how, reach, mirages));
        const MirageRows mirage_rows(mirages);
        std::vector<float> uv(2 * tile.area());
        GridRows rows;
        for (int y = 0; y < tile.height; ++y) {
            rows.start(grids, tile.y0 + y, mirage_rows.benders());
            meeting.row(rows, tile.y0 + y, uv.data() + 2 * static_cast<std::size_t>(y * tile.width));
        }
        return uv;
    }
    /// Row that the map of the whole plate reads for a pixel.
    static double source(const std::vector<float>& uv, int x, int y) {
        return y + static_cast<double>(uv[2 * static_cast<std::size_t>(y * kPlate.width + x) + 1]);
    }
};

TEST(MirageMeeting, PlateShowsWhatLiesBehindInverted) {
    const Plate plate(surface(320, 0.01));
    const double critical = std::sqrt(-2 * index_law({}).above_ambient(320)) * kFocal;
    for (const DepthMeeting how : {DepthMeeting::March, DepthMeeting::FixedPoint}) {
        const std::vector<float> uv = plate.map(kPlate, how);
        const int base = kHorizon + static_cast<int>(kHeight * kFocal / kPost);  // first row of ground under the post
        ASSERT_LT(base + 3, kHorizon + critical);
        double above = 1e9;
        for (int y = base + 1; y < kHorizon + critical - 0.6; ++y) {
            const double source = Plate::source(uv, 80, y);
            EXPECT_TRUE(is_post(80, static_cast<int>(std::floor(source + 0.5)))) << y << ' ' << source;
            EXPECT_LT(source, above) << "upside down";
            above = source;
            Mirage::PixelRay ray;
            ASSERT_TRUE(plate.mirages[0].ray(80, y, ray));
            EXPECT_NEAR(source, y + static_cast<double>(plate.mirages[0].shift(ray, kPost).y), 1e-3);
        }
        for (const int x : {10, 130}) {  // beside the post: the hills
            for (int y = kHorizon + 4; y < kHorizon + critical - 0.6; ++y)
                EXPECT_LT(Plate::source(uv, x, y), kHorizon + 2.5 * kHeight * kFocal / kHills) << y;
            for (int y = kHorizon + static_cast<int>(critical) + 2; y < kPlate.height; ++y)
                EXPECT_NEAR(Plate::source(uv, x, y), y, 8) << "steeper rays see the ground itself";
        }
        for (std::size_t i = 0; i < uv.size(); ++i) ASSERT_TRUE(std::isfinite(uv[i]));
        // the post above its own base stays as it is
        for (int y = 130; y < base - 1; ++y) EXPECT_NEAR(Plate::source(uv, 80, y), y, 0.3) << y;
    }
}

// The horizon of a plate is antialiased. Mirrored sky must not be read from its pixels.
TEST(MirageMeeting, TheMirrorShowsNoneOfTheHorizon) {
    constexpr float kSky = 1e6F;
    std::vector<float> metres;
    for (int y = 0; y < kPlate.height; ++y)
        for (int x = 0; x < kPlate.width; ++x) {
            const double v = y + 0.7 - kHorizon;  // it crosses a row
            metres.push_back(v > 0 ? static_cast<float>(kHeight * kFocal / v) : kSky);
        }
    Camera camera = level(kHeight, kFocal, kPlate.width, kPlate.height);
    camera.center.y -= 0.2;
    const std::vector<Mirage> mirages{mirage_of(surface(320, 0.01), camera, kSky)};
    const DepthPlane depth(kPlate, std::move(metres));
    constexpr DepthMeeting kMarch = DepthMeeting::March;
    const int reach = static_cast<int>(mirages[0].largest_shift(kPlate)) + 4;
    const TileMeeting meeting(depth, kPlate, kMarch, reach, mirage_meeting(depth, kPlate, kMarch, reach, mirages));
    const MirageRows mirage_rows(mirages);
    GridRows rows;
    std::vector<float> uv(2 * kPlate.area());
    const double critical = std::sqrt(-2 * index_law({}).above_ambient(320)) * kFocal;
    for (int y = 0; y < kPlate.height; ++y) {
        rows.start({}, y, mirage_rows.benders());
        meeting.row(rows, y, uv.data() + 2 * static_cast<std::size_t>(y * kPlate.width));
        if (y < kHorizon + 1 || y > kHorizon + critical - 2) continue;
        const double source = Plate::source(uv, 80, y);
        EXPECT_LE(std::floor(source) + 2, kHorizon - 1) << y << ' ' << source;
        EXPECT_NEAR(source, 2 * kHorizon - y, 5) << y;
    }
}

TEST(MirageMeeting, BehindAPostStandsTheGroundBesideIt) {
    constexpr double kTall = 1;
    const Plate plate(surface(270, 1), kTall);
    const std::vector<float> uv = plate.map(kPlate);
    int hidden = 0, rims = 0;
    for (int y = kHorizon - 100; y < kHorizon + 60; ++y)
        for (int x = 60; x < 100; ++x) {
            const std::size_t i = 2 * static_cast<std::size_t>(y * kPlate.width + x);
            const double sx = x + static_cast<double>(uv[i]), sy = y + static_cast<double>(uv[i + 1]);
            const auto nearest = [](double v) { return static_cast<int>(std::floor(v + 0.5)); };
            if (is_post(nearest(sx), nearest(sy), kTall)) continue;
            if (plate.depth.at(nearest(sx), nearest(sy)) < 1.06 * kPost) continue;  // at its foot
            // antialiased, these pixels would hold some of the post: only the edge of its own image may
            bool rim = false;
            for (const int j : {-1, 1})
                for (const int k : {-1, 1}) rim = rim || is_post(nearest(sx + j), nearest(sy + k), kTall);
            rims += rim ? 1 : 0;
            if (rim) continue;
            Mirage::PixelRay ray;
            if (!plate.mirages[0].ray(x, y, ray) || !(ray.end < kHills)) continue;
            const double end_y = y + static_cast<double>(plate.mirages[0].shift(ray, ray.end).y);
            if (!is_post(x, nearest(end_y), kTall)) continue;
            ++hidden;
            EXPECT_TRUE(sx < 60 || sx >= 100);
            EXPECT_NEAR(sy, end_y, 1e-3) << "ground as far away, " << x << ' ' << y;
        }
    EXPECT_GT(hidden, 100);
    EXPECT_LE(rims, 100 - 60) << "one row";
}

TEST(MirageMeeting, MapDependsOnNoWindow) {
    const Plate plate(surface(320, 0.05));
    const std::vector<float> whole = plate.map(kPlate);
    const PixelWindow part{37, 171, 70, 60};
    const std::vector<float> cut = plate.map(part);
    for (int y = 0; y < part.height; ++y)
        for (int x = 0; x < 2 * part.width; ++x)
            ASSERT_EQ(cut[static_cast<std::size_t>(y * 2 * part.width + x)],
                      whole[static_cast<std::size_t>((y + part.y0) * 2 * kPlate.width + 2 * part.x0 + x)]);
}

TEST(MirageMeeting, ShimmerActsOnTop) {
    const Plate plate(surface(320, 0.01));
    std::vector<DisplacementGrid> grids(1);
    grids[0].depths = {1, kHills};
    grids[0].cover(kPlate);
    for (Node& node : grids[0].nodes) node = Node{0, 0, 0.4f, -0.3f};
    for (int r = 0; r < grids[0].rows; ++r)
        for (int c = 0; c < grids[0].columns; ++c) {
            grids[0].row(r, 0)[c] = Node{0.4f, -0.3f, 0.4f, -0.3f};
            grids[0].row(r, 1)[c] =
                Node{static_cast<float>(0.4 * kHills), static_cast<float>(-0.3 * kHills), 0.4f, -0.3f};
        }
    const std::vector<float> still = plate.map(kPlate), both = plate.map(kPlate, DepthMeeting::March, grids);
    for (int y = kHorizon + 8; y < kHorizon + 36; ++y) {
        const std::size_t i = 2 * static_cast<std::size_t>(y * kPlate.width + 20);
        EXPECT_NEAR(both[i] - still[i], 0.4, 1e-3) << y;
        EXPECT_NEAR(both[i + 1] - still[i + 1], -0.3, 0.02) << y;
    }
}

TEST(MirageRows, ConstantDepthIsTheSameByRowAndByPixel) {
    const std::vector<Mirage> mirages{mirage_of(surface(320, 0.1), level(kHeight, kFocal))};
    const MirageRows mirage_rows(mirages);
    GridRows rows;
    for (const int y : {170, 190, 200, 215, 300}) {
        rows.start({}, y, mirage_rows.benders());
        std::vector<float> uv(40, 1.0f);
        rows.add_constant_depth(100, 20, 700, uv.data());
        for (int i = 0; i < 20; ++i) {
            const Shift d = rows.at(100 + i, 700);
            EXPECT_EQ(uv[2 * static_cast<std::size_t>(i)], 1 + d.x);
            EXPECT_EQ(uv[2 * static_cast<std::size_t>(i) + 1], 1 + d.y);
        }
    }
}

}  // namespace
}  // namespace eikonal
