/// The straight rays of one frame, parametrised by axial depth, and the displacement in pixels by a bend of them.
///
/// Ray of pixel position p: P(z) = origin(p) + z direction(p), where z is the depth along the camera's axis [m] and
/// |direction| = L >= 1 metres of ray a metre of depth (perspective), L = 1 (orthographic).
/// A bend x1 [m] at depth z moves the image by X/z (perspective) or X (orthographic), to first order in x1, with
///     X = f_px (x1·right - s_x x1·forward,  -(x1·up - s_y x1·forward) · pixel aspect),   s = slope of p
/// (orthographic: without the s terms). The part of a bend along the ray itself is never visible.
/// Theory: PHYSICS.md#slanted-rays.
#pragma once

#include <glm/geometric.hpp>

#include "warp/scene/camera.h"

namespace eikonal {

struct StraightRay {
    dvec3 origin, direction;
    double length = 1;  ///< |direction| = L
    dvec2 slope{0, 0};  ///< perspective; zero for orthographic

    dvec3 at(double z) const { return origin + z * direction; }
};

/// px, py: continuous pixel coordinates; the centre of pixel (x, y) is (x + 0.5, y + 0.5).
inline StraightRay straight_ray(const Camera& camera, double px, double py) {
    const dvec2 s = camera.slope(px, py);
    const dvec3 across = s.x * camera.right + s.y * camera.up;
    if (camera.projection == Projection::Orthographic) return {camera.position + across, camera.forward, 1, {0, 0}};
    const dvec3 direction = camera.forward + across;
    return {camera.position, direction, std::sqrt(1 + s.x * s.x + s.y * s.y), s};
}

/// X of a bend, in pixels times metres (perspective) or pixels (orthographic).
inline dvec2 image_shift(const Camera& camera, const StraightRay& ray, const dvec3& x1) {
    const double along = glm::dot(x1, camera.forward);
    return {camera.f_px * (glm::dot(x1, camera.right) - ray.slope.x * along),
            -camera.f_px * camera.pixel_aspect * (glm::dot(x1, camera.up) - ray.slope.y * along)};
}

}  // namespace eikonal
