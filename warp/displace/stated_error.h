/// The error of a displacement map, found without a tracer. Some pixels of the map are computed again as exactly as
/// possible. The differences are the map's stated error. *added*
///
/// Choice of pixels. kErrorCandidates pixels are spread evenly over the map. They are sorted by depth into kDepthStrata
/// classes, and within each class by displacement. Samples are taken from this order at equal steps. Each sample
/// therefore stands for an equal part of the map, and all depths and displacements are represented. Pixels beside an
/// edge of the depth buffer, within kEdgeReach or their own displacement, are left out unless there are hardly any
/// others. What they show depends on which object a ray reaches, and not on the air. Where edges cover about a
/// twentieth of the picture, these pixels alone would determine the 95th percentile.
///
/// Truth. The ray of a sample goes through the sum of all media, surfaces included. It is followed as in second-order,
/// but without interpolation between nodes (bent_pixel). The depth at which it reaches the depth buffer is found in the
/// same way as for the map. Where depth is smooth, the ray is intersected with a smooth surface through the pixels
/// instead of facets (meet_smooth_surface). Where a ray ends on a heated surface and the depth buffer has a hole, it
/// goes on through the surface, as the tracer's ray does; in a map the ray ends there. First-order, second-order and
/// this truth all read a lattice through the same splines. The error of the splines is therefore drawn for each sample
/// from its expected distribution (AirInstant::interpolation).
///
/// What the error contains: the order of the perturbation, tables, nodes, interpolation between depths and between
/// pixels, and the effect of one medium on the rays through another. It does not contain two faults that no map can
/// avoid. A picture does not show what its own foreground hides, and the pixels beside an edge move together with the
/// foreground. On smooth depth the stated error can be compared with the true error.
///
/// The result is the same for any number of threads.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "warp/displace/depth/depth_source.h"
#include "warp/displace/grid/shift.h"
#include "warp/pixels/linear_image.h"

namespace eikonal {

inline constexpr int kErrorCandidates = 2048, kDepthStrata = 8;
/// A map has one sample for every kPixelsPerSample pixels, but at most kErrorSamples. With blobs it has half as many,
/// because a ray among blobs takes several times as long. It has at least kFewestErrorSamples.
inline constexpr int kPixelsPerSample = 2048, kErrorSamples = 256, kFewestErrorSamples = 64;
/// A pixel is beside an edge if the edge is within kEdgeReach [px], or within the pixel's displacement up to
/// kFarthestEdge [px].
inline constexpr int kEdgeReach = 3, kFarthestEdge = 32;

/// Statistics of the error of a map, from its samples [px]. Infinite where the rays that judge the map are lost.
struct StatedError {
    int samples = 0;
    double p50 = 0, p95 = 0, largest = 0;  ///< 50th and 95th percentile, and the largest error
};

/// A pixel of a map whose error stands for that of others.
struct SamplePixel {
    int x, y;      ///< pixel of the picture
    double depth;  ///< axial [m]
    Shift map;     ///< its displacement in the map [px]
};
/// Chooses `count` samples, at most kErrorCandidates, in an order that depends on the arguments alone. uv: the map of
/// the window. A depth plane must cover the window.
std::vector<SamplePixel> choose_samples(const PixelWindow& window, const DepthSource& depth, const float* uv,
                                        int count);

/// |map - truth(pixel)| of every sample [px]. Calls `truth` from several threads.
std::vector<double> sample_errors(const std::vector<SamplePixel>& samples,
                                  const std::function<Shift(const SamplePixel&)>& truth);

/// An error as text for messages: "0.12 px", or words if it is infinite.
std::string shown_error(double px);

/// Percentiles by nearest rank, of at least one error.
StatedError statistics_of(std::vector<double> errors);

}  // namespace eikonal
