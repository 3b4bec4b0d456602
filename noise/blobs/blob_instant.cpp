#include "noise/blobs/blob_instant.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "noise/math/portable_math.h"
#include "noise/math/ray_bounds.h"

namespace eikonal {
namespace {

constexpr std::uint32_t kLeafSize = 16;
/// Room of the stack: halving 2^32 balls goes no deeper, and each level leaves one node to come back to.
constexpr std::size_t kDeepest = 40;

bool inside(const dvec3& x, const dvec3& low, const dvec3& high) {
    return x.x >= low.x && x.x <= high.x && x.y >= low.y && x.y <= high.y && x.z >= low.z && x.z <= high.z;
}

double distance_to_box(const dvec3& x, const dvec3& low, const dvec3& high) {
    const dvec3 d = glm::max(glm::max(low - x, x - high), dvec3(0));
    return glm::length(d);
}

/// 1/d. It is large but finite for coordinates that do not change along d.
dvec3 inverse(const dvec3& d) {
    constexpr double kLarge = 1e300;
    return {d.x == 0 ? kLarge : 1 / d.x, d.y == 0 ? kLarge : 1 / d.y, d.z == 0 ? kLarge : 1 / d.z};
}

/// Way along d into a box. kNever if the ray misses it.
double way_into_box(const dvec3& x, const dvec3& inverse_d, const dvec3& low, const dvec3& high) {
    const dvec3 a = (low - x) * inverse_d, b = (high - x) * inverse_d;
    const dvec3 near = glm::min(a, b), far = glm::max(a, b);
    const double enter = std::max({0.0, near.x, near.y, near.z}), leave = std::min({far.x, far.y, far.z});
    return enter <= leave ? enter : kNever;
}

}  // namespace

BlobInstant::BlobInstant(std::span<const Blob> blobs, double reach, double step) : step_(step) {
    balls_.reserve(blobs.size());
    for (const Blob& blob : blobs) {
        if (blob.n == 0) continue;
        balls_.push_back({blob.center, blob.sigma, blob.n, 1 / (blob.sigma * blob.sigma), reach * blob.sigma,
                          static_cast<std::uint32_t>(balls_.size())});
        (blob.n < 0 ? lower_ : upper_) += blob.n;
        strongest_ = std::max(strongest_, std::abs(blob.n));
    }
    if (!balls_.empty()) build(0, static_cast<std::uint32_t>(balls_.size()));
}

void BlobInstant::build(std::uint32_t first, std::uint32_t last) {
    const std::size_t at = nodes_.size();
    Node node{dvec3(kNever), dvec3(-kNever), kNever, first, last - first, 0};
    dvec3 least = node.low, most = node.high;  // bounds of the centres
    for (std::uint32_t i = first; i < last; ++i) {
        const Ball& ball = balls_[i];
        node.low = glm::min(node.low, ball.center - ball.reach);
        node.high = glm::max(node.high, ball.center + ball.reach);
        node.least_sigma = std::min(node.least_sigma, ball.sigma);
        least = glm::min(least, ball.center);
        most = glm::max(most, ball.center);
    }
    nodes_.push_back(node);
    if (node.count <= kLeafSize) {
        std::sort(balls_.begin() + first, balls_.begin() + last,
                  [](const Ball& a, const Ball& b) { return a.index < b.index; });
        return;
    }
    const dvec3 extent = most - least;
    int axis = extent.y > extent.x ? 1 : 0;
    if (extent.z > extent[axis]) axis = 2;
    const std::uint32_t middle = first + (last - first) / 2;
    std::nth_element(
        balls_.begin() + first, balls_.begin() + middle, balls_.begin() + last, [axis](const Ball& a, const Ball& b) {
            return a.center[axis] < b.center[axis] || (a.center[axis] == b.center[axis] && a.index < b.index);
        });
    nodes_[at].count = 0;
    build(first, middle);
    nodes_[at].second = static_cast<std::uint32_t>(nodes_.size());
    build(middle, last);
}

template <class Meets, class Action>
void BlobInstant::for_each(Meets&& meets, Action&& action) const {
    if (nodes_.empty()) return;
    std::array<std::uint32_t, kDeepest> waiting;
    std::size_t depth = 0;
    std::uint32_t at = 0;
    for (;;) {
        const Node& node = nodes_[at];
        if (meets(node)) {
            if (node.count == 0) {
                waiting[depth++] = node.second;
                ++at;
                continue;
            }
            for (std::uint32_t i = node.first; i < node.first + node.count; ++i) action(balls_[i]);
        }
        if (depth == 0) return;
        at = waiting[--depth];
    }
}

template <class Action>
void BlobInstant::for_each_at(const dvec3& x, Action&& action) const {
    for_each([&](const Node& node) { return inside(x, node.low, node.high); },
             [&](const Ball& ball) {
                 const dvec3 d = x - ball.center;
                 const double r2 = d.x * d.x + d.y * d.y + d.z * d.z;
                 if (r2 < ball.reach * ball.reach) action(ball, d, r2);
             });
}

template <class Bound, class Distance>
double BlobInstant::least(Bound&& bound, Distance&& distance) const {
    double best = kNever;
    if (nodes_.empty()) return best;
    struct Waiting {
        std::uint32_t node;
        double bound;
    };
    std::array<Waiting, kDeepest> waiting;
    std::size_t depth = 0;
    waiting[depth++] = {0, bound(nodes_[0])};
    while (depth > 0) {
        const Waiting next = waiting[--depth];
        if (next.bound >= best) continue;
        const Node& node = nodes_[next.node];
        if (node.count > 0) {
            for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
                best = std::min(best, distance(balls_[i]));
            continue;
        }
        Waiting near{next.node + 1, bound(nodes_[next.node + 1])}, far{node.second, bound(nodes_[node.second])};
        if (far.bound < near.bound) std::swap(near, far);
        waiting[depth++] = far;
        waiting[depth++] = near;
    }
    return best;
}

IndexSample BlobInstant::sample(const dvec3& x) const {
    IndexSample sum;
    for_each_at(x, [&](const Ball& ball, const dvec3& d, double r2) {
        const double n = ball.n * portable::exp(-r2 * ball.inverse2);
        sum.n += n;
        sum.gradient += (-2 * ball.inverse2 * n) * d;
    });
    return sum;
}

IndexJet BlobInstant::jet(const dvec3& x) const {
    IndexJet sum;
    for_each_at(x, [&](const Ball& ball, const dvec3& d, double r2) {
        const double n = ball.n * portable::exp(-r2 * ball.inverse2), slope = -2 * ball.inverse2 * n;
        sum.n += n;
        sum.gradient += slope * d;
        // n (4 d dᵀ/σ⁴ - 2 I/σ²)
        sum.hessian += glm::outerProduct((-2 * ball.inverse2 * slope) * d, d);
        for (int axis = 0; axis < 3; ++axis) sum.hessian[axis][axis] += slope;
    });
    return sum;
}

double BlobInstant::longest_step(const dvec3& x) const {
    return least([&](const Node& node) { return distance_to_box(x, node.low, node.high) + step_ * node.least_sigma; },
                 [&](const Ball& ball) {
                     return std::max(0.0, glm::length(x - ball.center) - ball.reach) + step_ * ball.sigma;
                 });
}

/// Distance from a blob's centre [σ] beyond which every blob turns a ray by less than `turn`. A blob turns a ray that
/// passes at distance b by 2√π |n_j| b e^{-b²}, with b <= kBlobReach.
double BlobInstant::reach_of(double turn) const {
    constexpr double kTwoRootPi = 3.5449077018110318;
    const double ratio = kTwoRootPi * kBlobReach * strongest_ / turn;
    if (!(ratio > 1)) return 0;
    return std::min(kBlobReach, std::sqrt(portable::log(ratio)));
}

double BlobInstant::longest_stride(const dvec3& x, const dvec3& d, double turn) const {
    const double reach = reach_of(turn);
    const dvec3 inverse_d = inverse(d);
    return least(
        [&](const Node& node) {
            const double way = way_into_box(x, inverse_d, node.low, node.high);
            return way < kNever ? std::max(kBlobStride * node.least_sigma, way) : kNever;
        },
        [&](const Ball& ball) {
            const dvec3 from = ball.center - x;
            const double sigma = ball.sigma, w = glm::dot(from, d), r2 = glm::dot(from, from), end = reach * sigma;
            // The least distance that the ray has from here on.
            if (!((w > 0 ? r2 - w * w : r2) < end * end)) return kNever;
            return std::max(kBlobStride * sigma, std::sqrt(r2) - sigma);
        });
}

BlobInstant::Bend BlobInstant::bend(const dvec3& x, const dvec3& d, double distance, double turn) const {
    const double reach = reach_of(turn);
    const dvec3 inverse_d = inverse(d);
    Bend sum;
    for_each([&](const Node& node) { return way_into_box(x, inverse_d, node.low, node.high) <= distance; },
             [&](const Ball& ball) {
                 const dvec3 from = x - ball.center;
                 const double w = -glm::dot(from, d);
                 const dvec3 b = from + w * d;
                 const double b2 = glm::dot(b, b), r = reach * ball.sigma;
                 if (!(b2 < r * r && w > -r && w - distance < r)) return;
                 sum.x1 += perturb_at(ball.sigma, ball.n, b, w, d, distance).x1;
                 sum.largest += std::abs(ball.n) * portable::exp(-b2 * ball.inverse2);
             });
    return sum;
}

double BlobInstant::clear_way(const dvec3& x, const dvec3& d) const {
    const dvec3 inverse_d = inverse(d);
    return least([&](const Node& node) { return way_into_box(x, inverse_d, node.low, node.high); },
                 [&](const Ball& ball) {
                     const Chord chord(x - ball.center, d, ball.reach);
                     if (!(chord.leave > 0 && chord.leave < kNever)) return kNever;
                     return chord.enter > kTouch * ball.reach ? chord.enter : 0;
                 });
}

}  // namespace eikonal
