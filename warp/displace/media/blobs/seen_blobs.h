/// Hot blobs in the warp: the closed-form first-order perturbation (noise/blobs/blob_profile.h) as displacement.
///
///     X(z) = -2 n_j f_px e^{-|b|²/σ²} i1(a, c) b⊥,   a = -w_j/σ,  c = (L z - w_j)/σ     PHYSICS.md#blobs, *corrected*
///
/// summed over blobs. b leads from the blob to the pixel's ray, and w_j is where the two are closest. b⊥ in pixels is
/// exact in perspective: with the blob at (r, u, f) in camera axes and the ray's slope s, b⊥ = (s_x f - r, s_y f - u).
/// PHYSICS.md#slanted-rays
///
/// Cost. It follows the area that blobs cover. Each blob is worked out inside its disc only, on nodes that are at most
/// kNodeSpacing σ apart, so that a large blob costs no more than a small one. Blobs are grouped by node spacing: one
/// grid for each group and tile, and none for tiles without blobs. Depths are at most kLayerSpacing σ apart where blobs
/// are, or farther where there would be more than kMostBlobLayers of them. Between depths X is a cubic. Behind a blob X
/// is a straight line in z, which the cubic represents exactly.
///
/// What is left out. A disc ends where its blob moves a pixel by less than kNegligibleShift/N, for N blobs. All that is
/// dropped therefore sums up to less than kNegligibleShift at any pixel and depth. A blob that is weaker than that
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
inline constexpr double kNodeSpacing = 0.35, kLayerSpacing = 0.5;
/// Bound of the error between layers, relative likewise, where kMostBlobLayers suffice.
inline constexpr double kBlobLayerError = 2e-3;
inline constexpr int kMostBlobLayers = 64;

/// The blobs of one instant. Immutable, thread-safe.
class SeenBlobs {
  public:
    /// strength: multiplies ∇n. gain: on every displacement, decides what is too weak to see. farthest: depth [m].
    SeenBlobs(std::vector<Blob> blobs, double strength, const Camera& camera, double farthest, double gain);

    /// Filled grids for a tile: pixels of `cover`, which lies within it. Their layers depend on the tile alone.
    std::vector<DisplacementGrid> grids(const PixelWindow& tile, const PixelWindow& cover, double nearest,
                                        double farthest) const;
    /// All of them on every pixel of a window, for objects at one depth: what grids() interpolates.
    DisplacementGrid every_pixel(const PixelWindow& window, double depth) const;

    const std::vector<Blob>& blobs() const { return blobs_; }
    /// Those that move anything.
    const std::vector<SeenBlob>& seen() const { return seen_; }
    /// Spacing of nodes and depths of layers that suit all of them together.
    int finest_spacing() const;
    std::vector<double> layers(double nearest, double farthest) const;

  private:
    Camera camera_;
    std::vector<Blob> blobs_;
    std::vector<SeenBlob> seen_;
};

/// Upper bound of the displacement by a blob n_j, σ at axial depth `forward`, of objects up to `farthest` [px]: the
/// whole pass' 2√π n_j (b/σ) e^{-b²/σ²} at its largest, b = σ/√2.
double largest_blob_shift(const Blob& blob, double strength, const Camera& camera, double forward, double farthest);

/// Whether blobs that live there can move anything in the window, at any time, by more than negligible [px] all
/// together; false is certain.
bool may_be_seen(const std::vector<BlobHome>& homes, double strength, const Camera& camera, const PixelWindow& window,
                 double farthest, double negligible);

}  // namespace eikonal
