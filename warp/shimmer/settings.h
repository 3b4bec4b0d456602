/// What a user or a host asks of a shot, as plain data. Every field has the default of a setting that is left out.
///
/// A setting's name in messages is the name of its field here, between backticks.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>

#include "warp/displace/depth/depth_meeting.h"
#include "warp/displace/grid/model.h"
#include "warp/image/depth_map.h"
#include "warp/pixels/linear_image.h"

namespace eikonal {

/// Largest p95 of the displacement's error that the automatic choice of a model allows, where no tolerance is set [px].
inline constexpr double kDefaultTolerance = 0.1;

/// The footage, as far as it decides what is seen.
struct ViewSettings {
    PixelWindow display;  ///< its display window
    double pixel_aspect = 1;
    std::optional<double> fps;  ///< its own, which the scene's overrides
    std::optional<double> fov;  ///< horizontal [degrees], instead of the scene's
    /// As DisplacerSettings::overscan.
    std::function<PixelWindow()> overscan;
};

/// Flat ground below the horizon.
struct GroundSettings {
    double height = 1;      ///< of the camera above it [m]
    double horizon = 0;     ///< its row, from the display window's top
    bool fraction = false;  ///< horizon is a part of the display window's height, else pixels
};

/// Where the objects of the picture are. At most one of distance, depth, ground and given; without any of them the
/// scene's [plate] says it.
struct DepthSettings {
    std::optional<double> distance;    ///< axial, of all pixels [m]
    std::optional<std::string> depth;  ///< a file's FILE[:CHANNEL], or :CHANNEL of the frame's own picture
    std::optional<GroundSettings> ground;
    bool given = false;                   ///< the caller gives the values of each frame's pixels
    std::optional<DepthType> depth_type;  ///< of `depth` and of given values; left out: DepthType::Z
    std::optional<std::array<double, 2>> depth_range;
    std::optional<double> far;                  ///< axial distance of the background [m]
    std::optional<DepthMeeting> depth_meeting;  ///< left out: DepthMeeting::March
};

/// Which model computes the displacement.
struct ModelRequest {
    bool automatic = false;      ///< the cheapest within the tolerance
    std::optional<Model> model;  ///< for every medium that it suits; left out: each medium's default
};

/// How strong the displacement is, and how exact.
struct StrengthSettings {
    std::optional<double> rms;  ///< scale the displacement to this rms at the background [px] >= 0
    double gain = 1;            ///< multiply it, >= 0
    ModelRequest model;
    std::optional<double> tolerance;  ///< [px] > 0; implies the automatic choice unless a model is named
};

}  // namespace eikonal
