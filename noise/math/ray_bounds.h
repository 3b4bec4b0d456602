/// Distances along a straight ray to the bounds of a medium: planes, layers, spheres and cylinders.
///
/// A plane or layer sees the ray as its start's coordinate s across the plane, and the rate at which s grows a metre of
/// way. A round body sees it as the vector `from` from the body's centre (or axis) to the start, and the direction. For
/// a cylinder neither vector has a component along the axis. Finite input gives finite results or infinity, never NaN.
/// Infinity (kNever) means that the ray never gets there.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace eikonal {

/// A way into a body or layer that is shorter than this part of its size counts as zero. Without it, rounding could
/// stop a ray just before the body for ever.
inline constexpr double kTouch = 1e-9;
inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// Way to the plane s = 0 if it lies ahead (> 0), else kNever.
inline double way_to_plane(double s, double rate) {
    return (s > 0 && rate < 0) || (s < 0 && rate > 0) ? -s / rate : kNever;
}

/// Way to the layer low <= s <= high, high > 0. Zero within.
inline double way_into_layer(double s, double rate, double low, double high) {
    const double touch = kTouch * high;
    if (s > high + touch) return way_to_plane(s - high, rate);
    if (s < low - touch) return way_to_plane(s - low, rate);
    return 0;
}

/// Where a line enters and leaves a sphere or cylinder, measured from the line's start. Both are kNever if it misses.
struct Chord {
    double enter = kNever, leave = kNever;

    Chord(const glm::dvec3& from, const glm::dvec3& direction, double radius) {
        const double d2 = glm::dot(direction, direction);
        if (!(d2 > 0)) return;
        const double closest = -glm::dot(from, direction) / d2;
        const glm::dvec3 b = from + closest * direction;
        const double half2 = (radius * radius - glm::dot(b, b)) / d2;
        if (!(half2 > 0)) return;
        const double half = std::sqrt(half2);
        enter = closest - half;
        leave = closest + half;
    }

    /// Way to the next of the two ends that lies ahead (> 0), else kNever.
    double next() const { return enter > 0 ? enter : (leave > 0 ? leave : kNever); }
    /// Way to the body. Zero inside it.
    double into() const {
        if (!(leave > 0) || enter == kNever) return kNever;
        return enter > kTouch * (leave - enter) ? enter : 0;
    }
};

}  // namespace eikonal
