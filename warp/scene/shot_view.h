/// The view of a shot that media are built for, from its reference camera. The warp, the slices of a field and the
/// tracer all use this rule.
#pragma once

#include "noise/medium/shot_frame.h"
#include "warp/scene/camera.h"

namespace eikonal {

/// camera: the shot's reference camera. width, height: size of its picture [px]. aperture, far [m], fps: as in
/// ShotView.
inline ShotView shot_view(const Camera& camera, int width, int height, double aperture, double far, double fps) {
    return {camera.projection == Projection::Perspective,
            far,
            0.5 * width / camera.f_px,
            0.5 * height / (camera.f_px * camera.pixel_aspect),
            1 / camera.f_px,
            aperture,
            fps};
}

/// The same, with the position and axes of the camera.
inline ShotFrame shot_frame(const Camera& camera, int width, int height, double aperture, double far, double fps) {
    return {camera.position, camera.right, camera.up, camera.forward,
            shot_view(camera, width, height, aperture, far, fps)};
}

}  // namespace eikonal
