/// The view that thin screens are laid out for, from a camera: one rule for the warp, the field's slices and the
/// tracer.
#pragma once

#include "noise/medium/shot_frame.h"
#include "warp/scene/camera.h"

namespace eikonal {

/// camera: the shot's reference camera. width, height: of its picture [px]. aperture, far [m], fps: as in ShotView.
inline ShotView screen_view(const Camera& camera, int width, int height, double aperture, double far, double fps) {
    return {camera.projection == Projection::Perspective,
            far,
            0.5 * width / camera.f_px,
            0.5 * height / (camera.f_px * camera.pixel_aspect),
            1 / camera.f_px,
            aperture,
            fps};
}

}  // namespace eikonal
