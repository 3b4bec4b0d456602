/// The rays that a camera sends through the points of its picture.
#pragma once

#include "reference/trace/ray_differential.h"
#include "warp/scene/camera.h"

namespace eikonal::reference {

/// The straight ray of a pixel position: origin and direction. The direction is not of unit length. Its axial component
/// is 1, so that a distance along it is an axial depth.
struct CameraRay {
    dvec3 origin, direction;
};
CameraRay camera_ray(const Camera& camera, double px, double py);

/// How the ray of camera_ray changes from one pixel to the next: its origin, and its unit direction.
Bundle pixel_bundle(const Camera& camera, double px, double py);

}  // namespace eikonal::reference
