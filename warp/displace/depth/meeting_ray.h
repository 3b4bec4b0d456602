/// The bent ray of one pixel on its way to the depth buffer, and the steps that all methods of depth meeting share.
///
/// A ray is a path s(z) = pixel + d(z) over the picture, where d(z) is the pixel's displacement for an object at axial
/// depth z. Displacements are in pixels, depths in metres.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "warp/displace/depth/depth_plane.h"
#include "warp/displace/grid/displacement_grid.h"

namespace eikonal {

/// A ray is followed in steps of at most kMarchStep. A point where it is blocked is known to kMarchError [px].
inline constexpr float kMarchStep = 0.5f, kMarchError = 0.001f;
/// Largest number of steps of a ray, which then ends. No plausible air needs as many.
inline constexpr int kMostMarchSteps = 1024;

/// v rounded down. What is far beyond any picture becomes a number that an int holds.
inline int floor_pixel(float v) {
    constexpr float kMost = 1e6f;
    return static_cast<int>(std::floor(v > -kMost ? (v < kMost ? v : kMost) : -kMost));
}
/// The pixel whose centre is nearest to v, where pixel i has its centre at i.
inline int nearest_pixel(float v) {
    return floor_pixel(v + 0.5f);
}
inline bool same_pixel(Shift a, Shift b) {
    return nearest_pixel(a.x) == nearest_pixel(b.x) && nearest_pixel(a.y) == nearest_pixel(b.y);
}
/// Largest component of a - b.
inline float distance_between(Shift a, Shift b) {
    return std::max(std::abs(a.x - b.x), std::abs(a.y - b.y));
}
inline float length_of(Shift d) {
    return std::sqrt(d.x * d.x + d.y * d.y);
}

/// The pixels around a place that bilinear filtering reads. These are four; two if the place is on the line between two
/// centres, and one if it is at a centre.
struct PixelsAround {
    int x0, y0, x1, y1;  ///< first and last, each included

    PixelsAround(int x, int y, Shift d) : x0(x + floor_pixel(d.x)), y0(y + floor_pixel(d.y)) {
        x1 = x0 + (d.x != std::floor(d.x) ? 1 : 0);
        y1 = y0 + (d.y != std::floor(d.y) ? 1 : 0);
    }
};

/// The ray of one pixel, and the depth buffer that it meets.
struct MeetingRay {
    GridRows& rows;
    const DepthPlane& depth;
    int x, y;     ///< the pixel
    float front;  ///< no front() near the ray is nearer than this

    Shift at(double z) const { return rows.at(x, z); }
    float depth_at(Shift d) const { return depth.at(x + nearest_pixel(d.x), y + nearest_pixel(d.y)); }
    /// Depth where the ray stops at the latest if it is at pixel + d then. This is the facet's depth. If a foreground
    /// stands out before one of the four pixels that the picture is read from there, it is the foreground's.
    float stop(Shift d) const {
        const float facet = depth_at(d), limit = kEdgeRatio * facet;
        if (limit <= front) return facet;
        const PixelsAround around(x, y, d);
        float nearest = std::numeric_limits<float>::infinity();
        for (int j = around.y0; j <= around.y1; ++j)
            for (int i = around.x0; i <= around.x1; ++i) nearest = std::min(nearest, depth.front(i, j));
        return nearest < limit ? nearest : facet;
    }
    bool blocked(Shift d, double z) const { return stop(d) <= static_cast<float>(z); }
};

/// The last clear point of a ray between depth z_clear, where it is at d_clear, and z_blocked, where it is blocked at
/// d_blocked. Ray: MeetingRay, or anything with the same at() and blocked().
template <class Ray>
Shift last_clear_point(const Ray& ray, double z_clear, Shift d_clear, double z_blocked, Shift d_blocked) {
    constexpr int kMostHalvings = 32;
    for (int i = 0; i < kMostHalvings && distance_between(d_clear, d_blocked) > kMarchError; ++i) {
        const double middle = 0.5 * (z_clear + z_blocked);
        const Shift d = ray.at(middle);
        if (ray.blocked(d, middle)) {
            z_blocked = middle;
            d_blocked = d;
        } else {
            z_clear = middle;
            d_clear = d;
        }
    }
    return d_clear;
}

}  // namespace eikonal
