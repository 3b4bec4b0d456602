/// A camera at one frame, which maps pixels to rays and back; and the camera of every frame of a shot.
///
/// Conventions: pixel (x, y) has its centre at (x + 0.5, y + 0.5), y down. The camera looks along its -z axis, x is
/// right, y up; world axes are right-handed, y up, in metres. All numbers are double. Only portable arithmetic is used,
/// so that the camera of a frame has the same bits on every machine. Failures: UserError, one line that names the
/// option or file:line.
#pragma once

#include <array>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "warp/scene/scene.h"

namespace eikonal {

using glm::dvec2;

/// Position, orthonormal axes and scale. right x up = backward = -forward.
struct Camera {
    Projection projection = Projection::Perspective;
    dvec3 position{0, 0, 0};
    dvec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
    dvec2 center{0, 0};       ///< principal point in pixels (width/2, height/2)
    double f_px = 1;          ///< horizontal. perspective: focal length in pixels; orthographic: pixels per metre
    double pixel_aspect = 1;  ///< width / height of a pixel; vertical scale is f_px * pixel_aspect

    /// The straight ray of the position (px, py) [px]. Perspective: its slope, which is the point at axial depth 1
    /// relative to the camera, in camera axes (x right, y up). Orthographic: its offset from the axis in metres.
    dvec2 slope(double px, double py) const {
        return {(px - center.x) / f_px, -(py - center.y) / (f_px * pixel_aspect)};
    }
    /// Inverse of slope().
    dvec2 pixel(dvec2 s) const { return {center.x + f_px * s.x, center.y - f_px * pixel_aspect * s.y}; }
};

/// Size in pixels of a picture if neither the scene nor any footage states it.
inline constexpr std::array<int, 2> kDefaultResolution{1920, 1080};

/// {right, up, forward} of a camera at `position` that looks at a point. Nothing if the points coincide, or if `up` is
/// zero or parallel to the view (within 1e-6 rad).
std::optional<std::array<dvec3, 3>> view_axes(dvec3 position, dvec3 look_at, dvec3 up);

/// One line of a .chan file.
struct ChanKey {
    double frame;
    dvec3 position;           ///< [m]
    glm::dquat orientation;   ///< unit; turns camera axes into world axes
    double vertical_fov = 0;  ///< degrees; 0 if the line has none
};

/// Parses the lines "frame tx ty tz rx ry rz [vertical_fov]", in metres and degrees, separated by blanks. Empty lines
/// and text after a # are skipped. Frame numbers increase strictly. Either every line has a field of view or none has.
/// Rotations are in Nuke's default order ZXY: about z first (roll), then x (tilt), then y (pan), R = Ry Rx Rz on column
/// vectors. UserError "name:line: …" for a wrong line, and for a text without any key.
std::vector<ChanKey> parse_chan(std::string_view text, const std::filesystem::path& name);

/// The camera of a scene over time. It is constant, or it follows a .chan file. The file overrides position, look_at
/// and up, and its field of view, if it has one, overrides the scene's. Between keys, position and focal length change
/// linearly, and the orientation changes at constant angular speed. Before the first and after the last key the camera
/// stands still. The file is read once. The camera of frame F depends on the scene and F alone.
class CameraPath {
  public:
    /// width, height: size of the display window [px], > 0. pixel_aspect > 0. fov: horizontal field of view in degrees,
    /// which overrides every other.
    /// UserError: degenerate axes; a fov outside kSmallestFov … kLargestFov, or for an orthographic camera; a faulty
    /// .chan file.
    CameraPath(const CameraSpec& spec, int width, int height, double pixel_aspect = 1, std::optional<double> fov = {});

    Camera at(double frame) const;
    /// The camera that fixes the shot's frame of reference for thin screens: that of the first key, or the constant
    /// one.
    Camera reference() const { return keys_.empty() ? base_ : at(keys_.front().frame); }
    /// First and last frame of the .chan file. There must be such a file.
    std::array<double, 2> frames() const { return {keys_.front().frame, keys_.back().frame}; }
    /// Whether there is a .chan file.
    bool moving() const { return !keys_.empty(); }

  private:
    double f_px(const ChanKey& key) const;

    Camera base_;
    int height_;
    bool own_fov_ = false;  ///< whether the scale is always that of base_, and not that of the keys
    std::vector<ChanKey> keys_;
};

}  // namespace eikonal
