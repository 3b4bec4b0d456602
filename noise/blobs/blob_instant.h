/// The index of a set of blobs at any point, as a tracer needs it: Σ_j n_j exp(-|x - x_j|²/σ_j²) with its derivatives,
/// and how far a ray may go without meeting any of it. A tree of bounding boxes finds the blobs.
///
/// A blob ends at kBlobReach σ from its centre, where it has fallen to kNegligibleIndex (noise/math/index_sample.h) of
/// its own largest: the sum is exact but for that. Blobs without index (n = 0) are left out. Sums run in the order of
/// the tree, a function of the blobs and their order alone. Metres; n without exaggeration. Finite for finite x and
/// blobs in the range of noise/blobs/blobs.h. Immutable, thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "noise/blobs/blob_kernel.h"
#include "noise/math/index_sample.h"

namespace eikonal {

/// √(-ln kNegligibleIndex)
inline constexpr double kBlobReach = 6.0697085;
/// The longest step within a blob [σ], unless stated.
inline constexpr double kBlobStep = 0.5;
/// The longest step within a blob of a method that controls its error [σ].
inline constexpr double kBlobStride = 1.5;

class BlobInstant {
  public:
    /// reach: where a blob ends [σ]; less than kBlobReach is quicker, and drops e^{-reach²} of each. step: the longest
    /// within a blob [σ].
    explicit BlobInstant(std::span<const Blob> blobs, double reach = kBlobReach, double step = kBlobStep);

    /// n - n_ambient and its gradient at x.
    IndexSample sample(const dvec3& x) const;
    /// The same with the second derivatives.
    IndexJet jet(const dvec3& x) const;

    /// The longest step from x in any direction that misses no blob: least over all of `step` σ plus the way to it.
    /// Infinity without blobs.
    double longest_step(const dvec3& x) const;
    /// The longest step from x along the unit direction d of a method that controls its error and looks at both ends:
    /// no longer than kBlobStride σ, or ending σ before the centre at most. So it looks next to where a blob is
    /// strongest on its way. Blobs that turn this ray by less than `turn` [rad] > 0 do not count; infinity if none
    /// does.
    double longest_stride(const dvec3& x, const dvec3& d, double turn) const;

    /// Bend of the straight ray from x along the unit direction d at its end, D = distance > 0 [m] away, in closed form
    /// (noise/blobs/blob_kernel.h): x1 = ∫₀^D (D - w) ∇n dw. Blobs that turn a ray by less than `turn` [rad] are left
    /// out.
    struct Bend {
        dvec3 x1{0, 0, 0};
        double largest = 0;  ///< bound of |n - n_ambient| on the way
    };
    Bend bend(const dvec3& x, const dvec3& d, double distance, double turn) const;

    /// Way from x along the unit direction d to the first blob's reach: 0 inside one or touching it (kTouch of
    /// noise/math/ray_bounds.h), infinity if none is met.
    double clear_way(const dvec3& x, const dvec3& d) const;

    /// Bounds of n - n_ambient anywhere: as if all blobs of a sign stood in one place.
    double lower_bound() const { return lower_; }
    double upper_bound() const { return upper_; }

    bool empty() const { return balls_.empty(); }

  private:
    struct Ball {
        dvec3 center;
        double sigma, n, inverse2, reach;  ///< inverse2: 1/σ²
        std::uint32_t index;
    };
    /// Children of an inner node: the next one, and `second`.
    struct Node {
        dvec3 low, high;
        double least_sigma;
        std::uint32_t first, count;  ///< balls of a leaf; count 0: inner
        std::uint32_t second;
    };

    void build(std::uint32_t first, std::uint32_t last);
    double reach_of(double turn) const;
    /// Calls action(ball) for every ball of a leaf that, like all above it, meets(node).
    template <class Meets, class Action>
    void for_each(Meets&& meets, Action&& action) const;
    /// Calls action(ball, d = x - center, |d|²) for every ball that holds x.
    template <class Action>
    void for_each_at(const dvec3& x, Action&& action) const;
    /// Least of distance(ball) over all, where bound(node) is no larger than that of any ball inside.
    template <class Bound, class Distance>
    double least(Bound&& bound, Distance&& distance) const;

    std::vector<Ball> balls_;
    std::vector<Node> nodes_;
    double step_, lower_ = 0, upper_ = 0, strongest_ = 0;
};

}  // namespace eikonal
