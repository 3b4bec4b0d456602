/// What media may know of the shot that they are built for: the position of its camera, and its view.
#pragma once

#include <glm/vec3.hpp>

namespace eikonal {

using glm::dvec3;

/// The view that thin screens must serve.
struct ShotView {
    bool perspective = true;
    double far = 100;                            ///< path length D along the axis [m] > 0
    double half_width = 0.3, half_height = 0.2;  ///< largest slope (perspective), or metres (orthographic)
    double pixel = 1e-3;                         ///< size of a pixel: slope 1/f_px (perspective), or metres > 0
    double aperture = 0;                         ///< A [m] >= 0
    double fps = 24;                             ///< > 0
};

/// The position of thin screens: planes across `forward`, at distances from `origin`. right, up, forward: orthonormal.
struct ShotFrame {
    dvec3 origin{0, 0, 0}, right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
    ShotView view;
};

}  // namespace eikonal
