/// What a displacement map is off by, found without a tracer: some of its pixels are worked out again by the best means
/// there are, and the differences are the map's stated error.
///
/// kErrorCandidates pixels, spread evenly over the map, are sorted into kDepthStrata by depth and within these by
/// displacement; every so many of them is a sample, so that samples stand for equal parts of the map, near and far,
/// still and strongly moved. Pixels beside an edge of the depth buffer, within kEdgeReach or their own displacement,
/// are no candidates, unless there is hardly anything else: what is seen there is a matter of which surface a ray
/// meets, not of the air, and where edges take near a twentieth of the picture, they alone would make its 95th
/// percentile. Each sample's own ray goes through the sum of all media, surfaces included, as second-order's nodes do
/// but without interpolation between nodes (bent_pixel), and meets the depth buffer in the same way as the map, but
/// where depth is smooth the surface through its pixels and no facet (meet_smooth_surface). *added*
///
/// Where a ray ends on a heated surface and the depth buffer has a hole, it is followed through the plane, as the
/// tracer follows it: a map ends it there.
///
/// First and second order and their judge go through the same splines of a lattice; what those are off by is drawn for
/// each sample from what is expected (AirInstant::interpolation).
///
/// So the figure holds the model's own approximations: the order of the perturbation, tables, nodes, depths between
/// layers and between pixels, and how media act on each other. It does not hold what no map can mend: that a plate does
/// not show what its own foreground hides, and moves as one with it beside an edge. Compare it with the true error on
/// smooth depth.
///
/// The same figure for any number of threads.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "warp/displace/displacer.h"

namespace eikonal {

inline constexpr int kErrorCandidates = 2048, kDepthStrata = 8;
/// Samples of a map: one for so many of its pixels, at most kErrorSamples; half as many where there are blobs, among
/// which a ray takes several times as long; but never fewer than the fewest.
inline constexpr int kPixelsPerSample = 2048, kErrorSamples = 256, kFewestErrorSamples = 64;
/// Pixels as near to an edge [px], or as near as they are moved, up to kFarthestEdge, are beside it.
inline constexpr int kEdgeReach = 3, kFarthestEdge = 32;

/// Pixels that stand for the map: absolute coordinates, in a fixed order.
struct SamplePixel {
    int x, y;
    double depth;  ///< [m]
    Shift map;     ///< the map's displacement there
};
/// `count` of them, at most kErrorCandidates. Depths come from a plane that holds the window.
std::vector<SamplePixel> choose_samples(const PixelWindow& window, const DepthSource& depth, const float* uv,
                                        int count);

/// |map - truth(pixel)| of every sample [px]. In parallel.
std::vector<double> sample_errors(const std::vector<SamplePixel>& samples,
                                  const std::function<Shift(const SamplePixel&)>& truth);

/// "0.12 px", or what stands for an infinite error.
std::string shown_error(double px);

/// Nearest-rank percentiles of at least one error.
StatedError statistics_of(std::vector<double> errors);

}  // namespace eikonal
