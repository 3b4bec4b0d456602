/// The strength of a medium, estimated from the displacement of rays spread over the picture and over time.
#pragma once

#include "warp/displace/media/medium_bend.h"

namespace eikonal {

/// Number of rays from which the expected rms and focusing are estimated, for media without a closed form. Fewer rays
/// are used if each takes many steps.
inline constexpr int kRmsRays = 256;

struct SampledVariance {
    double shift = 0;  ///< variance of |d| [px²]
    double slope = 0;  ///< variance of ∂d_x/∂x and ∂d_y/∂y, from pixel to pixel
};

/// Estimates both for objects at axial distance D [m]. Rays are spread over the picture, each at its own instant. Each
/// is compared with its neighbour one pixel to the right or below, by turns. steps: approximate number of steps of one
/// ray.
SampledVariance sampled_variance(const ShotContext& shot, const MediumBend& bend, double D, double steps);

/// Pixel i of a sequence of pixels that keep apart from each other, however many are taken.
std::array<int, 2> spread_pixel(int i, int width, int height);

/// d of a pixel for an object at D, and its change to the next pixel to the right or below.
struct PixelPair {
    PixelWindow window;

    PixelPair(int x, int y, bool across) : window{x, y, across ? 2 : 1, across ? 1 : 2} {}
    struct Shifts {
        Shift d;
        double slope;
    };
    Shifts shifts(const std::vector<DisplacementGrid>& grids, double D) const;
};

}  // namespace eikonal
