#include "warp/scene/camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "noise/base/error.h"
#include "noise/math/portable_math.h"
#include "warp/scene/text_file.h"

namespace eikonal {

namespace {

/// Focal length in units of `size` from the angle that `size` spans: size / (2 tan(fov/2)).
double focal_from_fov(double size, double fov_degrees) {
    return 0.5 * size / portable::tan(fov_degrees * (portable::kPi / 360));
}

/// Scale of the camera as the scene states it. Perspective: focal length in pixels. Orthographic: pixels per metre.
double scale_of(const CameraSpec& spec, int width, std::optional<double> fov) {
    if (spec.projection == Projection::Orthographic) return width / spec.width;
    if (!fov && spec.focal_length) return width * *spec.focal_length / spec.sensor_width.value_or(kDefaultSensorWidth);
    return focal_from_fov(width, fov ? *fov : spec.horizontal_fov.value_or(kDefaultHorizontalFov));
}

/// Interpolates unit quaternions at constant angular speed along the shorter arc; t in [0, 1]. It bisects the arc,
/// since the middle of an arc needs only a normalised sum. After kHalvings the remaining arc is straight to double
/// precision.
glm::dquat slerp(glm::dquat a, glm::dquat b, double t) {
    constexpr int kHalvings = 20;
    if (glm::dot(a, b) < 0) b = -b;
    for (int i = 0; i < kHalvings; ++i) {
        const glm::dquat middle = glm::normalize(a + b);
        t *= 2;
        if (t < 1) {
            b = middle;
        } else {
            a = middle;
            t -= 1;
        }
    }
    return glm::normalize(a * (1 - t) + b * t);
}

}  // namespace

std::optional<std::array<dvec3, 3>> view_axes(dvec3 position, dvec3 look_at, dvec3 up) {
    constexpr double kParallel = 1e-6;
    const double distance = glm::length(look_at - position), up_length = glm::length(up);
    if (!(distance > 0) || !(up_length > 0)) return {};
    const dvec3 forward = (look_at - position) / distance;
    const dvec3 right = glm::cross(forward, up / up_length);
    const double sine = glm::length(right);
    if (!(sine > kParallel)) return {};
    return std::array<dvec3, 3>{right / sine, glm::cross(right / sine, forward), forward};
}

CameraPath::CameraPath(const CameraSpec& spec, int width, int height, double pixel_aspect, std::optional<double> fov)
    : height_(height), own_fov_(fov || spec.projection == Projection::Orthographic) {
    if (fov && spec.projection == Projection::Orthographic)
        throw UserError("`fov`: an orthographic camera has no field of view; set camera.width");
    if (fov && !(*fov >= kSmallestFov && *fov <= kLargestFov))
        throw UserError(
            fmt::format("`fov`: value {}, must be >= {} and <= {} degrees", *fov, kSmallestFov, kLargestFov));
    const auto axes = view_axes(spec.position, spec.look_at, spec.up);
    if (!axes) throw UserError("camera: look_at must differ from position, and up must not be parallel to the view");

    base_.projection = spec.projection;
    base_.position = spec.position;
    base_.right = (*axes)[0];
    base_.up = (*axes)[1];
    base_.forward = (*axes)[2];
    base_.center = {0.5 * width, 0.5 * height};
    base_.pixel_aspect = pixel_aspect;
    base_.f_px = scale_of(spec, width, fov);
    if (spec.path) keys_ = parse_chan(scene_file::read_text(*spec.path, "camera path"), *spec.path);
}

double CameraPath::f_px(const ChanKey& key) const {
    if (own_fov_ || key.vertical_fov == 0) return base_.f_px;
    return focal_from_fov(height_, key.vertical_fov) / base_.pixel_aspect;
}

Camera CameraPath::at(double frame) const {
    if (keys_.empty()) return base_;
    const auto after =
        std::upper_bound(keys_.begin(), keys_.end(), frame, [](double f, const ChanKey& key) { return f < key.frame; });
    const ChanKey& b = after == keys_.end() ? keys_.back() : *after;
    const ChanKey& a = after == keys_.begin() ? b : *(after - 1);
    const double t = b.frame > a.frame ? (frame - a.frame) / (b.frame - a.frame) : 0;

    Camera camera = base_;
    camera.position = a.position * (1 - t) + b.position * t;
    camera.f_px = f_px(a) * (1 - t) + f_px(b) * t;
    const glm::dmat3 axes = glm::mat3_cast(t == 0 ? a.orientation : slerp(a.orientation, b.orientation, t));
    camera.right = axes[0];
    camera.up = axes[1];
    camera.forward = -axes[2];
    return camera;
}

}  // namespace eikonal
