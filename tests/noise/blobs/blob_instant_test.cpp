// Sums of blobs at a point, compared with brute force: values, derivatives, steps and free ways.
#include "noise/blobs/blob_instant.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <vector>

#include "noise/air/air.h"
#include "noise/math/random.h"

namespace eikonal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Blobs of many sizes, some overlapping, some alone.
std::vector<Blob> scattered(std::size_t count) {
    const RandomStream stream(4, "test blobs");
    std::vector<Blob> blobs;
    for (std::uint64_t i = 0; i < count; ++i) {
        const dvec3 center(stream.uniform(5 * i), stream.uniform(5 * i + 1), stream.uniform(5 * i + 2));
        blobs.push_back(
            {10.0 * center, 0.01 + 0.2 * stream.uniform(5 * i + 3), -1e-4 * (stream.uniform(5 * i + 4) - 0.2)});
    }
    if (count > 3) blobs[3].n = 0;
    return blobs;
}

dvec3 random_point(const RandomStream& stream, std::uint64_t i) {
    return 14.0 * dvec3(stream.uniform(3 * i), stream.uniform(3 * i + 1), stream.uniform(3 * i + 2)) - 2.0;
}

dvec3 random_direction(const RandomStream& stream, std::uint64_t i) {
    return glm::normalize(random_point(stream, i) - 5.0);
}

TEST(BlobInstant, ReachIsWhereABlobIsNegligible) {
    EXPECT_NEAR(std::exp(-kBlobReach * kBlobReach) / kNegligibleIndex, 1, 1e-5);
}

TEST(BlobInstant, SumsLikeBruteForce) {
    for (const std::size_t count : {0, 1, 2, 5, 400}) {
        const std::vector<Blob> blobs = scattered(count);
        const BlobInstant instant(blobs);
        const RandomStream stream(8, "test points");
        for (std::uint64_t i = 0; i < 2000; ++i) {
            const dvec3 x = random_point(stream, i);
            double n = 0;
            dvec3 gradient(0);
            glm::dmat3 hessian(0);
            for (const Blob& blob : blobs) {
                const dvec3 d = (x - blob.center) / blob.sigma;
                const double value = blob.n * std::exp(-glm::dot(d, d));
                n += value;
                gradient -= 2 * value / blob.sigma * d;
                hessian += value / (blob.sigma * blob.sigma) * (4.0 * glm::outerProduct(d, d) - glm::dmat3(2.0));
            }
            const IndexSample sample = instant.sample(x);
            const IndexJet jet = instant.jet(x);
            EXPECT_EQ(sample.n, jet.n);
            EXPECT_EQ(sample.gradient, jet.gradient);
            EXPECT_NEAR(jet.n, n, 1e-17);
            EXPECT_LT(glm::length(jet.gradient - gradient), 1e-15);
            for (int axis = 0; axis < 3; ++axis) EXPECT_LT(glm::length(jet.hessian[axis] - hessian[axis]), 1e-13);
            EXPECT_GE(n, instant.lower_bound() - 1e-18);
            EXPECT_LE(n, instant.upper_bound() + 1e-18);
        }
    }
}

TEST(BlobInstant, DerivativesAreThoseOfTheIndex) {
    const BlobInstant instant(scattered(400));
    const RandomStream stream(8, "test points");
    constexpr double h = 1e-5;
    for (std::uint64_t i = 0; i < 500; ++i) {
        const dvec3 x = random_point(stream, i);
        const IndexJet jet = instant.jet(x);
        for (int axis = 0; axis < 3; ++axis) {
            dvec3 step(0);
            step[axis] = h;
            const IndexSample low = instant.sample(x - step), high = instant.sample(x + step);
            EXPECT_NEAR((high.n - low.n) / (2 * h), jet.gradient[axis], 1e-8);
            EXPECT_LT(glm::length((high.gradient - low.gradient) / (2 * h) - jet.hessian[axis]), 1e-5);
        }
    }
}

TEST(BlobInstant, StepsAndWaysMissNothing) {
    for (const std::size_t count : {1, 5, 400}) {
        const std::vector<Blob> blobs = scattered(count);
        const BlobInstant instant(blobs);
        const RandomStream stream(8, "test points");
        for (std::uint64_t i = 0; i < 2000; ++i) {
            const dvec3 x = random_point(stream, 2 * i), d = random_direction(stream, 2 * i + 1);
            double step = kInfinity, way = kInfinity;
            for (const Blob& blob : blobs) {
                if (blob.n == 0) continue;
                const double r = glm::length(x - blob.center), reach = kBlobReach * blob.sigma;
                step = std::min(step, std::max(0.0, r - reach) + kBlobStep * blob.sigma);
                const double along = glm::dot(blob.center - x, d);
                const double half2 = reach * reach - r * r + along * along;
                if (half2 > 0 && along + std::sqrt(half2) > 0)
                    way = std::min(way, std::max(0.0, along - std::sqrt(half2)));
            }
            EXPECT_NEAR(instant.longest_step(x), step, 1e-12);
            const double found = instant.clear_way(x, d);
            EXPECT_TRUE(found == way || std::abs(found - way) < 1e-8) << found << " " << way;
            // There is no blob before it, and no way is left at its end.
            for (int s = 0; found > 0 && s < 20; ++s)
                EXPECT_EQ(instant.sample(x + std::min(found, 30.0) * (1 - 1e-9) * (s / 20.0) * d).n, 0);
            if (found < kInfinity) {
                EXPECT_EQ(instant.clear_way(x + found * d, d), 0);
            }
        }
    }
}

TEST(BlobInstant, NothingIsFarFromEverything) {
    const BlobInstant instant{{}};
    EXPECT_TRUE(instant.empty());
    EXPECT_EQ(instant.longest_step({0, 0, 0}), kInfinity);
    EXPECT_EQ(instant.clear_way({0, 0, 0}, {0, 0, 1}), kInfinity);
    EXPECT_EQ(instant.sample({0, 0, 0}).n, 0);
}

TEST(BlobInstant, RaysAlongAnAxisFindTheirBlob) {
    const std::vector<Blob> blobs{{{0, 0, 5}, 0.5, -1e-5}, {{3, 0, 0}, 0.1, -1e-5}};
    const BlobInstant instant(blobs);
    EXPECT_NEAR(instant.clear_way({0, 0, 0}, {0, 0, 1}), 5 - kBlobReach * 0.5, 1e-12);
    EXPECT_NEAR(instant.clear_way({0, 0, 0}, {1, 0, 0}), 3 - kBlobReach * 0.1, 1e-12);
    EXPECT_EQ(instant.clear_way({0, 0, 0}, {0, 1, 0}), kInfinity);
    EXPECT_EQ(instant.clear_way({0, 0, 5}, {0, 1, 0}), 0);
}

}  // namespace
}  // namespace eikonal
