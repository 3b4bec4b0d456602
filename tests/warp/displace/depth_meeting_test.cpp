// Bent rays and the depth buffer: silhouettes, slopes, and the three methods compared.
#include "warp/displace/depth/depth_meeting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace eikonal {
namespace {

using DepthOf = std::function<double(int x, int y)>;
using GridOf = std::function<std::array<double, 4>(int x, int y, double z)>;  ///< X and S of a node

constexpr PixelWindow kWindow{-6, -4, 60, 48};

DepthPlane plane_of(const DepthOf& depth) {
    std::vector<float> metres;
    for (int y = kWindow.y0; y < kWindow.y0 + kWindow.height; ++y)
        for (int x = kWindow.x0; x < kWindow.x0 + kWindow.width; ++x) metres.push_back(static_cast<float>(depth(x, y)));
    return {kWindow, std::move(metres)};
}

std::vector<DisplacementGrid> grids_of(const GridOf& bend, std::vector<double> depths) {
    std::vector<DisplacementGrid> grids(1);
    DisplacementGrid& grid = grids.front();
    grid.depths = std::move(depths);
    grid.interpolation = DepthInterpolation::Hermite;
    grid.cover(kWindow);
    for (int r = 0; r < grid.rows; ++r)
        for (std::size_t k = 0; k < grid.depths.size(); ++k)
            for (int c = 0; c < grid.columns; ++c) {
                const auto x = bend(grid.column0 + c, grid.row0 + r, grid.depths[k]);
                grid.row(r, k)[c] = Node{static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2]),
                                         static_cast<float>(x[3])};
            }
    return grids;
}

struct Map {
    std::vector<Shift> d;
    Shift at(int x, int y) const {
        return d[static_cast<std::size_t>((y - kWindow.y0) * kWindow.width + x - kWindow.x0)];
    }
};

Map meet(const std::vector<DisplacementGrid>& grids, const DepthPlane& depth, DepthMeeting how, int reach = 40) {
    Map map;
    const TileMeeting tile(depth, kWindow, how, reach);
    std::vector<float> uv(2 * static_cast<std::size_t>(kWindow.width));
    GridRows rows;
    for (int y = kWindow.y0; y < kWindow.y0 + kWindow.height; ++y) {
        rows.start(grids, y);
        tile.row(rows, y, uv.data());
        for (std::size_t i = 0; i < uv.size(); i += 2) map.d.push_back({uv[i], uv[i + 1]});
    }
    return map;
}

/// All rays bend alike at depth 2 m: X = (z - 2) a, d = (1 - 2/z) a.
GridOf sideways(double ax, double ay) {
    return [=](int, int, double z) { return std::array{(z - 2) * ax, (z - 2) * ay, ax, ay}; };
}

constexpr std::array kHow{DepthMeeting::March, DepthMeeting::FixedPoint, DepthMeeting::Own};

TEST(DepthMeeting, ConstantDepthIsTheSameForAll) {
    const auto grids = grids_of(sideways(3.3, -1.7), {2, 100});
    const DepthPlane depth = plane_of([](int, int) { return 37.0; });
    for (const DepthMeeting how : kHow)
        for (const Shift& d : meet(grids, depth, how).d) {
            EXPECT_NEAR(d.x, (1 - 2 / 37.0) * 3.3, 1e-5);
            EXPECT_NEAR(d.y, (1 - 2 / 37.0) * -1.7, 1e-5);
        }
}

/// A post 5 m away does not move, since its ray bends at 5 m. The wall behind it at 300 m moves by 4 px.
TEST(DepthMeeting, ForegroundStaysStillAndIsNeverDragged) {
    const auto post = [](int x) { return x >= 20 && x < 26; };
    const DepthPlane depth = plane_of([&](int x, int) { return post(x) ? 5.0 : 300.0; });
    for (const double a : {4.0, -4.0, 0.3, 12.5}) {
        const auto grids = grids_of(
            [a](int, int, double z) {
                return std::array{std::max(0.0, z - 5) * a, 0.0, z > 5 ? a : 0.0, 0.0};
            },
            {5, 5.001, 300});
        const double wall = a * (1 - 5 / 300.0);
        const Map march = meet(grids, depth, DepthMeeting::March), own = meet(grids, depth, DepthMeeting::Own);
        int dragged = 0;
        for (int y = kWindow.y0; y < kWindow.y0 + kWindow.height; ++y)
            for (int x = kWindow.x0; x < kWindow.x0 + kWindow.width; ++x) {
                const Shift d = march.at(x, y);
                if (post(x)) {
                    EXPECT_EQ(d.x, 0);
                    continue;
                }
                // neither sample of the source's bilinear footprint belongs to the post
                const double source = x + static_cast<double>(d.x);
                if (d.x != 0) {
                    EXPECT_FALSE(post(static_cast<int>(std::floor(source)))) << x << ' ' << a;
                    EXPECT_FALSE(post(static_cast<int>(std::ceil(source)))) << x << ' ' << a;
                }
                // Far from the post the wall moves freely. The pixels beside the post, its edge, stay with the post.
                if (std::abs(x - 23) > 3 + std::abs(a) + 2 || ((x - 23) * a > 0 && x != 19 && x != 26)) {
                    EXPECT_NEAR(d.x, wall, 1e-4) << x << ' ' << a;
                }
                dragged += post(static_cast<int>(std::floor(x + own.at(x, y).x + 0.5)));
            }
        if (std::abs(a) > 1) {
            EXPECT_GT(dragged, 0) << "the pixel's own depth drags the post";
        }
    }
}

