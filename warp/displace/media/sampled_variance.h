/// How strong a medium is, estimated from the displacement of rays spread over the picture and over time.
#pragma once

#include "warp/displace/media/medium_bend.h"

namespace eikonal {

/// Rays that the expected rms and focusing of media without a closed form are estimated from, fewer where they are
/// long.
inline constexpr int kRmsRays = 256;

struct SampledVariance {
    double shift = 0;  ///< of |d| [px²]
    double slope = 0;  ///< of ∂d_x/∂x and ∂d_y/∂y, pixel to pixel
};

/// Of rays spread over the picture and their neighbours one pixel to the right or below, by turns, each at its own
/// instant, for objects at axial distance D. steps: of one ray, about.
SampledVariance sampled_variance(const ShotContext& shot, const MediumBend& bend, double D, double steps);

/// Pixel i of many that keep apart, however many there are.
std::array<int, 2> spread_pixel(int i, int width, int height);

/// d of a pixel for an object at D, and how it changes to the next one, to the right or below.
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
