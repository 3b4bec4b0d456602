/// Inside the resampler: the area filter, which follows the Jacobian of the map p -> p + d(p).
///
/// Geometrical optics conserves radiance: a pixel shows the mean of the source over the patch that the map gives it, so
/// an unresolved light dims where the map squeezes the picture and covers more pixels where it spreads it. (*added*;
/// in the spirit of Heckbert's elliptical weighted average, 1989, with exact coverage in place of a Gaussian.)
///
/// Footprint. J = I + grad d, by finite differences of the map. J is the linear map of the pixel's unit square up to a
/// rotation: J = M R, M = sqrt(J J^T), symmetric. The footprint is the parallelogram M [-1/2, 1/2]^2 about the
/// source position, with the eigenvalues of M clamped to 1 ... max_stretch:
///  - >= 1, so that a magnified picture is interpolated (footprint at least one pixel: at M = I the coverage of the
///    sample grid by a shifted unit square is bilinear interpolation). It also keeps caustics (det J = 0) and folds
///    (det J < 0) well defined;
///  - <= max_stretch bounds the work; a stronger squeeze is undersampled.
/// The displacement by hot air is a gradient, hence J is symmetric and, where both eigenvalues are >= 1, M = J: the
/// footprints of neighbouring pixels tile the source. Elsewhere they have J's area and second moments.
///
/// Weights. Sample s weighs area(footprint with the unit square of s) / area(footprint), exactly, hence they are >= 0
/// and sum to 1, and the flux of a light over all output pixels is the area of its image: exact where the footprints
/// tile, with the phase-dependent ripple of bilinear interpolation (zero on average) where the map magnifies.
///
/// Silhouettes. The differences pass the monotonised-central limiter (van Leer 1977), so that a jump of the map between
/// a foreground and a background is not taken for a squeeze, which would smear one over the other.
#pragma once

#include "warp/resample/span.h"

namespace eikonal::resampling {

/// Largest eigenvalue of M, source pixels an output pixel.
inline constexpr float max_stretch = 16;

/// Rms error of the flux of one-pixel lights (1 where nothing is squeezed) under smooth shimmer of rms 2 px without
/// folds.
inline constexpr double area_flux_error = 0.04;
/// The same where the map squeezes in both directions.
inline constexpr double area_squeezed_flux_error = 0.01;

/// M = [xx xy; xy yy] for the pixels of a span. M = I exactly where both eigenvalues of J J^T are <= 1 + 1e-6.
struct alignas(64) Footprints {
    float xx[span_length], xy[span_length], yy[span_length];
};

/// M of n pixels from (x, y) on, counted from the corner of the map's window; the displacement is scale * d.
void measure(const MapView& d, int n, int x, int y, float scale, Footprints& footprints);

/// Filters all pixels of the span into out[0 ... n). The span was prepared for Filter::Area; (x, y) is its first pixel,
/// counted from the source's corner.
void sample_area(const Source& source, const Span& span, const Footprints& footprints, int x, int y, Pixel* out);

}  // namespace eikonal::resampling
