/// How far a warp is from the truth: displacement maps in pixels, and pictures as the eye sees them.
///
/// Displacement errors are |d - d_true| [px] of the pixels that have a true answer. Pictures are compared as they are
/// shown, with each channel limited to 0 ... 1. PSNR and SSIM use sRGB codes. libjxl's butteraugli uses linear light,
/// and its last bits may differ between processors. Images are interleaved linear R, G, B, A, with row 0 on top.
#pragma once

#include <span>
#include <vector>

#include "warp/scene/scene.h"

namespace eikonal::reference {

/// The least relative jump of depth that makes a silhouette.
inline constexpr double kSilhouetteJump = 0.05;
/// Pixels within this distance of such a jump count as silhouette [px]. If their true displacement is larger, it takes
/// the place of this distance.
inline constexpr int kSilhouetteReach = 3;
/// The window of SSIM (Wang, Bovik, Sheikh, Simoncelli 2004), its standard deviation and radius [px], and its
/// constants.
inline constexpr double kSsimSigma = 1.5;
inline constexpr int kSsimRadius = 5;
inline constexpr double kSsimC1 = 0.01 * 0.01, kSsimC2 = 0.03 * 0.03;

/// The norm over the picture by which butteraugli's authors rank pictures.
inline constexpr float kButteraugliNorm = 3;

/// Statistics of a set of errors [px]. All 0 for an empty set.
struct ErrorStatistics {
    std::size_t count = 0;
    double mean = 0, p50 = 0, p95 = 0, p99 = 0, largest = 0;
};
/// The statistics of `errors`. Quantile q is the value of rank round(q (count - 1)).
ErrorStatistics error_statistics(std::vector<float> errors);

struct PictureError {
    double psnr = 0;  ///< 10 log10(1/mean square) over R, G, B [dB]; infinite for equal pictures
    double ssim = 0;  ///< mean over the picture, of luma; 1 for equal pictures
    /// Perceptual difference: the kButteraugliNorm-norm of butteraugli's map of distances. Lost and new detail count
    /// alike. An eye that looks closely just notices about 1. (OpenImageIO's compare_Yee cannot serve: version 2.4
    /// finds no difference between any two greys.)
    double butteraugli = 0;
};
/// Compares pictures of width * height pixels. Infinite values count as 1, and NaN as 0.
PictureError picture_error(std::span<const float> a, std::span<const float> b, int width, int height);

/// For every pixel, its distance from the nearest pixel beside a silhouette: rows or columns, whichever are more.
/// width + height if there is no silhouette. A silhouette lies between two neighbours whose inverse depths (depths if
/// orthographic) differ by more than kSilhouetteJump of the larger one. Neither may lie on the plane through the other
/// one and the pixel behind that, so sloping ground is no silhouette, however steep. depth [m] > 0, infinite for
/// background.
std::vector<int> silhouette_distance(std::span<const float> depth, int width, int height, Projection projection);

}  // namespace eikonal::reference
