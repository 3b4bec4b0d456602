/// The area filter of the resampler, which follows the Jacobian of the map p -> p + d(p). Private to the resampler.
///
/// Geometrical optics conserves radiance, so a pixel shows the mean of the source over the patch that the map gives it.
/// An unresolved light dims where the map squeezes the picture, and covers more pixels where the map spreads it.
/// (*added*; like Heckbert's elliptical weighted average, 1989, but with exact coverage instead of a Gaussian.)
///
/// Footprint. J = I + grad d, by finite differences of the map. J is the linear map of the pixel's unit square up to a
/// rotation: J = M R, M = sqrt(J J^T), symmetric. The footprint is the parallelogram M [-1/2, 1/2]^2 about the
/// source position, with the eigenvalues of M clamped to 1 ... max_stretch:
///  - The lower bound makes the footprint at least one pixel, so a magnified picture is interpolated. (At M = I the
///    coverage of the sample grid by a shifted unit square is bilinear interpolation.) It also keeps caustics
///    (det J = 0) and folds (det J < 0) well defined.
///  - The upper bound limits the work. A stronger squeeze is undersampled.
/// The displacement by hot air is a gradient, hence J is symmetric and, where both eigenvalues are >= 1, M = J: the
/// footprints of neighbouring pixels tile the source. Elsewhere they have J's area and second moments.
///
/// Weights. Sample s has the exact weight area(footprint with the unit square of s) / area(footprint). Weights are >= 0
/// and sum to 1. The flux of a light over all output pixels is the area of its image. This is exact where the
/// footprints tile. Where the map magnifies, it has the phase-dependent ripple of bilinear interpolation, which is zero
/// on average.
///
/// Silhouettes. The differences pass the monotonised-central limiter (van Leer 1977). Without it, a jump of the map
/// between foreground and background would count as a squeeze, and one would smear over the other.
/// Theory: PHYSICS.md#resampling.
#pragma once

#include "warp/resample/span.h"

namespace eikonal::resampling {

/// Largest eigenvalue of M, source pixels an output pixel.
inline constexpr float max_stretch = 16;

/// Rms error of the flux of one-pixel lights under smooth shimmer of rms 2 px without folds. (The flux is 1 where
/// nothing is squeezed.)
inline constexpr double area_flux_error = 0.04;
/// The same where the map squeezes in both directions.
inline constexpr double area_squeezed_flux_error = 0.01;

/// M = [xx xy; xy yy] for the pixels of a span. M = I exactly where both eigenvalues of J J^T are <= 1 + 1e-6.
struct alignas(64) Footprints {
    float xx[span_length], xy[span_length], yy[span_length];
};

/// M of n pixels from (x, y) on, which count from the corner of the map's window. The displacement is scale * d.
void measure(const MapView& d, int n, int x, int y, float scale, Footprints& footprints);

/// Filters all pixels of the span into out[0 ... n). The span must be prepared for Filter::Area. (x, y) is its first
/// pixel, which counts from the source's corner.
void sample_area(const Source& source, const Span& span, const Footprints& footprints, int x, int y, Pixel* out);

}  // namespace eikonal::resampling
