/// A scene as its TOML file states it: camera, time, optics, media, and (for the tracer) objects, light, background.
/// Scenes are parsed here alone. The structs are plain data. Every field has the default of an omitted key. An empty
/// file is a scene without media, in which nothing moves.
///
/// Units: metres, seconds, kelvin; degrees and millimetres only where the name says so. World axes right-handed, y up.
/// Range: every number is finite and within the limits of noise/medium/number_limits.h. Errors: UserError, one line
/// "file:line: key: what is wrong, what is allowed, the nearest valid name". Errors are unknown keys, contradictions,
/// and keys that do not apply together with the others.
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

/// Frames per second, if neither the scene nor the footage states it.
inline constexpr double kDefaultFps = 24;

/// Range of a field of view [degrees]. Within it the focal length in pixels is finite and positive.
inline constexpr double kSmallestFov = 1e-6;
inline constexpr double kLargestFov = 179.99;

/// Field of view of a perspective camera if the scene states neither a field of view nor a focal length [degrees].
inline constexpr double kDefaultHorizontalFov = 40;
/// Width of the sensor if the scene states a focal length without sensor_width: full frame [mm].
inline constexpr double kDefaultSensorWidth = 36;

/// [camera]
struct CameraSpec {
    std::optional<std::array<int, 2>> resolution;  ///< if left out: that of the footage, else 1920 x 1080
    dvec3 position{0, 1.5, 0};
    dvec3 look_at{0, 1.5, -1};             ///< if left out: straight ahead along -z from any position
    dvec3 up{0, 1, 0};                     ///< neither zero nor parallel to the view
    std::optional<double> horizontal_fov;  ///< degrees, kSmallestFov … kLargestFov; excludes the next two
    std::optional<double> focal_length;    ///< [mm]
    std::optional<double> sensor_width;    ///< [mm]; only with focal_length
    Projection projection = Projection::Perspective;
    double width = 10;                          ///< width of an orthographic view [m]
    std::optional<std::filesystem::path> path;  ///< .chan file; relative paths start from the scene's folder
};

/// [time]
struct TimeSpec {
    std::optional<double> fps;  ///< if left out: the footage's own, else 24
    int first_frame = 1;        ///< the frame at t = 0
};

/// [plate]: what is known of footage without a depth map. Options on the command line override it.
struct PlateSpec {
    std::optional<double> distance;  ///< one axial distance of all pixels [m] > 0; excludes ground
    std::optional<double> far;       ///< distance of the background [m] > 0
    /// Height of the camera above flat ground [m] > 0; row of the horizon (0 top … 1 bottom; may lie outside).
    std::optional<std::array<double, 2>> ground;
};

enum class ObjectShape { Plane, Quad, Sphere, Mesh };

/// [[object]] (tracer only)
struct ObjectSpec {
    ObjectShape shape = ObjectShape::Plane;
    std::string name;
    // plane: origin, normal; `up` orients the texture; `size` is metres per texture repeat. quad: origin is its centre.
    dvec3 origin{0, 0, 0};
    dvec3 normal{0, 1, 0};
    std::optional<dvec3> up;
    std::array<double, 2> size{1, 1};              ///< width, height [m]
    dvec3 center{0, 0, 0};                         ///< of a sphere; offset of a mesh
    double radius = 1;                             ///< of a sphere [m]
    double scale = 1;                              ///< of a mesh
    std::optional<std::filesystem::path> file;     ///< mesh, *.obj
    std::optional<std::filesystem::path> texture;  ///< excludes color
    dvec3 color{0.5, 0.5, 0.5};                    ///< linear
    bool emissive = false;                         ///< whether it shows its colour under any light
    double mirror = 0;                             ///< part of the light that it reflects like a mirror, 0 … 1
    std::optional<double> refractive_index;        ///< of an object of glass: absolute index > 0; excludes mirror
};

/// [light]: a sun. Without it objects are emissive. Colours are linear, >= 0.
struct LightSpec {
    dvec3 direction{-0.4, -1, -0.3};  ///< direction in which the light travels
    dvec3 color{1, 1, 1};
    dvec3 ambient{0.2, 0.25, 0.3};
};

/// [background]: a colour, or a picture (latitude-longitude) that surrounds the scene.
struct BackgroundSpec {
    dvec3 color{0, 0, 0};
    std::optional<std::filesystem::path> image;
};

struct Scene {
    std::filesystem::path file;  ///< the file that it was read from; empty for the default scene
    CameraSpec camera;
    TimeSpec time;
    OpticsSpec optics;
    PlateSpec plate;
    std::vector<MediumSpec> media;
    std::vector<ObjectSpec> objects;
    std::optional<LightSpec> light;
    BackgroundSpec background;
};

/// Reads a scene file, applies `settings` and checks the result. A setting is "medium.0.cn2=1e-13": a dotted key and a
/// TOML value. Array elements count from 0, and the next free number appends one. A value that is not TOML is taken as
/// text. If there is nothing after the =, the key is removed. Relative paths start from the folder of the file; those
/// of settings start from the working folder.
///
/// Seeds. The seed of each medium is a hash of the scene's seed (`seed`, else 0), the medium's place among the media
/// and its own `seed`. One number therefore changes the whole scene, and media that state the same seed still differ.
Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& settings = {},
                 std::optional<std::uint64_t> seed = {});

/// The same from a text. `name` stands for the file in messages, and its parent for the folder. Any text is handled
/// without a crash.
Scene parse_scene(std::string_view text, const std::filesystem::path& name,
                  const std::vector<std::string>& settings = {}, std::optional<std::uint64_t> seed = {});

/// A scene file that is delivered with the program.
struct Preset {
    std::string name;         ///< name of the file, without .toml
    std::string description;  ///< its first line, a comment
    std::filesystem::path file;
};

/// Every preset, sorted by name. Presets are in the folder `presets` of the folder that the environment variable
/// EIKONAL_SAMPLES names. Without it they are in share/eikonal/presets of the prefix that the library or program is
/// installed in. Without that they are in the source tree that it was built from. UserError if there is none of these.
std::vector<Preset> list_presets();

/// The file of a preset. UserError if there is none, which names the nearest presets.
std::filesystem::path find_preset(const std::string& name);

}  // namespace eikonal
