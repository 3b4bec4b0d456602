/// Where a bent ray meets the depth buffer (PHYSICS 7), one row at a time.
///
/// Three ways, dearest first:
///  - March: follow the screen path s(z) = pixel + d(z) from near to far until the depth buffer there is nearer than z.
///    The ray stops *before* it would pass in front of something nearer, so a background never drags a foreground
///    along: what lies hidden behind an edge is not in the plate, and the last visible point before the edge stands in.
///  - FixedPoint: iterate D <- depth(s(D)) from the pixel's own depth, kFixedPointSteps times.
///  - Own: D = the pixel's own depth.
///
/// Depth is read at the pixel nearest to s, never filtered: a depth between foreground and background exists nowhere.
#pragma once

#include <vector>

#include "warp/displace/band.h"

namespace eikonal {

enum class DepthMeeting { March, FixedPoint, Own };

inline constexpr int kFixedPointSteps = 8;
/// Once all depths around a pixel displace it alike within this many pixels, they are not told apart.
inline constexpr float kAlike = 1.0f / 512;
/// A neighbour nearer than this part of the ray's depth is an edge to stay clear of, not a slope.
inline constexpr float kEdgeRatio = 0.5f;

/// Axial depth of every pixel of a window, in metres, positive and finite; with block extrema for the march.
class DepthPlane {
  public:
    /// metres: window.area() values.
    DepthPlane(const PixelWindow& window, std::vector<float> metres);

    const PixelWindow& window() const { return window_; }
    /// Nearest pixel's depth; outside the window its nearest edge pixel's.
    float at(int x, int y) const;
    float nearest() const { return nearest_; }
    float farthest() const { return farthest_; }
    struct Range {
        float nearest, farthest;
    };
    /// Extrema over at least the pixels within `reach` of (x, y), in steps of blocks.
    Range around(int x, int y, int reach) const;

  private:
    PixelWindow window_;
    std::vector<float> metres_;
    std::vector<Range> blocks_;
    int block_columns_ = 0, block_rows_ = 0;
    float nearest_ = 0, farthest_ = 0;
};

/// Displacement of the pixels x0 … x0 + n - 1 of row y into interleaved (u, v). `reach`: bound of |d| in pixels for
/// these rows (rounded up), from Band::largest_shift.
void meet_row(BandRows& row, int x0, int n, int y, const DepthPlane& depth, DepthMeeting how, int reach, float* uv);

}  // namespace eikonal
