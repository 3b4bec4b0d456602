/// What media may know of the shot they are built for: where its camera stands, and what it sees.
#pragma once

#include <glm/vec3.hpp>

namespace eikonal {

using glm::dvec3;

/// What the screens must serve.
struct ShotView {
    bool perspective = true;
    double far = 100;                            ///< path length D along the axis [m] > 0
    double half_width = 0.3, half_height = 0.2;  ///< largest slope (perspective), or metres (orthographic)
    double pixel = 1e-3;                         ///< slope of a pixel 1/f_px (perspective), or metres a pixel > 0
    double aperture = 0;                         ///< A [m] >= 0
    double fps = 24;                             ///< > 0
};

/// Where thin screens stand: planes across `forward`, at distances from `origin`. right, up, forward: orthonormal.
struct ShotFrame {
    dvec3 origin{0, 0, 0}, right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
    ShotView view;
};

}  // namespace eikonal
