/// Lengths of the way along a straight ray to the bounds of a medium: planes, layers, spheres and cylinders.
///
/// s: coordinate of the ray's start across a plane, rate: what it gains a metre of way. `Chord` of a round body comes
/// from the vector `from` of its centre (or axis) to the start and the ray's direction, both without their part along
/// the axis for a cylinder. All finite or infinite, never NaN, for finite input; "never" is infinity.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace eikonal {

/// A way into a body or layer below this part of its size is none, so that rounding does not stop a ray before it.
inline constexpr double kTouch = 1e-9;
inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// To the plane s = 0, if it is ahead: > 0.
inline double way_to_plane(double s, double rate) {
    return (s > 0 && rate < 0) || (s < 0 && rate > 0) ? -s / rate : kNever;
}

/// To the layer low <= s <= high, high > 0; 0 within.
inline double way_into_layer(double s, double rate, double low, double high) {
    const double touch = kTouch * high;
    if (s > high + touch) return way_to_plane(s - high, rate);
    if (s < low - touch) return way_to_plane(s - low, rate);
    return 0;
}

/// Where a line enters and leaves a sphere or cylinder, measured along it from its start; never, twice, if it misses.
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

    /// To the next end ahead: > 0.
    double next() const { return enter > 0 ? enter : (leave > 0 ? leave : kNever); }
    /// To the body; 0 inside it.
    double into() const {
        if (!(leave > 0) || enter == kNever) return kNever;
        return enter > kTouch * (leave - enter) ? enter : 0;
    }
};

}  // namespace eikonal
