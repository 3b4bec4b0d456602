/// A scene as its TOML file states it: camera, time, optics, media, and (for the tracer) objects, light, background.
/// This is the one place that parses scenes. Plain data; every field has the default of an omitted key. An empty file
/// is a scene without media: nothing moves.
///
/// Units: metres, seconds, kelvin; degrees and millimetres only where the name says so. World axes right-handed, y up.
/// Range: every number is finite and within the limits of noise/medium/number_limits.h. Errors: UserError, one line
/// "file:line: key: what is wrong, what is allowed, the nearest valid name". Unknown keys, keys that do not apply
/// beside what others say, and contradictions are errors.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "noise/medium/medium_spec.h"
#include "noise/medium/number_limits.h"
#include "noise/medium/optics.h"

namespace eikonal {

enum class Projection { Perspective, Orthographic };

/// Of scenes and footage that state none: frames a second.
inline constexpr double kDefaultFps = 24;

/// Range of a field of view [degrees], so that the focal length in pixels is finite and positive.
inline constexpr double kSmallestFov = 1e-6;
inline constexpr double kLargestFov = 179.99;

/// Of a perspective camera for which the scene states neither a field of view nor a focal length [degrees].
inline constexpr double kDefaultHorizontalFov = 40;
/// Of a focal length without sensor_width: full frame [mm].
inline constexpr double kDefaultSensorWidth = 36;

/// [camera]
struct CameraSpec {
    std::optional<std::array<int, 2>> resolution;  ///< left out: that of the footage, else 1920 x 1080
    dvec3 position{0, 1.5, 0};
    dvec3 look_at{0, 1.5, -1};             ///< left out: straight ahead along -z, wherever position is
    dvec3 up{0, 1, 0};                     ///< neither zero nor parallel to the view
    std::optional<double> horizontal_fov;  ///< degrees, kSmallestFov … kLargestFov; excludes the next two
    std::optional<double> focal_length;    ///< [mm]
    std::optional<double> sensor_width;    ///< [mm]; only with focal_length
    Projection projection = Projection::Perspective;
    double width = 10;                          ///< of the view [m], orthographic
    std::optional<std::filesystem::path> path;  ///< .chan file, resolved against the scene's folder
};

/// [time]
struct TimeSpec {
    std::optional<double> fps;  ///< left out: the footage's own, else 24
    int first_frame = 1;        ///< the frame at t = 0
};

/// [plate]: what is known of footage that comes without a depth map. Options on the command line override it.
struct PlateSpec {
    std::optional<double> distance;  ///< constant distance along the axis [m] > 0; excludes ground
    std::optional<double> far;       ///< where "background" lies [m] > 0
    /// Height of the camera above flat ground [m] > 0, row of the horizon (0 top … 1 bottom; may lie outside).
    std::optional<std::array<double, 2>> ground;
};

enum class ObjectShape { Plane, Quad, Sphere, Mesh };

/// [[object]] (tracer only)
struct ObjectSpec {
    ObjectShape shape = ObjectShape::Plane;
    std::string name;
    // plane: origin, normal, `up` orients the texture, `size` metres per texture repeat. quad: origin is its centre.
    dvec3 origin{0, 0, 0};
    dvec3 normal{0, 1, 0};
    std::optional<dvec3> up;
    std::array<double, 2> size{1, 1};              ///< width, height [m]
    dvec3 center{0, 0, 0};                         ///< sphere, mesh offset
    double radius = 1;                             ///< sphere [m]
    double scale = 1;                              ///< mesh
    std::optional<std::filesystem::path> file;     ///< mesh, *.obj
    std::optional<std::filesystem::path> texture;  ///< excludes color
    dvec3 color{0.5, 0.5, 0.5};                    ///< linear
    bool emissive = false;                         ///< shows its colour whatever the light
    double mirror = 0;                             ///< part of the light that it reflects as a mirror does, 0 … 1
    std::optional<double> refractive_index;        ///< made of glass: absolute index > 0; excludes mirror
};

/// [light]: a sun. Without it, objects are emissive. Colours are linear, >= 0.
struct LightSpec {
    dvec3 direction{-0.4, -1, -0.3};  ///< in which the light travels
    dvec3 color{1, 1, 1};
    dvec3 ambient{0.2, 0.25, 0.3};
};

/// [background]: a colour, or a picture (latitude-longitude) in every direction.
struct BackgroundSpec {
    dvec3 color{0, 0, 0};
    std::optional<std::filesystem::path> image;
};

struct Scene {
    std::filesystem::path file;  ///< where it was read from; empty for the default scene
    CameraSpec camera;
    TimeSpec time;
    OpticsSpec optics;
    PlateSpec plate;
    std::vector<MediumSpec> media;
    std::vector<ObjectSpec> objects;
    std::optional<LightSpec> light;
    BackgroundSpec background;
};

/// Reads a scene file and applies `settings` before it is checked: "medium.0.cn2=1e-13", a dotted key, array indices
/// from 0 (the next free one appends), a TOML value; what is no TOML value is taken as text, and nothing after the =
/// removes the key. Relative paths resolve against the file's folder, those of settings against the working one.
///
/// Seeds: what the media carry is a hash of the scene's seed (`seed`, else 0), the medium's place among the media and
/// its own `seed`, so that one number changes the whole scene, and media that state the same seed still differ.
Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& settings = {},
                 std::optional<std::uint64_t> seed = {});

/// The same from text; `name` stands for the file in messages and its parent for the folder. Never crashes on any text.
Scene parse_scene(std::string_view text, const std::filesystem::path& name,
                  const std::vector<std::string>& settings = {}, std::optional<std::uint64_t> seed = {});

/// A scene file that comes with the program.
struct Preset {
    std::string name;         ///< of the file, without .toml
    std::string description;  ///< its first line, a comment
    std::filesystem::path file;
};

/// Every preset, sorted by name. They are in the folder `presets` of the folder that the environment variable
/// EIKONAL_SAMPLES names, or else in share/eikonal/presets of the prefix that the library or program is installed in,
/// or else in the source tree that it was built from. Throws UserError if there is none of these.
std::vector<Preset> list_presets();

/// The file of a preset; UserError that names the nearest ones if there is none.
std::filesystem::path find_preset(const std::string& name);

}  // namespace eikonal
