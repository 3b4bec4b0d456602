/// The settings of a shot, as a user or a host program states them. They are plain data. Every field has the default of
/// a setting that is left out.
///
/// Messages name a setting by the name of its field here, between backticks.
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

/// Default tolerance [px]: the largest p95 of the displacement's error that the automatic choice of a model allows.
inline constexpr double kDefaultTolerance = 0.1;

/// The properties of the footage that decide what is seen.
struct ViewSettings {
    PixelWindow display;  ///< its display window
    double pixel_aspect = 1;
    std::optional<double> fps;  ///< frame rate of the footage, which the scene's overrides
    std::optional<double> fov;  ///< horizontal field of view [degrees], which overrides the scene's
    /// As DisplacerSettings::overscan.
    std::function<PixelWindow()> overscan;
};

/// Flat ground below the horizon.
struct GroundSettings {
    double height = 1;      ///< height of the camera above it [m]
    double horizon = 0;     ///< row of the horizon, from the top of the display window
    bool fraction = false;  ///< whether horizon is a part of the display window's height; else it is in pixels
};

/// The depth of the picture's objects. At most one of distance, depth, ground and given is set. Without any of them the
/// scene's [plate] states it.
struct DepthSettings {
    std::optional<double> distance;    ///< one axial distance of all pixels [m]
    std::optional<std::string> depth;  ///< FILE[:CHANNEL] of a depth map, or :CHANNEL of the frame's own picture
    std::optional<GroundSettings> ground;
    bool given = false;                   ///< whether the caller gives a value for each pixel of each frame
    std::optional<DepthType> depth_type;  ///< kind of the values of `depth` or `given`; if left out: DepthType::Z
    std::optional<std::array<double, 2>> depth_range;
    std::optional<double> far;                  ///< axial distance of the background [m]
    std::optional<DepthMeeting> depth_meeting;  ///< if left out: DepthMeeting::March
};

/// The model that computes the displacement.
struct ModelRequest {
    bool automatic = false;      ///< take the cheapest model within the tolerance
    std::optional<Model> model;  ///< used for every medium that it suits; if left out: each medium's default
};

/// The strength and the accuracy of the displacement.
struct StrengthSettings {
    std::optional<double> rms;  ///< scale the displacement to this rms at the background [px] >= 0
    double gain = 1;            ///< factor on the displacement, >= 0
    ModelRequest model;
    std::optional<double> tolerance;  ///< allowed error [px] > 0; implies the automatic choice unless a model is named
};

}  // namespace eikonal
