// Blobs as screen-space displacement against the closed form in double precision (noise/blobs/blob_kernel.h), ray by
// ray.
#include "warp/displace/media/blobs/seen_blobs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "noise/blobs/blobs_spec.h"
#include "noise/math/random.h"
#include "warp/displace/grid/ray_frame.h"

namespace eikonal {
namespace {

constexpr PixelWindow kTile{0, 0, 512, 64};

Camera camera_of(Projection projection, double f_px) {
    Camera camera;
    camera.projection = projection;
    camera.position = {0.5, 1.5, 2};
    camera.center = {256, 32};
    camera.f_px = f_px;
    camera.pixel_aspect = 1.25;
    return camera;
}

/// d of an object at depth z, by the closed form along the pixel's own ray.
dvec2 truth(const std::vector<Blob>& blobs, double strength, const Camera& camera, int x, int y, double z) {
    const StraightRay ray = straight_ray(camera, x + 0.5, y + 0.5);
    dvec3 x1{0, 0, 0};
    for (const Blob& blob : blobs)
        x1 += strength * perturb(blob, ray.origin, ray.direction / ray.length, z * ray.length).x1;
    return image_shift(camera, ray, x1) / (camera.projection == Projection::Perspective ? z : 1.0);
}

dvec2 shift_at(std::vector<DisplacementGrid>& grids, int x, int y, double z) {
    dvec2 sum{0, 0};
    for (const DisplacementGrid& grid : grids) {
        GridRow row;
        row.start(grid, y);
        const Shift d = row.at(x, z);
        sum += dvec2(d.x, d.y);
    }
    return sum;
}

/// Largest |d| of the truth and of the difference, over pixels of the tile and depths.
struct Comparison {
    double largest = 0, error = 0;
};
Comparison compare(const std::vector<Blob>& blobs, const Camera& camera, double nearest, double farthest,
                   const std::vector<double>& depths, double strength = 1) {
    const SeenBlobs bends(blobs, strength, camera, farthest, 1);
    std::vector<DisplacementGrid> grids = bends.grids(kTile, kTile, nearest, farthest);
    Comparison result;
    for (int y = 0; y < 64; y += 7)
        for (int x = 0; x < 512; x += 5)
            for (const double z : depths) {
                const dvec2 expected = truth(blobs, strength, camera, x, y, z);
                result.largest = std::max(result.largest, glm::length(expected));
                result.error = std::max(result.error, glm::length(expected - shift_at(grids, x, y, z)));
            }
    return result;
}

TEST(SeenBlobs, AtOneDepthIsTheClosedFormForAnySizeOnTheScreen) {
    for (const Projection projection : {Projection::Perspective, Projection::Orthographic})
        for (const double sigma : {0.003, 0.01, 0.03, 0.1, 0.5}) {
            const Camera camera = camera_of(projection, projection == Projection::Perspective ? 2000 : 200);
            const Blob blob{{0.55, 1.51, -8}, sigma, -3e-4};
            const Comparison c = compare({blob}, camera, 20, 20, {20});
            EXPECT_GT(c.largest, 0.05) << sigma;
            EXPECT_LT(c.error, kBlobNodeError * c.largest + kNegligibleShift) << sigma;
        }
}

TEST(SeenBlobs, AreRightForObjectsBeforeInsideAndBehindTheCloud) {
    const RandomStream draw(3, "blob test");
    std::vector<Blob> blobs;
    for (std::uint64_t i = 0; i < 12; ++i)
        blobs.push_back(
            {{0.5 + draw.uniform(4 * i) - 0.5, 1.5 + 0.2 * draw.uniform(4 * i + 1), -8 - draw.uniform(4 * i + 2)},
             0.1 + 0.1 * draw.uniform(4 * i + 3),
             -2e-4});
    std::vector<double> depths;
    for (double z = 4; z < 30; z *= 1.013) depths.push_back(z);
    const Comparison c = compare(blobs, camera_of(Projection::Perspective, 2000), 4, 30, depths);
    EXPECT_GT(c.largest, 0.5);
    EXPECT_LT(c.error, (kBlobNodeError + kBlobDepthError) * c.largest + kNegligibleShift);
}

TEST(SeenBlobs, HoldWithTheCameraInsideABlobAndBesideOne) {
    const Camera camera = camera_of(Projection::Perspective, 400);
    for (const dvec3 from : {dvec3(0.02, 0.05, -0.03), dvec3(0.35, 0, -0.1), dvec3(0, 0.3, 0.1), dvec3(0, 0, 0.2)}) {
        const Comparison c = compare({{camera.position + from, 0.2, -2e-3}}, camera, 5, 5, {5});
        EXPECT_LT(c.error, kBlobNodeError * std::max(c.largest, 0.3) + kNegligibleShift)
            << from.x << ' ' << from.y << ' ' << from.z;
    }
}

TEST(SeenBlobs, HoldForASmallBlobFarAwayAndAside) {
    // Absolute positions in single precision would be off by a hundredth of σ.
    for (const double behind : {0.05, 1.0, 1000.0}) {
        Camera camera = camera_of(Projection::Perspective, 2e6);
        const dvec3 from{300, 200, -1000};
        camera.center = {256 - 0.3 * camera.f_px, 32 + 0.2 * camera.f_px * camera.pixel_aspect};
        const Blob blob{camera.position + from, 0.01, -3e-4};
        const double z = 1000 + behind;
        const Comparison c = compare({blob}, camera, z, z, {z});
        EXPECT_GT(c.largest, 0.05) << behind;
        EXPECT_LT(c.error, kBlobNodeError * c.largest + kNegligibleShift) << behind;
    }
}

TEST(SeenBlobs, WhatIsLeftOutStaysBelowTheThreshold) {
    // a thousand blobs whose tails overlap, each weak
    std::vector<Blob> blobs;
    const RandomStream draw(5, "weak blobs");
    for (std::uint64_t i = 0; i < 1000; ++i)
        blobs.push_back({{0.5 + 2 * draw.uniform(3 * i) - 1, 1.5 + 0.4 * draw.uniform(3 * i + 1) - 0.2, -9},
                         0.08 + 0.1 * draw.uniform(3 * i + 2),
                         -1e-7});
    const Camera camera = camera_of(Projection::Perspective, 2000);
    const Comparison c = compare(blobs, camera, 20, 20, {20});
    EXPECT_LT(c.error, kBlobNodeError * c.largest + kNegligibleShift);
    // The same at a strength at which almost every blob is left out.
    EXPECT_LE(compare(blobs, camera, 20, 20, {20}, 1e-3).error, kNegligibleShift);
}

TEST(SeenBlobs, TilesWithoutBlobsHaveNoBands) {
    const Camera camera = camera_of(Projection::Perspective, 2000);
    const SeenBlobs bends({{{0.5, 1.5, -8}, 0.02, -3e-4}}, 1, camera, 20, 1);
    EXPECT_EQ(bends.seen().size(), 1U);
    EXPECT_EQ(bends.grids(kTile, kTile, 20, 20).size(), 1U);
    for (const PixelWindow& tile : {PixelWindow{0, 64, 512, 64}, PixelWindow{512, 0, 512, 64}})
        EXPECT_TRUE(bends.grids(tile, tile, 20, 20).empty());
    // Blobs behind the camera, behind every object, and without strength.
    EXPECT_TRUE(SeenBlobs({{{0.5, 1.5, 8}, 0.02, -3e-4}}, 1, camera, 20, 1).seen().empty());
    EXPECT_TRUE(SeenBlobs({{{0.5, 1.5, -28}, 0.02, -3e-4}}, 1, camera, 20, 1).seen().empty());
    EXPECT_TRUE(SeenBlobs({{{0.5, 1.5, -8}, 0.02, 0}}, 1, camera, 20, 1).seen().empty());
}

TEST(SeenBlobs, ExtremesLeaveFiniteNodes) {
    for (const double f_px : {1.0, 1e7})
        for (const double sigma : {1e-6, 1.0, 1e9})
            for (const double z : {1e-6, 1.0, 1e9})
                for (const double n : {-1.0, 1e-300, 1e3}) {
                    const Camera camera = camera_of(Projection::Perspective, f_px);
                    const SeenBlobs bends({{camera.position + z * camera.forward, sigma, n}}, 1, camera, 2 * z, 1);
                    for (const DisplacementGrid& grid : bends.grids(kTile, {0, 0, 512, 2}, z, 2 * z))
                        for (const Node& node : grid.nodes)
                            for (int c = 0; c < 4; ++c)
                                ASSERT_TRUE(std::isfinite(node[c])) << f_px << ' ' << sigma << ' ' << z;
                }
}

/// Blobs that are left out as out of sight never move a pixel: sources and blobs all around the camera, at many times.
TEST(SeenBlobs, WhatIsOutOfSightMovesNothing) {
    constexpr double farthest = 10, strength = 40, negligible = 1e-3;
    const RandomStream stream(3, "homes");
    int out_of_sight = 0, in_sight = 0, moving = 0;
    for (std::uint64_t i = 0; i < 400; ++i) {
        const auto random = [&](std::uint64_t j) { return 2 * stream.uniform(16 * i + j) - 1; };
        const Camera camera = camera_of(i % 2 ? Projection::Perspective : Projection::Orthographic, i % 2 ? 700 : 100);
        const dvec3 from = camera.position + dvec3(8 * random(0), 3 * random(1), 14 * random(2));
        const double sigma = 0.1 * std::exp2(2 * random(3));
        BlobsSpec spec;
        spec.seed = i;
        if (i % 4 < 2) {
            spec.blobs.push_back({from, sigma, 900});
        } else {
            spec.sources.push_back(
                {from, from + dvec3(random(4), random(5), random(6)), 10, 900, sigma, 0.2, 0.01, 1.5});
            spec.wind = WindSpec{i, 0.2, 1, {random(7), random(8), random(9)}};
        }
        const BlobCloud cloud(spec, IndexLaw{2.77e-4, 288.15, 293}, "medium.0");
        const bool seen = may_be_seen(cloud.homes(), strength, camera, kTile, farthest, negligible);
        (seen ? in_sight : out_of_sight) += 1;
        double largest = 0;
        for (const double t : {-3.1, 0.0, 0.7, 12.0})
            for (const DisplacementGrid& grid :
                 SeenBlobs(cloud.at(t), strength, camera, farthest, 1).grids(kTile, kTile, farthest, farthest)) {
                GridRow row;
                for (int y = 0; y < 64; y += 9) {
                    row.start(grid, y);
                    for (int x = 0; x < 512; x += 9) {
                        const Shift d = row.at(x, farthest);
                        largest = std::max({largest, double{std::abs(d.x)}, double{std::abs(d.y)}});
                    }
                }
            }
        moving += largest > negligible;
        if (!seen) {
            EXPECT_LE(largest, negligible) << i;
        }
    }
    EXPECT_GT(out_of_sight, 100);
    EXPECT_GE(in_sight, moving) << out_of_sight;
    EXPECT_GT(moving, 10);
}

}  // namespace
}  // namespace eikonal
