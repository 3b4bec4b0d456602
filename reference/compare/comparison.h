/// Compares the warp with the tracer on frames of a scene. It finds the error and the time of every model that applies.
///
/// The plate is rendered with straight rays, the truth with bent ones. Each model's map is made from the plate's depth,
/// as `eikonal warp plate.exr --scene S --depth :Z` makes it. The map is compared with the u, v of the truth pixel by
/// pixel. The warped plate is compared with the truth's picture (error_measures.h). Pixels without a true answer
/// (trapped rays, n <= 0) are left out of the errors of displacement.
///
/// Rows of the result: `none`, which is the plate itself; every model by its name; and `default`, what the warp does if
/// no model is asked for, unless that is one of the models alone. A model that does not suit the scene has a row, too,
/// with the warp's reason.
///
/// Times are wall times of this machine on all threads. For a model they are medians over up to kTimedRuns runs of each
/// frame's map and warp. For the tracer they are the time of the truth's picture once a frame, with `samples` rays a
/// pixel, and beside it the time of one ray through each pixel's centre, without colour.
///
/// Memory is the largest growth of the resident memory of the process while the model's shot and its first map are
/// made. It is 0 if the system does not report it.
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

/// Number of timed runs of a map and of a warp. Fewer are made if they take kTimingSeconds together.
inline constexpr int kTimedRuns = 5;
inline constexpr double kTimingSeconds = 2;

/// Names of the rows that are not models.
inline constexpr std::string_view kNoModel = "none", kDefaultModel = "default";

/// Tolerance of the rays that the warp is judged by [px]. It is much smaller than any model's error.
inline constexpr double kTruthTolerance = 1e-3;

struct CompareSettings {
    RaySettings rays{.tolerance_px = kTruthTolerance};
    int samples = 16;                 ///< rays of colour a pixel
    std::vector<std::string> models;  ///< rows wanted in addition to `none`; empty: all
    std::stop_token stop = {};        ///< once requested, a frame ends with a FrameError
};

/// The result of one model for one frame.
struct ModelFrame {
    std::vector<float> uv;      ///< interleaved [px]
    std::vector<float> error;   ///< |d - d_true| [px]; negative where there is no true answer
    std::vector<float> change;  ///< |Δd - Δd_true| since the frame before, like `error`; empty for the first frame
    std::vector<float> warped;  ///< R G B A, linear
};

/// The result of one model over all frames. Errors are taken over the pixels of all frames together. The error of the
/// picture is a mean, and times are medians.
struct ModelResult {
    std::string name;         ///< the value of --model
    std::string refusal;      ///< why it does not apply; all else is then empty
    bool is_default = false;  ///< whether the warp uses it if no model is asked for
    ErrorStatistics all, smooth, silhouettes;
    ErrorStatistics temporal;  ///< |Δd - Δd_true| of the same pixel in consecutive frames
    PictureError picture;
    std::optional<double> stated_p95;  ///< the error that the warp itself states, without the tracer [px]
    double setup_seconds = 0;          ///< time once a shot
    double map_seconds = 0, warp_seconds = 0;
    double memory = 0;  ///< [bytes]

    bool applies() const { return refusal.empty(); }
    double seconds() const { return map_seconds + warp_seconds; }
};

/// Facts about a scene, and the results of its models.
struct Comparison {
    std::string scene;  ///< name of its file
    int width = 0, height = 0, samples = 0;
    std::vector<int> frames;
    std::string_view integrator;
    double tolerance = 0;          ///< tolerance of the tracer [px]
    double tracer_seconds = 0;     ///< time of a frame with one ray a pixel and no colour
    double picture_seconds = 0;    ///< time of a frame of the truth's picture: `samples` rays a pixel
    double tracer_error = 0;       ///< mean of the tracer's own estimate [px]
    double rms = 0, largest = 0;   ///< of the true displacement [px]
    double focusing_variance = 0;  ///< expected at the far distance (Displacer), strength before any falloff
    double far = 0;                ///< [m]
    double silhouettes = 0;        ///< part of the pixels
    double background = 0;         ///< part of the plate's pixels; at `far` in the warp, infinitely far in the tracer
    std::optional<double> folded;  ///< part of the pixels with negative magnification; unknown for some integrators
    double trapped = 0, without_index = 0;
    std::vector<ModelResult> models;

    bool over_time() const { return frames.size() > 1; }
};

/// Compares the frames of a shot one after another, and gives the result over all of them.
class Comparer {
  public:
    /// UserError: the scene cannot be rendered, a name in settings.models is unknown, or none of the models applies.
    Comparer(const Scene& scene, const CompareSettings& settings);
    ~Comparer();

    /// The pictures of a frame, and the models' results in the order of models().
    struct Frame {
        int number = 0;
        RenderedFrame plate, truth;
        std::vector<ModelFrame> models;  ///< an empty one for a model that does not apply
    };
    /// Compares a frame. tile_done, if given, is called after each of tile_count() tiles, from any thread. FrameError.
    const Frame& add(int frame, const std::function<void()>& tile_done = {});
    int tile_count() const;

    /// The result over all frames added, of which there must be at least one.
    Comparison result() const;

  private:
    struct Shot;
    std::unique_ptr<Shot> shot_;
};

}  // namespace eikonal::reference
