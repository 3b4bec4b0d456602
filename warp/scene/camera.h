/// A camera at one frame: pixels to rays and back; and the camera of every frame of a shot.
///
/// Conventions: pixel (x, y) has its centre at (x + 0.5, y + 0.5), y down. The camera looks along its -z axis, x is
/// right, y up; world axes are right-handed, y up, metres. All double; only portable arithmetic, so that a frame's
/// camera is the same bits everywhere. Failures: UserError, one line that names the option or file:line.
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
    double f_px = 1;          ///< perspective: focal length in pixels; orthographic: pixels per metre. Horizontal.
    double pixel_aspect = 1;  ///< width / height of a pixel; vertical scale is f_px * pixel_aspect

    /// Perspective: the point at axial depth 1 that the position (px, py) in pixels looks at, relative to the
    /// camera, in camera axes (x right, y up): the ray's slope. Orthographic: the offset in metres.
    dvec2 slope(double px, double py) const {
        return {(px - center.x) / f_px, -(py - center.y) / (f_px * pixel_aspect)};
    }
    /// Inverse of slope().
    dvec2 pixel(dvec2 s) const { return {center.x + f_px * s.x, center.y - f_px * pixel_aspect * s.y}; }
};

/// Pixels of a picture whose size neither the scene nor any footage states.
inline constexpr std::array<int, 2> kDefaultResolution{1920, 1080};

/// {right, up, forward} of a camera at `position` that looks at a point; nothing if the points coincide or `up` is zero
/// or parallel to the view (within 1e-6 rad).
std::optional<std::array<dvec3, 3>> view_axes(dvec3 position, dvec3 look_at, dvec3 up);

/// One line of a .chan file.
struct ChanKey {
    double frame;
    dvec3 position;           ///< [m]
    glm::dquat orientation;   ///< unit; turns camera axes into world axes
    double vertical_fov = 0;  ///< degrees; 0 if the line has none
};

/// Parses the lines "frame tx ty tz rx ry rz [vertical_fov]", metres and degrees, parted by blanks; empty lines and
/// what follows a # are skipped. Frames increase strictly; either every line has a field of view or none. Rotations are
/// in Nuke's default order ZXY: about z first (roll), then x (tilt), then y (pan), R = Ry Rx Rz on column vectors.
/// Throws UserError "name:line: …"; also for a text without any key.
std::vector<ChanKey> parse_chan(std::string_view text, const std::filesystem::path& name);

/// The camera of a scene over time: constant, or keyed by a .chan file, which overrides position, look_at and up, and
/// whose field of view, if it has one, overrides the scene's. Between keys, position and focal length change linearly
/// and the orientation at constant angular speed (spherically); outside, the first or last key holds. Read once, then
/// random access: the camera of frame F is a pure function of the scene and F.
class CameraPath {
  public:
    /// width, height: of the display window in pixels, > 0. pixel_aspect > 0. fov: overrides every other horizontal
    /// field of view, degrees.
    /// Throws UserError: degenerate axes, fov outside kSmallestFov … kLargestFov or for an orthographic camera, a
    /// broken .chan.
    CameraPath(const CameraSpec& spec, int width, int height, double pixel_aspect = 1, std::optional<double> fov = {});

    Camera at(double frame) const;
    /// The camera that fixes the shot's frame of reference for thin screens: at the first key, or the constant one.
    Camera reference() const { return keys_.empty() ? base_ : at(keys_.front().frame); }
    /// First and last frame of the .chan file, which must be there.
    std::array<double, 2> frames() const { return {keys_.front().frame, keys_.back().frame}; }
    /// Whether there is a .chan file.
    bool moving() const { return !keys_.empty(); }

  private:
    double f_px(const ChanKey& key) const;

    Camera base_;
    int height_;
    bool own_fov_ = false;  ///< the scale is base_'s whatever the keys say
    std::vector<ChanKey> keys_;
};

}  // namespace eikonal
