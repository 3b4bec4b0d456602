#include "reference/trace/camera_ray.h"

#include <glm/geometric.hpp>

namespace eikonal::reference {

CameraRay camera_ray(const Camera& camera, double px, double py) {
    const dvec2 s = camera.slope(px, py);
    const dvec3 across = s.x * camera.right + s.y * camera.up;
    if (camera.projection == Projection::Orthographic) return {camera.position + across, camera.forward};
    return {camera.position, camera.forward + across};
}

Bundle pixel_bundle(const Camera& camera, double px, double py) {
    const dvec3 right = camera.right / camera.f_px, down = -camera.up / (camera.f_px * camera.pixel_aspect);
    if (camera.projection == Projection::Orthographic) return {Differential{right, {}}, Differential{down, {}}};
    const dvec3 d = camera_ray(camera, px, py).direction;
    const double length = glm::length(d);
    const dvec3 unit = d / length;
    const auto turn = [&](const dvec3& change) { return (change - glm::dot(change, unit) * unit) / length; };
    return {Differential{{}, turn(right)}, Differential{{}, turn(down)}};
}

}  // namespace eikonal::reference
