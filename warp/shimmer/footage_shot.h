/// A shot whose depth and matte are read from files for each frame. It handles all files but the footage itself.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "warp/shimmer/depth_input.h"
#include "warp/shimmer/matte_input.h"
#include "warp/shimmer/shot.h"

namespace eikonal {

struct FootageShotSettings {
    ViewSettings view;
    DepthSettings depth;
    StrengthSettings strength;
    std::optional<std::string> mask;  ///< FILE[:CHANNEL] of a matte that scales the displacement, 0 … 1
    bool state_errors = false;        ///< as in ShotSettings
    std::stop_token stop;             ///< as in ShotSettings
};

/// Immutable, thread-safe. Errors: those of Shot, DepthInput and MatteInput.
class FootageShot {
  public:
    FootageShot(Scene scene, const FootageShotSettings& settings);

    const Shot& shot() const { return shot_; }
    const DepthInput& depth() const { return depth_; }
    /// The matte; nothing if there is none.
    const std::optional<MatteInput>& matte() const { return matte_; }
    /// The notes of Shot, and one on where depth comes from.
    std::vector<std::string> notes() const;

    /// The depth of a frame on the pixels `window`, in the form that Shot takes.
    SharedDepth depth_of(int frame, const FrameInput& input, const PixelWindow& window,
                         std::vector<Remark>& remarks) const;
    /// Maps at frame + offsets on `window`, scaled by the matte. Remarks on depth and matte are added to `remarks`.
    Shot::Maps maps(int frame, const std::vector<double>& offsets, const FrameInput& input, const PixelWindow& window,
                    std::vector<Remark>& remarks) const;

    /// One line that names the first missing file of depth or matte for `frames`; nothing if none is missing.
    std::optional<std::string> missing_companion(const std::vector<int>& frames) const;
    /// Reads the files of one frame to find wrong settings before any frame is begun. UserError: the files contradict
    /// the settings. Errors of the frame itself are ignored here and reported when its turn comes.
    void try_companions(int frame, const FrameInput& input, const PixelWindow& window) const;

  private:
    ShotSettings shot_settings(const Scene& scene, const FootageShotSettings& settings) const;

    DepthInput depth_;
    Shot shot_;
    std::optional<MatteInput> matte_;
};

}  // namespace eikonal
