/// What a displacement map is off by, found without a tracer: some of its pixels are worked out again by the best means
/// there are, and the differences are the map's stated error.
///
/// kErrorCandidates pixels, spread evenly over the map, are sorted into kDepthStrata by depth and within these by
/// displacement; every so many of them is a sample, so that samples stand for equal parts of the map, near and far,
/// still and strongly moved. Each sample's own ray goes through the sum of all media, surfaces included, as
/// second-order's nodes do but without interpolation between nodes (bent_pixel), and meets the depth buffer in the
/// same way as the map. *added*
///
/// So the figure holds the model's own approximations: the order of the perturbation, tables, nodes, depths between
/// layers, and how media act on each other. It does not hold what no map can mend: that a plate does not show what its
/// own foreground hides.
///
/// The same figure for any number of threads.
#pragma once

#include <functional>
#include <vector>

#include "warp/displace/displacer.h"

namespace eikonal {

inline constexpr int kErrorCandidates = 4096, kDepthStrata = 8;
/// Samples of a map: one for so many of its pixels, within these bounds.
inline constexpr int kPixelsPerSample = 1024, kFewestErrorSamples = 64, kErrorSamples = 256;

/// Pixels that stand for the map: absolute coordinates, in a fixed order.
struct SamplePixel {
    int x, y;
    double depth;  ///< [m]
    Shift map;     ///< the map's displacement there
};
/// `count` of them, at most kErrorCandidates.
std::vector<SamplePixel> choose_samples(const PixelWindow& window, const DepthSource& depth, const float* uv,
                                        int count);

/// |map - truth(pixel)| of every sample [px]. In parallel.
std::vector<double> sample_errors(const std::vector<SamplePixel>& samples,
                                  const std::function<Shift(const SamplePixel&)>& truth);

/// Nearest-rank percentiles of at least one error.
StatedError statistics_of(std::vector<double> errors);

}  // namespace eikonal
