/// Surfaces, cameras and their mirages for tests.
#pragma once

#include "noise/medium/optics.h"
#include "noise/surface/surface_spec.h"
#include "warp/displace/media/surface/mirage.h"

namespace eikonal {

inline SurfaceSpec surface(double temperature, double d0) {
    SurfaceSpec spec;
    spec.surface_temperature = temperature;
    spec.dropoff = d0;
    return spec;
}

inline Mirage mirage_of(const SurfaceSpec& spec, const Camera& camera, double farthest = 5000, double exaggeration = 1,
                        RayEquation equation = RayEquation::Physical) {
    return {spec, index_law({}), exaggeration, equation, camera, farthest, "medium.3"};
}

/// A camera that looks along -z from a height [m].
inline Camera level(double height, double f_px, int width = 640, int rows = 360) {
    Camera camera;
    camera.position = {0, height, 0};
    camera.center = {width / 2.0, rows / 2.0};
    camera.f_px = f_px;
    return camera;
}

}  // namespace eikonal
