/// The warp judged by the tracer, on frames of a scene: every model that applies, its errors and its time.
///
/// The plate is rendered with straight rays, the truth with bent ones. Each model's map is made from the plate's depth,
/// as `eikonal warp plate.exr --scene S --depth :Z` makes it, and compared with the truth's u, v pixel by pixel; then
/// the plate that it warped with the truth's picture (error_measures.h). Pixels without a true answer (trapped rays, n
/// <= 0) are left out of the errors of displacement.
///
/// Rows of the result: `none`, the plate itself; every model by its name; and `default`, what the warp chooses if no
/// model is asked for, unless that is one of the models alone. Models that a scene does not suit are results, too: they
/// carry the warp's reason.
///
/// Times are of this machine, wall time on all threads: the median of up to kTimedRuns runs of each frame's map and
/// warp; of the tracer, the truth's picture, `samples` rays a pixel, once a frame (and one ray through each pixel's
/// centre, without colour, beside it).
/// Memory is measured: by how much the resident memory of the process grows at its highest while the model's shot and
/// its first map are made. 0 where the system does not tell.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "reference/compare/error_measures.h"
#include "reference/trace/render.h"
#include "warp/pixels/linear_image.h"

namespace eikonal::reference {

/// Runs of a map and of a warp that are timed, fewer where they take kTimingSeconds together.
inline constexpr int kTimedRuns = 5;
inline constexpr double kTimingSeconds = 2;

/// The rows that are no models.
inline constexpr std::string_view kNoModel = "none", kDefaultModel = "default";

/// Of the rays that the warp is judged by [px]; much less than any model's error.
inline constexpr double kTruthTolerance = 1e-3;

struct CompareSettings {
    RaySettings rays{.tolerance_px = kTruthTolerance};
    int samples = 16;                 ///< of colour a pixel
    std::vector<std::string> models;  ///< rows wanted besides `none`; empty: all
    std::stop_token stop = {};        ///< once requested, a frame ends with a FrameError
};

/// One model's answer for one frame.
struct ModelFrame {
    std::vector<float> uv;      ///< interleaved [px]
    std::vector<float> error;   ///< |d - d_true| [px]; negative where there is no true answer
    std::vector<float> change;  ///< |Δd - Δd_true| since the frame before, as `error`; of the first frame: empty
    std::vector<float> warped;  ///< R G B A, linear
};

/// One model over all frames. Errors are of all their pixels together, the picture's a mean, times medians.
struct ModelResult {
    std::string name;         ///< as --model takes it
    std::string refusal;      ///< why it does not apply; all else is then empty
    bool is_default = false;  ///< what the warp does if no model is asked for
    ErrorStatistics all, smooth, silhouettes;
    ErrorStatistics temporal;  ///< |Δd - Δd_true| of the same pixel in consecutive frames
    PictureError picture;
    std::optional<double> stated_p95;  ///< what the warp itself says, without the tracer [px]
    double setup_seconds = 0;          ///< once a shot
    double map_seconds = 0, warp_seconds = 0;
    double memory = 0;  ///< [bytes]

    bool applies() const { return refusal.empty(); }
    double seconds() const { return map_seconds + warp_seconds; }
};

/// A scene's facts and its models.
struct Comparison {
    std::string scene;  ///< name of its file
    int width = 0, height = 0, samples = 0;
    std::vector<int> frames;
    std::string_view integrator;
    double tolerance = 0;          ///< asked of the tracer [px]
    double tracer_seconds = 0;     ///< a frame, one ray a pixel and no colour
    double picture_seconds = 0;    ///< a frame, the truth's picture: `samples` rays a pixel
    double tracer_error = 0;       ///< its own estimate, mean [px]
    double rms = 0, largest = 0;   ///< of the true displacement [px]
    double focusing_variance = 0;  ///< expected at the far distance (Displacer), strength before any falloff
    double far = 0;                ///< [m]
    double silhouettes = 0;        ///< part of the pixels
    double background = 0;         ///< part of the plate's pixels, `far` to the warp and infinitely far to the tracer
    std::optional<double> folded;  ///< part of the pixels with negative magnification; unknown for some integrators
    double trapped = 0, without_index = 0;
    std::vector<ModelResult> models;

    bool over_time() const { return frames.size() > 1; }
};

/// The frames of a shot, one after another; then what they say together.
class Comparer {
  public:
    /// UserError: the scene cannot be rendered, a name in settings.models is none, none of them applies.
    Comparer(const Scene& scene, const CompareSettings& settings);
    ~Comparer();

    /// What a frame shows: the pictures, and answers in the order of models().
    struct Frame {
        int number = 0;
        RenderedFrame plate, truth;
        std::vector<ModelFrame> models;  ///< empty where one does not apply
    };
    /// Compares a frame. tile_done, if given, is called after each of tile_count() tiles, from any thread. FrameError.
    const Frame& add(int frame, const std::function<void()>& tile_done = {});
    int tile_count() const;

    /// Of all frames added, at least one.
    Comparison result() const;

  private:
    struct Shot;
    std::unique_ptr<Shot> shot_;
};

}  // namespace eikonal::reference