/// A ray that swerves aside and back must stop at the post that it crosses, although the wall behind it is visible.
TEST(DepthMeeting, MarchFindsWhatStandsInTheWay) {
    const DepthPlane depth = plane_of([](int x, int) { return x >= 20 && x < 26 ? 20.0 : 300.0; });
    // d rises to 8 px at 30 m and falls to 0 at 300 m
    const auto d_of = [](double z) { return z < 30 ? 8 * (z - 2) / 28 : 8 * (300 - z) / 270; };
    std::vector<double> depths;
    for (double z = 2; z < 300; z *= 1.05) depths.push_back(z);
    depths.push_back(300);
    const auto grids = grids_of(
        [&](int, int, double z) {
            const double h = 1e-4 * z;
            return std::array{z * d_of(z), 0.0, ((z + h) * d_of(z + h) - (z - h) * d_of(z - h)) / (2 * h), 0.0};
        },
        depths);
    const Map map = meet(grids, depth, DepthMeeting::March);
    EXPECT_NEAR(16 + map.at(16, 10).x, 16 + d_of(20), 0.01) << "meets the post's face";
    EXPECT_GT(map.at(13, 10).x, 5) << "stopped by its edge";
    EXPECT_LE(13 + map.at(13, 10).x, 19);
    EXPECT_NEAR(map.at(5, 10).x, 0, 0.01) << "nothing in the way";
    EXPECT_NEAR(map.at(30, 10).x, 0, 0.01) << "nothing in the way";
}

/// Ground that recedes upwards. The result is the first z at which the facet under the ray is no farther than z, found
/// by brute force.
TEST(DepthMeeting, SlopedGroundIsTheFirstRoot) {
    const auto ground = [](int, int y) { return 1200.0 / (y + 12); };
    const DepthPlane depth = plane_of(ground);
    const auto clamped = [&](double y) {
        return ground(0,
                      std::clamp(static_cast<int>(std::floor(y + 0.5)), kWindow.y0, kWindow.y0 + kWindow.height - 1));
    };
    for (const double a : {2.6, -2.6, 0.4, -7.5}) {
        const auto grids = grids_of(sideways(0, a), {2, 200});
        const Map march = meet(grids, depth, DepthMeeting::March), fixed = meet(grids, depth, DepthMeeting::FixedPoint);
        for (int y = kWindow.y0; y < kWindow.y0 + kWindow.height; ++y) {
            double expected = 0;
            for (double z = depth.nearest();; z += 1e-4 * z) {
                expected = (1 - 2 / z) * a;
                if (clamped(y + expected) <= z) break;
            }
            EXPECT_NEAR(march.at(7, y).y, expected, kMarchError + 2e-4 * std::abs(a)) << a << ' ' << y;
            // The fixed point differs only where it jumps between facets and does not settle.
            EXPECT_NEAR(fixed.at(7, y).y, expected, 0.02 * std::abs(a)) << a << ' ' << y;
        }
    }
}

TEST(DepthMeeting, AnyDisplacementIsSafe) {
    const DepthPlane depth = plane_of([](int x, int y) { return (x * 7 + y * 13) % 5 < 2 ? 1e-6 : 1e9; });
    for (const double a : {0.0, 1e-30, 1e5, -1e30}) {
        const auto grids = grids_of(sideways(a, -a), {1e-6, 1e9});
        for (const DepthMeeting how : kHow)
            for (const Shift& d : meet(grids, depth, how, 1'000'000).d)
                EXPECT_FALSE(std::isnan(d.x) || std::isnan(d.y));
    }
}

TEST(DepthPlane, RangesOfBlocksCoverTheRadius) {
    const DepthPlane depth = plane_of([](int x, int y) { return 10 + (1000 + x * 31 + y * 17) % 23; });
    for (const int radius : {0, 1, 5, 9, 1000000}) {
        const PixelWindow tile{3, 5, 20, 9};
        const auto ranges = depth.around(tile, radius);
        const auto block = [](int v, int origin) { return (v - origin) / DepthPlane::kBlock; };
        const int columns = block(22, kWindow.x0) - block(3, kWindow.x0) + 1;
        for (int y = 5; y < 14; ++y)
            for (int x = 3; x < 23; ++x) {
                const auto& r =
                    ranges[static_cast<std::size_t>((block(y, kWindow.y0) - block(5, kWindow.y0)) * columns +
                                                    block(x, kWindow.x0) - block(3, kWindow.x0))];
                const int far = std::min(radius, 60);
                for (int j = -far; j <= far; ++j)
                    for (int i = -far; i <= far; ++i) {
                        const float z = depth.at(x + i, y + j);
                        ASSERT_TRUE(r.nearest <= z && z <= r.farthest);
                    }
            }
    }
    EXPECT_EQ(depth.at(-100, -100), depth.at(kWindow.x0, kWindow.y0));
    EXPECT_EQ(depth.nearest(), 10);
}

}  // namespace
}  // namespace eikonal
