/// A shot made ready: scene read, camera, depth and displacement settled, gain fixed. What `warp` and `map` share.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "warp/app/depth_input.h"
#include "warp/app/footage.h"
#include "warp/app/options.h"
#include "warp/app/outputs.h"
#include "warp/app/warp_plate.h"
#include "warp/displace/choose_model.h"

namespace eikonal {

/// The scene that the options name: a file, a preset, or the preset `gentle`.
std::filesystem::path scene_file_of(const SceneOptions& options);
Scene load_scene(const SceneOptions& options);

class Shot {
  public:
    /// display, pixel_aspect: of the footage. fps: the footage's own, which the scene's overrides. overscan: the pixels
    /// that maps() will be asked for, as in DisplacerSettings. state_errors: maps() measures what it makes, which a
    /// tolerance asks for, too.
    Shot(Scene scene, const SceneOptions& scene_options, const DepthArguments& depth, const StrengthOptions& strength,
         const PixelWindow& display, double pixel_aspect, std::optional<double> fps,
         const std::function<PixelWindow()>& overscan, bool state_errors);

    const Scene& scene() const { return scene_; }
    const DepthInput& depth() const { return depth_; }
    const Displacer& displacer() const { return *displacer_; }
    double gain() const { return gain_; }
    double fps() const { return fps_; }
    /// Memory that a frame takes on its way, about [bytes]. pixel_bytes: of the caller's own, a pixel of the display.
    double frame_bytes(double pixel_bytes) const;
    DepthMeeting meeting() const { return meeting_; }
    std::optional<double> tolerance() const { return tolerance_; }
    /// A model that should keep frames within the tolerance which are off by p95 [px]; none if there is none. Worked
    /// out at each call.
    std::optional<Model> sufficient_model(double p95) const;
    /// How --model auto has chosen; null otherwise.
    const ModelChoice* choice() const { return choice_ ? &*choice_ : nullptr; }
    /// Expected rms of |d| at far(), gain included [px]. Worked out at each call.
    double expected_rms() const { return displacer_->expected_rms(depth_.far()) * gain_; }
    /// Expected focusing variance at far(), gain included (Displacer::focusing_variance). Worked out at each call.
    double focusing_variance() const { return displacer_->focusing_variance(depth_.far()) * gain_ * gain_; }
    /// Lines on scene, depth, media and strength.
    std::vector<std::string> notes() const;
    /// Tells on stderr what the user should know before `frames` are made; `verbose`: the notes too.
    void tell(const std::vector<int>& frames, bool verbose);
    /// The warnings that tell() has told.
    const std::vector<std::string>& warnings() const { return warnings_; }

    struct Maps {
        std::vector<DisplacementMap> of_instants;
        std::optional<StatedError> error;  ///< of the middle instant, before the mask
    };
    /// Maps of the instants at frame + offsets, on `window`, masked. `input`: the frame's picture or null. What is odd
    /// about the depth map and the matte is added to `remarks`. FrameError: the run is interrupted, among others.
    Maps maps(int frame, const std::vector<double>& offsets, const Picture* input,
              const std::filesystem::path& input_file, const PixelWindow& window, std::vector<Remark>& remarks) const;

    /// Looks at the depth maps and mattes before any frame is begun: one line on the first that is missing. UserError:
    /// the first frame's cannot be what the options say of it. `input`: as for maps().
    std::optional<std::string> missing_companion(const std::vector<int>& frames) const;
    void try_companions(int frame, const Picture* input, const std::filesystem::path& input_file,
                        const PixelWindow& window) const;
    /// Files that are read besides the footage.
    std::vector<NamedFiles> companions() const;

  private:
    GainOf gain_of() const;
    ShotDepth shot_depth() const;

    Scene scene_;
    DepthInput depth_;
    StrengthOptions strength_;
    DepthMeeting meeting_;
    PixelWindow display_;
    double fps_;
    std::optional<double> tolerance_;
    bool state_errors_;
    DisplacerSettings settings_;
    std::optional<ModelChoice> choice_;
    std::unique_ptr<Displacer> displacer_;
    double gain_ = 1;
    std::optional<FilePattern> mask_;
    std::string mask_channel_;
    std::vector<std::string> warnings_;
};

/// Size of a map, for the report.
struct MapStatistics {
    double rms = 0, largest = 0;  ///< of |d| [px]
};
MapStatistics statistics(const DisplacementMap& map);

/// Writes channels u, v in pixels, or the STMap R = (x + dx + 0.5)/width, G = 1 - (y + dy + 0.5)/height, B = 1.
void write_displacement(const std::filesystem::path& file, const DisplacementMap& map, const PixelWindow& display);
void write_stmap(const std::filesystem::path& file, const DisplacementMap& map, const PixelWindow& display);

}  // namespace eikonal
