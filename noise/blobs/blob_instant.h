/// The index of a set of blobs at any point, Σ_j n_j exp(-|x - x_j|²/σ_j²), with its derivatives, and how far a ray may
/// go before it meets any of them. A tree of bounding boxes finds the blobs.
///
/// A blob ends at kBlobReach σ from its centre, where it has fallen to kNegligibleIndex (noise/math/index_sample.h) of
/// its own largest value. Otherwise the sum is exact. Blobs without index (n = 0) are left out. Sums run in the order
/// of the tree, which depends on the blobs and their order only. Units: metres; n without exaggeration. Results are
/// finite for finite x and blobs in the range of noise/blobs/blobs.h. Immutable, thread-safe. Failures: std::bad_alloc.
/// Theory: PHYSICS.md#blobs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "noise/blobs/blob_kernel.h"
#include "noise/math/index_sample.h"

namespace eikonal {

/// Where a blob ends [σ]: √(-ln kNegligibleIndex).
inline constexpr double kBlobReach = 6.0697085;
/// The longest step within a blob [σ], unless the constructor is told otherwise.
inline constexpr double kBlobStep = 0.5;
/// The longest step within a blob [σ] for a method that controls its error.
inline constexpr double kBlobStride = 1.5;

class BlobInstant {
  public:
    /// reach: where a blob ends [σ]. Less than kBlobReach is quicker, and drops what is below e^{-reach²} of each blob.
    /// step: the longest step within a blob [σ].
    explicit BlobInstant(std::span<const Blob> blobs, double reach = kBlobReach, double step = kBlobStep);

    /// n - n_ambient and its gradient at x [m].
    IndexSample sample(const dvec3& x) const;
    /// With the second derivatives.
    IndexJet jet(const dvec3& x) const;

    /// The longest step [m] from x in any direction that misses no blob: the least, over all blobs, of `step` σ plus
    /// the way to the blob. Infinity without blobs.
    double longest_step(const dvec3& x) const;
    /// The longest step [m] from x along the unit direction d, for a method that controls its error and samples both
    /// ends. The step is no longer than kBlobStride σ, or it ends σ or more before the point nearest to the blob's
    /// centre. The method so samples near the place where the blob is strongest. Blobs that turn this ray by less than
    /// `turn` [rad] > 0 do not count. Infinity if no blob counts.
    double longest_stride(const dvec3& x, const dvec3& d, double turn) const;

    /// The bend of the straight ray from x along the unit direction d, at its end D = distance > 0 [m] away:
    /// x1 = ∫₀^D (D - w) ∇n dw in closed form (noise/blobs/blob_kernel.h). Blobs that turn a ray by less than `turn`
    /// [rad] are left out.
    struct Bend {
        dvec3 x1{0, 0, 0};   ///< [m]
        double largest = 0;  ///< a bound of |n - n_ambient| on the way
    };
    Bend bend(const dvec3& x, const dvec3& d, double distance, double turn) const;

    /// Way from x along the unit direction d to the first blob's reach [m]. 0 inside a blob or where it is touched
    /// (kTouch of noise/math/ray_bounds.h). Infinity if no blob is met.
    double clear_way(const dvec3& x, const dvec3& d) const;

    /// Bounds of n - n_ambient anywhere: the sums of all negative n_j and of all positive n_j.
    double lower_bound() const { return lower_; }
    double upper_bound() const { return upper_; }

    bool empty() const { return balls_.empty(); }

  private:
    struct Ball {
        dvec3 center;
        double sigma, n, inverse2, reach;  ///< inverse2: 1/σ²
        std::uint32_t index;
    };
    /// The children of an inner node are the next node and `second`.
    struct Node {
        dvec3 low, high;
        double least_sigma;
        std::uint32_t first, count;  ///< balls of a leaf; count is 0 for an inner node
        std::uint32_t second;
    };

    void build(std::uint32_t first, std::uint32_t last);
    double reach_of(double turn) const;
    /// Calls action(ball) for every ball of every leaf that, like all nodes above it, satisfies meets(node).
    template <class Meets, class Action>
    void for_each(Meets&& meets, Action&& action) const;
    /// Calls action(ball, d = x - center, |d|²) for every ball that holds x.
    template <class Action>
    void for_each_at(const dvec3& x, Action&& action) const;
    /// The least distance(ball) of all balls. bound(node) must not exceed the distance of any ball within the node.
    template <class Bound, class Distance>
    double least(Bound&& bound, Distance&& distance) const;

    std::vector<Ball> balls_;
    std::vector<Node> nodes_;
    double step_, lower_ = 0, upper_ = 0, strongest_ = 0;
};

}  // namespace eikonal
