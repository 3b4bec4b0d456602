/// A shot whose depth and matte are read from files, frame by frame: what is needed beside the footage itself.
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
    bool state_errors = false;        ///< as ShotSettings
    std::stop_token stop;             ///< as ShotSettings
};

/// Immutable, thread-safe. Errors as Shot's, DepthInput's and MatteInput's.
class FootageShot {
  public:
    FootageShot(Scene scene, const FootageShotSettings& settings);

    const Shot& shot() const { return shot_; }
    const DepthInput& depth() const { return depth_; }
    /// The matte, if there is one.
    const std::optional<MatteInput>& matte() const { return matte_; }
    /// Shot's, and where depth comes from.
    std::vector<std::string> notes() const;

    /// The depth of a frame on the pixels `window`, as Shot takes it.
    SharedDepth depth_of(int frame, const FrameInput& input, const PixelWindow& window,
                         std::vector<Remark>& remarks) const;
    /// Maps at frame + offsets on `window`, masked. What is odd about depth and matte is added to `remarks`.
    Shot::Maps maps(int frame, const std::vector<double>& offsets, const FrameInput& input, const PixelWindow& window,
                    std::vector<Remark>& remarks) const;

    /// One line on the first file of depth or matte that is missing for one of `frames`.
    std::optional<std::string> missing_companion(const std::vector<int>& frames) const;
    /// Reads the files of one frame, to find wrong settings before any frame is begun. UserError: they cannot be what
    /// the settings say. What is wrong with the frame itself is left for its turn.
    void try_companions(int frame, const FrameInput& input, const PixelWindow& window) const;

  private:
    ShotSettings shot_settings(const Scene& scene, const FootageShotSettings& settings) const;

    DepthInput depth_;
    Shot shot_;
    std::optional<MatteInput> matte_;
};

}  // namespace eikonal
