/// Hot blobs in the warp: the closed-form first-order perturbation (noise/blobs/blob_profile.h) as displacement.
///
///     X(z) = -2 n_j f_px e^{-|b|²/σ²} i1(a, c) b⊥,   a = -w_j/σ,  c = (L z - w_j)/σ     PHYSICS.md#blobs, *corrected*
///
/// The sum runs over all blobs. b leads from the blob to the pixel's ray, and w_j is the distance along the ray to the
/// point nearest to the blob. In perspective b⊥ in pixels is exact: with the blob at (r, u, f) in camera axes and the
/// ray's slope s it is b⊥ = (s_x f - r, s_y f - u). PHYSICS.md#slanted-rays
///
/// Cost. It is proportional to the area that blobs cover. Each blob is computed inside its disc only, on nodes that are
/// at most kNodeSpacing σ apart. A large blob therefore costs no more than a small one. Blobs are grouped by node
/// spacing: one grid for each group and tile, and none for tiles without blobs. Depths are at most kDepthSpacing σ
/// apart where blobs are. They are farther apart where there would be more than kMostBlobDepths of them. Between depths
/// X is interpolated by a cubic. Behind a blob X is a straight line in z, which the cubic represents exactly.
///
/// What is left out. A disc ends where its blob moves a pixel by less than kNegligibleShift/N, for N blobs. The sum of
/// all that is left out is therefore less than kNegligibleShift at any pixel and depth. A blob that is weaker than that
/// everywhere is skipped.
#pragma once

#include <vector>

#include "noise/blobs/blobs.h"
#include "warp/displace/grid/model.h"
#include "warp/displace/media/blobs/blob_grid.h"
#include "warp/scene/camera.h"

namespace eikonal {

/// Bound of the error of interpolation between nodes, relative to the blob's largest displacement.
/// (tests/warp/displace/seen_blobs_test.cpp)
inline constexpr double kBlobNodeError = 1e-3;
inline constexpr double kNodeSpacing = 0.35, kDepthSpacing = 0.5;
/// Bound of the error of interpolation between depths, relative to the blob's largest displacement. It holds where
/// kMostBlobDepths suffice.
inline constexpr double kBlobDepthError = 2e-3;
inline constexpr int kMostBlobDepths = 64;

/// The blobs of one instant. Immutable, thread-safe.
class SeenBlobs {
  public:
    /// strength: factor on ∇n. gain: factor on every displacement; it decides which blobs are too weak to see.
    /// farthest: largest depth of an object [m].
    SeenBlobs(std::vector<Blob> blobs, double strength, const Camera& camera, double farthest, double gain);

    /// Filled grids for the pixels of `cover`, which lies within the tile. Their depths depend on the tile alone.
    std::vector<DisplacementGrid> grids(const PixelWindow& tile, const PixelWindow& cover, double nearest,
                                        double farthest) const;
    /// The sum of all blobs on every pixel of a window, for objects at one depth. grids() interpolates this.
    DisplacementGrid every_pixel(const PixelWindow& window, double depth) const;

    const std::vector<Blob>& blobs() const { return blobs_; }
    /// The blobs that move any pixel.
    const std::vector<SeenBlob>& seen() const { return seen_; }
    /// Below: the spacing of nodes, and the depths, that suit all blobs.
    int finest_spacing() const;
    std::vector<double> depths(double nearest, double farthest) const;

  private:
    Camera camera_;
    std::vector<Blob> blobs_;
    std::vector<SeenBlob> seen_;
};

/// Upper bound of the displacement [px] that a blob n_j, σ at axial depth `forward` gives to objects up to `farthest`
/// [m]. It is the largest value, at b = σ/√2, of 2√π n_j (b/σ) e^{-b²/σ²}, the bend of a ray that passes the whole
/// blob.
double largest_blob_shift(const Blob& blob, double strength, const Camera& camera, double forward, double farthest);

/// Whether the blobs born at these homes can move a pixel of the window by more than `negligible` [px] together, at any
/// time. The answer false is certain.
bool may_be_seen(const std::vector<BlobHome>& homes, double strength, const Camera& camera, const PixelWindow& window,
                 double farthest, double negligible);

}  // namespace eikonal
