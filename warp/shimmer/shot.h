/// A shot made ready: a scene, a view, a background and a strength, settled once for all frames.
///
/// Depth comes in as a number or a plane, a matte as values: nothing is read from files here (footage_shot.h does).
/// Frame F depends on the scene, the settings and F alone. Units: pixels, metres, seconds; conventions of displacer.h.
///
/// Errors: UserError for settings and scenes that do not go together, FrameError for one frame, and once a stop is
/// requested. Their settings are those of settings.h.
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
    ShotDepth depth;  ///< as far as all frames share it; and how rays meet a depth map
    StrengthSettings strength;
    bool state_errors = false;  ///< maps are to be measured; a tolerance asks for it, too
    std::stop_token stop;       ///< once requested, work ends with a FrameError
};

/// Times of the instants within a shutter that is centred on the frame, in frames from it. shutter: the part of the
/// frame's time that it is open, 0 … 1; samples >= 1.
std::vector<double> shutter_offsets(double shutter, int samples);

/// The camera's path, as a shot with this view sees it. UserError: camera.h.
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
    /// What multiplies the displacement.
    double gain() const { return gain_; }
    double fps() const { return displacer_settings_.fps; }
    /// The tolerance that maps are to keep within, if there is one [px].
    std::optional<double> tolerance() const { return tolerance_; }
    /// How the model was chosen automatically; null if it was not.
    const ModelChoice* choice() const { return choice_ ? &*choice_ : nullptr; }
    /// A model that should keep frames within the tolerance which are off by p95 [px], if there is one. Slow.
    std::optional<Model> sufficient_model(double p95) const;
    /// Expected rms of |d| at the background, gain included, before any falloff [px]. Worked out at each call.
    double expected_rms() const { return displacer_->expected_rms(background().far) * gain_; }
    /// Expected focusing variance at the background, gain included (Displacer). Worked out at each call.
    double focusing_variance() const { return displacer_->focusing_variance(background().far) * gain_ * gain_; }
    /// Memory that a frame takes on its way, about [bytes]. pixel_bytes: of the caller's own, a pixel of the display.
    double frame_bytes(double pixel_bytes) const;

    /// One line each on scene, media, model and strength.
    std::vector<std::string> notes() const;
    /// One line each on what the user should know before `frames` are made.
    std::vector<std::string> warnings(const std::vector<int>& frames) const;

    /// Displacement at a time, in frames, into `uv`: window.area() interleaved pairs. `window` counts from the display
    /// window's corner, as DepthPlane's do.
    void map(double frame, const SharedDepth& depth, const PixelWindow& window, float* uv) const;
    /// What a map is off by that map() made with the same arguments. The settings must ask for it.
    StatedError stated_error(double frame, const SharedDepth& depth, const PixelWindow& window, const float* uv) const;

    using Progress = std::function<void(int done, int of)>;
    struct Maps {
        std::vector<DisplacementMap> of_instants;
        std::optional<StatedError> error;  ///< of the middle instant, before the matte
    };
    /// Maps at frame + offsets, on `window` of the picture. matte: a factor for each pixel, or nothing. What is odd
    /// about the depth is added to `remarks`. progress, if given, is called as each map is done.
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
