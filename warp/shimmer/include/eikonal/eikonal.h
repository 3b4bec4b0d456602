/// Heat shimmer for pictures, as a library: how hot air displaces every pixel of a frame, and the displaced picture.
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
///   - Row 0 is on top, pixels are row by row, channels and pairs are interleaved; x runs right, y down.
///   - out(p) = in(p + d(p)), with the displacement d = (u, v) in pixels. Without displacement a pixel keeps its bits.
///   - Lengths are metres, times frames or seconds, angles degrees. Depth is axial: along the camera's axis.
///   - Frame F depends on the settings and F alone: not on other frames, the order of calls, threads or the machine.
///     Maps have the same bits as those of the program `eikonal map`.
///   - Errors are exceptions: UserError for settings and scenes that cannot be, FrameError for one frame. Their text is
///     one line, which names settings as the fields below, between backticks. Nothing is printed.
///   - A Shimmer does not change once it is made: any number of threads may call it at once.
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

/// What a shot is. Every field has the default of what is left out; width and height must be set.
struct Settings {
    /// @name Scene: at most one of the first three; none of them is the preset `gentle`.
    /// @{
    std::string scene;                  ///< path of a scene file (TOML)
    std::string scene_text;             ///< a scene's text (TOML)
    std::string preset;                 ///< name of a scene that comes with eikonal
    std::vector<std::string> set;       ///< changes to the scene: "medium.0.cn2=1e-13"
    std::optional<std::uint64_t> seed;  ///< another turbulence of the same kind
    /// @}

    /// @name View: of the picture as it is shown.
    /// @{
    int width = 0, height = 0;  ///< [px], 1 … 65535
    double pixel_aspect = 1;    ///< width over height of a pixel
    std::optional<double> fps;  ///< of the footage; the scene's own, if it has one, overrides it; else 24
    std::optional<double> fov;  ///< horizontal field of view, instead of the scene's
    /// @}

    /// @name Depth: at most one of distance, ground and depth_map; none of them is what the scene's [plate] says.
    /// @{
    std::optional<double> distance;               ///< of everything
    std::optional<std::array<double, 2>> ground;  ///< camera height above flat ground, row of the horizon [px]
    /// Each frame comes with a value for every pixel (Frame::depth).
    bool depth_map = false;
    std::string depth_type = "z";  ///< of those values: "z" metres along the axis, "ray" along the ray, "inverse" 1/z
    std::optional<double> far;     ///< distance of the background; zero, infinite and NaN depth is background
    /// @}

    /// @name Displacement
    /// @{
    std::string model;                ///< a model's name, "auto", or nothing: what suits each medium
    std::optional<double> tolerance;  ///< error allowed in 95 of 100 pixels [px]; implies "auto" without a model
    std::optional<double> rms;        ///< scale to this expected rms at the background [px], fixed over the shot
    double gain = 1;                  ///< multiply
    bool state_errors = false;        ///< maps say what they are off by (Map::error); a tolerance asks for it, too
    /// @}

    /// @name Picture
    /// @{
    std::string filter = "cubic";  ///< "bilinear", "cubic", "lanczos3", "area"
    std::string edge = "mirror";   ///< what lies outside: "mirror", "clamp", "wrap", "black"
    double shutter = 0;            ///< part of the frame's time that the shutter is open, 0 … 1
    int samples = 9;               ///< instants within an open shutter
    double dispersion = 0;         ///< colour fringes: 0 none, 1 those of true air
    /// @}

    int threads = 0;       ///< used by each call; 0: all processors
    std::stop_token stop;  ///< once requested, calls under way and later ones end with a FrameError
};

/// What one frame brings along.
struct Frame {
    std::span<const float> depth;  ///< width * height values, if Settings::depth_map is set
    /// Called as each instant of the shutter is done, from the calling thread.
    std::function<void(int done, int of)> progress;
};

/// What a map is off by, measured against bent rays through sampled pixels [px].
struct MapError {
    int samples = 0;
    double p50 = 0, p95 = 0, largest = 0;
};

/// Displacement of every pixel.
struct Map {
    int width = 0, height = 0;
    std::vector<float> uv;              ///< 2 * width * height: u, v of each pixel
    std::optional<MapError> error;      ///< if it was asked for and something moves
    std::vector<std::string> warnings;  ///< on this frame
};

/// What a shot will be like, before any frame is made; without falloff, and without surfaces, which bend exactly.
struct Expected {
    double shift_rms = 0;  ///< rms of |d| at the background, over pixels and time [px]
    double focusing = 0;   ///< variance of the focusing of light from there; rays begin to fold near 1
};

/// A shot made ready.
class EIKONAL_API Shimmer {
  public:
    /// Reads the scene and prepares its media. May take seconds; a model "auto" tries several.
    explicit Shimmer(const Settings& settings);
    ~Shimmer();
    Shimmer(Shimmer&&) noexcept;
    Shimmer& operator=(Shimmer&&) noexcept;

    /// Displacement at a time, in frames; whole numbers are the frames' own.
    Map map(double frame, const Frame& input = {}) const;

    /// Displaces a picture of linear light: width * height * channels values, `channels` >= 1. Colour with alpha is
    /// premultiplied. Dispersion acts on the first three channels where there are three or four. `out` is as large as
    /// `in` and apart from it.
    void warp(std::span<const float> in, int channels, std::span<float> out, double frame,
              const Frame& input = {}) const;

    /// Worked out at each call.
    Expected expected() const;
    /// The models in use, in the order of the media; empty if only surfaces bend.
    std::vector<std::string> models() const;
    /// What multiplies the displacement: the gain, and the scale to Settings::rms.
    double gain() const;
    /// One line each on scene, depth, media, model and strength.
    std::vector<std::string> notes() const;
    /// One line each on what the user should know of the shot.
    std::vector<std::string> warnings() const;

  private:
    struct Shot;
    std::unique_ptr<Shot> shot_;
};

/// Names of the scenes that come with eikonal.
EIKONAL_API std::vector<std::string> preset_names();

/// "1.2.3"
EIKONAL_API std::string version();

}  // namespace eikonal
