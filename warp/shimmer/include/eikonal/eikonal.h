/// Heat shimmer for pictures, as a library. It computes how hot air displaces every pixel of a frame, and displaces the
/// picture.
///
///     eikonal::Settings settings;
///     settings.preset = "hot-road";
///     settings.width = 1920;
///     settings.height = 1080;
///     const eikonal::Shimmer shimmer(settings);
///     const eikonal::Map map = shimmer.map(12);
///     shimmer.warp(pixels, 4, out, 12);
///
/// Rules that hold for every call:
///   - Row 0 is on top. Pixels are stored row by row; channels and pairs are interleaved. x runs right, y down.
///   - out(p) = in(p + d(p)), with the displacement d = (u, v) in pixels. Without displacement a pixel keeps its bits.
///   - Lengths are in metres, times in frames or seconds, angles in degrees. Depth is axial: along the camera's axis.
///   - Frame F depends on the settings and F alone: not on other frames, the order of calls, threads or the machine.
///     Maps have the same bits as those of the program `eikonal map`.
///   - Errors are exceptions: UserError for impossible settings and scenes, FrameError for one frame. The message is
///     one line. It names settings as the fields below, between backticks. Nothing is printed.
///   - A Shimmer is immutable. Any number of threads may call it at once.
///
/// Needs C++20. CMake: find_package(eikonal), target eikonal::eikonal. pkg-config: eikonal.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include <eikonal/error.h>  // UserError, FrameError

#define EIKONAL_API __attribute__((visibility("default")))

namespace eikonal {

/// The settings of a shot. Every field has the default of a setting that is left out. width and height must be set.
struct Settings {
    /// @name Scene: at most one of the first three. Without any of them the scene is the preset `gentle`.
    /// @{
    std::string scene;                  ///< path of a scene file (TOML)
    std::string scene_text;             ///< a scene's text (TOML)
    std::string preset;                 ///< name of a scene that comes with eikonal
    std::vector<std::string> set;       ///< changes to the scene: "medium.0.cn2=1e-13"
    std::optional<std::uint64_t> seed;  ///< another value gives other turbulence of the same kind
    /// @}

    /// @name View of the picture as it is shown.
    /// @{
    int width = 0, height = 0;  ///< [px], 1 … 65535
    double pixel_aspect = 1;    ///< width over height of a pixel
    std::optional<double> fps;  ///< of the footage; a value in the scene overrides it; else 24
    std::optional<double> fov;  ///< horizontal field of view [degrees]; overrides the scene's
    /// @}

    /// @name Depth: at most one of distance, ground and depth_map. Without any of them the scene's [plate] states it.
    /// @{
    std::optional<double> distance;               ///< one distance of all pixels [m]
    std::optional<std::array<double, 2>> ground;  ///< camera height above flat ground [m], row of the horizon [px]
    /// Whether each frame is given with a value for every pixel (Frame::depth).
    bool depth_map = false;
    std::string depth_type = "z";  ///< of those values: "z" metres along the axis, "ray" along the ray, "inverse" 1/z
    std::optional<double> far;     ///< distance of the background [m]; depth 0, infinite or NaN is background
    /// @}

    /// @name Displacement
    /// @{
    std::string model;                ///< name of a model, or "auto"; empty: each medium's default
    std::optional<double> tolerance;  ///< error allowed in 95 of 100 pixels [px]; implies "auto" if no model is named
    std::optional<double> rms;        ///< scale to this expected rms at the background [px], once for the whole shot
    double gain = 1;                  ///< factor on the displacement
    bool state_errors = false;        ///< whether maps state their error (Map::error); a tolerance implies it
    /// @}

    /// @name Picture
    /// @{
    std::string filter = "cubic";  ///< "bilinear", "cubic", "lanczos3", "area"
    std::string edge = "mirror";   ///< what lies outside: "mirror", "clamp", "wrap", "black"
    double shutter = 0;            ///< part of the frame's time that the shutter is open, 0 … 1
    int samples = 9;               ///< number of instants within an open shutter
    double dispersion = 0;         ///< colour fringes: 0 none, 1 as strong as in real air
    /// @}

    int threads = 0;       ///< number of threads that each call uses; 0: all processors
    std::stop_token stop;  ///< once requested, calls in progress and later ones end with a FrameError
};

/// The input of one frame.
struct Frame {
    std::span<const float> depth;  ///< width * height values, if Settings::depth_map is set
    /// Called from the calling thread after each instant of the shutter is computed.
    std::function<void(int done, int of)> progress;
};

/// The error of a map, measured against bent rays through sampled pixels [px].
struct MapError {
    int samples = 0;
    double p50 = 0, p95 = 0, largest = 0;
};

/// The displacement of every pixel.
struct Map {
    int width = 0, height = 0;
    std::vector<float> uv;              ///< 2 * width * height values: u, v of each pixel
    std::optional<MapError> error;      ///< set if the settings ask for it and something moves
    std::vector<std::string> warnings;  ///< about this frame
};

/// The expected strength of a shot, before any frame is made. Falloff is not included, nor are surfaces.
struct Expected {
    double shift_rms = 0;  ///< rms of |d| at the background, over pixels and time [px]
    double focusing = 0;   ///< variance of the focusing of light from the background; rays begin to fold near 1
};

/// A shot that is ready to be computed.
class EIKONAL_API Shimmer {
  public:
    /// Reads the scene and prepares its media. This may take seconds, since the model "auto" tries several models.
    explicit Shimmer(const Settings& settings);
    ~Shimmer();
    Shimmer(Shimmer&&) noexcept;
    Shimmer& operator=(Shimmer&&) noexcept;

    /// The displacement at a time in frames. Times between whole frames are allowed.
    Map map(double frame, const Frame& input = {}) const;

    /// Displaces a picture in linear light: width * height * channels values, `channels` >= 1. Colour with alpha is
    /// premultiplied. Dispersion acts on the first three channels of a picture with three or four channels. `out` has
    /// the size of `in` and must not overlap it.
    void warp(std::span<const float> in, int channels, std::span<float> out, double frame,
              const Frame& input = {}) const;

    /// The expected strength. It is computed at each call.
    Expected expected() const;
    /// The models in use, in the order of the media; empty if only surfaces bend.
    std::vector<std::string> models() const;
    /// The factor on the displacement: the gain times the scale to Settings::rms.
    double gain() const;
    /// Notes on scene, depth, media, model and strength, one line each.
    std::vector<std::string> notes() const;
    /// What the user should know of the shot, one line each.
    std::vector<std::string> warnings() const;

  private:
    struct Shot;
    std::unique_ptr<Shot> shot_;
};

/// Names of the scenes that are delivered with eikonal.
EIKONAL_API std::vector<std::string> preset_names();

/// The version, as "1.2.3".
EIKONAL_API std::string version();

}  // namespace eikonal
