/// The error of a displacement map, found without a tracer. Some pixels of the map are worked out again by the best
/// means there are, and the differences are the map's stated error. *added*
///
/// Choice of pixels. kErrorCandidates pixels are spread evenly over the map. They are sorted into kDepthStrata classes
/// by depth, and within these by displacement; samples are taken from this order at equal steps. So samples stand for
/// equal parts of the map, near and far, little and much displaced. Pixels beside an edge of the depth buffer, within
/// kEdgeReach or their own displacement, are left out unless there are hardly any others. What is seen there depends on
/// which surface a ray meets, and not on the air; where edges take about a twentieth of the picture, they alone would
/// set the 95th percentile.
///
/// Truth. The ray of a sample goes through the sum of all media, surfaces included, as the rays of second-order do but
/// without interpolation between nodes (bent_pixel). It meets the depth buffer in the same way as the map does. Where
/// depth is smooth it meets the surface through the pixels instead of facets (meet_smooth_surface). Where a ray ends on
/// a heated surface and the depth buffer has a hole, it goes on through the surface, as the tracer's does; a map ends
/// it there. First-order, second-order and this truth all read a lattice through the same splines. The error of these
/// is drawn for each sample from its expected distribution (AirInstant::interpolation).
///
/// What the error contains: the order of the perturbation, tables, nodes, interpolation between depths and between
/// pixels, and how media act on each other. It does not contain what no map can mend: that a picture does not show what
/// its own foreground hides, and that the pixels beside an edge move as one with the foreground. Compare it with the
/// true error on smooth depth.
///
/// The figure is the same for any number of threads.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "warp/displace/depth/depth_source.h"
#include "warp/displace/grid/shift.h"
#include "warp/pixels/linear_image.h"

namespace eikonal {

inline constexpr int kErrorCandidates = 2048, kDepthStrata = 8;
/// A map has one sample for so many of its pixels, at most kErrorSamples. Where there are blobs, among which a ray
/// takes several times as long, it has half as many. It never has fewer than kFewestErrorSamples.
inline constexpr int kPixelsPerSample = 2048, kErrorSamples = 256, kFewestErrorSamples = 64;
/// A pixel is beside an edge if the edge is within kEdgeReach [px], or within the pixel's displacement up to
/// kFarthestEdge [px].
inline constexpr int kEdgeReach = 3, kFarthestEdge = 32;

/// The error of a map, by its samples [px]. Infinite where the rays that would tell are lost.
struct StatedError {
    int samples = 0;
    double p50 = 0, p95 = 0, largest = 0;  ///< percentiles, and the greatest error
};

/// A pixel of a map that stands for others.
struct SamplePixel {
    int x, y;      ///< absolute
    double depth;  ///< axial [m]
    Shift map;     ///< displacement by the map
};
/// Chooses `count` samples, at most kErrorCandidates, in an order that depends on the arguments alone. uv: the map of
/// the window. A depth plane must hold the window.
std::vector<SamplePixel> choose_samples(const PixelWindow& window, const DepthSource& depth, const float* uv,
                                        int count);

/// |map - truth(pixel)| of every sample [px]. Calls `truth` from several threads.
std::vector<double> sample_errors(const std::vector<SamplePixel>& samples,
                                  const std::function<Shift(const SamplePixel&)>& truth);

/// An error for messages: "0.12 px", or words for an infinite one.
std::string shown_error(double px);

/// Nearest-rank percentiles of one error or more.
StatedError statistics_of(std::vector<double> errors);

}  // namespace eikonal
