/// A shot that is ready to be computed: a scene, a view, a background and a strength, settled once for all frames.
///
/// Depth is given as a number or a plane, and a matte as values. Files are not read here; footage_shot.h reads them.
/// Frame F depends on the scene, the settings and F alone. Units: pixels, metres, seconds. Conventions: displacer.h.
///
/// Errors: UserError for settings and scenes that contradict each other, FrameError for one frame or once a stop is
/// requested. Messages name settings as in settings.h.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "warp/displace/choose_model.h"
#include "warp/image/plane.h"
#include "warp/scene/background.h"
#include "warp/scene/scene.h"
#include "warp/shimmer/displacement_map.h"
#include "warp/shimmer/settings.h"

namespace eikonal {

struct ShotSettings {
    ViewSettings view;
    Background background;
    ShotDepth depth;  ///< the depth that all frames share, if any, and how rays meet a depth map
    StrengthSettings strength;
    bool state_errors = false;  ///< whether the errors of maps are measured; a tolerance implies it
    std::stop_token stop;       ///< once requested, work ends with a FrameError
};

/// Times of the instants within a shutter that is centred on the frame, in frames from it. shutter: the part of the
/// frame's time that it is open, 0 … 1. samples >= 1.
std::vector<double> shutter_offsets(double shutter, int samples);

/// The camera's path for a shot with this view. UserError: as in camera.h.
CameraPath camera_path(const Scene& scene, const ViewSettings& view);

/// Immutable, thread-safe.
class Shot {
  public:
    Shot(Scene scene, const ShotSettings& settings);
    Shot(Shot&&) noexcept = delete;

    const Scene& scene() const { return scene_; }
    const PixelWindow& display() const { return settings_.view.display; }
    const Background& background() const { return settings_.background; }
    DepthMeeting meeting() const { return settings_.depth.meeting; }
    const Displacer& displacer() const { return *displacer_; }
    /// The factor on the displacement.
    double gain() const { return gain_; }
    double fps() const { return displacer_settings_.fps; }
    /// The largest error that maps should have [px]; nothing if there is no limit.
    std::optional<double> tolerance() const { return tolerance_; }
    /// How the model was chosen automatically; null if it was not.
    const ModelChoice* choice() const { return choice_ ? &*choice_ : nullptr; }
    /// For frames whose error p95 [px] exceeds the tolerance: a model that should keep them within it, if there is one.
    /// Slow.
    std::optional<Model> sufficient_model(double p95) const;
    /// Expected rms of |d| at the background [px], with the gain, before any falloff. Computed at each call.
    double expected_rms() const { return displacer_->expected_rms(background().far) * gain_; }
    /// Expected focusing variance at the background (Displacer), with the gain. Computed at each call.
    double focusing_variance() const { return displacer_->focusing_variance(background().far) * gain_ * gain_; }
    /// Approximate memory of a frame in progress [bytes]. pixel_bytes: memory of the caller's own per pixel of the
    /// display window.
    double frame_bytes(double pixel_bytes) const;

    /// Notes on scene, media, model and strength, one line each.
    std::vector<std::string> notes() const;
    /// What the user should know before `frames` are made, one line each.
    std::vector<std::string> warnings(const std::vector<int>& frames) const;

    /// Writes the displacement at a time, in frames, into `uv`, as window.area() interleaved pairs. `window` counts
    /// from the display window's corner, like that of a DepthPlane.
    void map(double frame, const SharedDepth& depth, const PixelWindow& window, float* uv) const;
    /// The error of a map that map() made with the same arguments. The settings must ask for it (state_errors).
    StatedError stated_error(double frame, const SharedDepth& depth, const PixelWindow& window, const float* uv) const;

    using Progress = std::function<void(int done, int of)>;
    struct Maps {
        std::vector<DisplacementMap> of_instants;
        std::optional<StatedError> error;  ///< error of the middle instant, before the matte
    };
    /// Maps at frame + offsets, on `window` of the picture. matte: one factor a pixel, or nothing. Remarks on the depth
    /// are added to `remarks`. progress, if given, is called after each map.
    Maps maps(double frame, const std::vector<double>& offsets, const SharedDepth& depth, const PixelWindow& window,
              std::span<const float> matte, std::vector<Remark>& remarks, const Progress& progress = {}) const;

  private:
    DisplacerSettings make_displacer_settings() const;
    GainOf gain_of() const;
    void add_remarks(double farthest, std::vector<Remark>& remarks) const;
    std::optional<std::string> background_warning() const;
    std::optional<std::string> tolerance_warning() const;
    std::optional<std::string> folding_warning() const;
    std::optional<std::string> path_warning(const std::vector<int>& frames) const;

    Scene scene_;
    ShotSettings settings_;
    DisplacerSettings displacer_settings_;
    std::optional<double> tolerance_;
    std::optional<ModelChoice> choice_;
    std::unique_ptr<Displacer> displacer_;
    double gain_ = 1;
};

}  // namespace eikonal
