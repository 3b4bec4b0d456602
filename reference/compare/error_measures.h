/// How far a warp is from the truth: of displacement maps in pixels, of pictures as the eye sees them.
///
/// Displacement errors are |d - d_true| [px], of the pixels that have a true answer. Pictures are compared as they are
/// shown, each channel limited to 0 ... 1: PSNR and SSIM on sRGB codes, what an eye tells apart by libjxl's butteraugli
/// on linear light (its last bits may differ from processor to processor). Images are interleaved linear R, G, B, A,
/// row 0 on top.
#pragma once

#include <span>
#include <vector>

#include "warp/scene/scene.h"

namespace eikonal::reference {

/// A jump of depth, relative, that makes a silhouette.
inline constexpr double kSilhouetteJump = 0.05;
/// Pixels this near to such a jump count as silhouette; if their true displacement is more, those as near as that [px].
inline constexpr int kSilhouetteReach = 3;
/// SSIM (Wang, Bovik, Sheikh, Simoncelli 2004): standard deviation and radius of its window [px], and its constants.
inline constexpr double kSsimSigma = 1.5;
inline constexpr int kSsimRadius = 5;
inline constexpr double kSsimC1 = 0.01 * 0.01, kSsimC2 = 0.03 * 0.03;

/// The norm over the picture that butteraugli's authors rank pictures by.
inline constexpr float kButteraugliNorm = 3;

/// Of a set of errors [px]; all 0 for none.
struct ErrorStatistics {
    std::size_t count = 0;
    double mean = 0, p50 = 0, p95 = 0, p99 = 0, largest = 0;
};
/// Quantile q is the value of rank round(q (count - 1)).
ErrorStatistics error_statistics(std::vector<float> errors);

struct PictureError {
    double psnr = 0;  ///< 10 log10(1/mean square) over R, G, B [dB]; infinite for equal pictures
    double ssim = 0;  ///< mean over the picture, of luma; 1 for equal pictures
    /// Perceptual difference: the kButteraugliNorm-norm of butteraugli's map of distances, lost and new detail counted
    /// alike; 1 is about what an eye that looks closely just notices. (OpenImageIO's compare_Yee will not do: version
    /// 2.4 finds no two greys different.)
    double butteraugli = 0;
};
/// a, b: width * height pixels. Infinite values count as 1, NaN as 0.
PictureError picture_error(std::span<const float> a, std::span<const float> b, int width, int height);

/// Of every pixel, how many rows or columns, whichever are more, it is from the nearest pixel beside a silhouette;
/// width + height where there is none. A silhouette is where neighbours' inverse depths (depths if orthographic) differ
/// by more than kSilhouetteJump of the larger and neither neighbour lies on the plane that the other one and the pixel
/// behind it span: sloping ground is no silhouette, however steep. depth [m] > 0, infinite for background.
std::vector<int> silhouette_distance(std::span<const float> depth, int width, int height, Projection projection);

}  // namespace eikonal::reference
