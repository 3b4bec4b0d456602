#include "warp/shimmer/footage_shot.h"

#include <fmt/format.h>

#include "noise/base/error.h"

namespace eikonal {

FootageShot::FootageShot(Scene scene, const FootageShotSettings& settings)
    : depth_(settings.depth, scene), shot_(scene, shot_settings(scene, settings)) {
    if (settings.mask) matte_.emplace(*settings.mask);
}

ShotSettings FootageShot::shot_settings(const Scene& scene, const FootageShotSettings& settings) const {
    ShotSettings shot{settings.view,     depth_.background(),   {{}, depth_.meeting()},
                      settings.strength, settings.state_errors, settings.stop};
    if (const auto distance = depth_.constant())
        shot.depth.shared = *distance;
    else if (settings.strength.tolerance || settings.strength.model.automatic)
        shot.depth =
            depth_.of_shot(settings.view.display, camera_path(scene, settings.view).at(scene.time.first_frame));
    return shot;
}

std::vector<std::string> FootageShot::notes() const {
    std::vector<std::string> lines = shot_.notes();
    lines.insert(lines.begin() + 1, "depth: " + depth_.description());
    return lines;
}

SharedDepth FootageShot::depth_of(int frame, const FrameInput& input, const PixelWindow& window,
                                  std::vector<Remark>& remarks) const {
    return depth_.at(frame, input, window, shot_.display(), shot_.displacer().camera(frame), remarks);
}

Shot::Maps FootageShot::maps(int frame, const std::vector<double>& offsets, const FrameInput& input,
                             const PixelWindow& window, std::vector<Remark>& remarks) const {
    const SharedDepth depth = depth_of(frame, input, window, remarks);
    std::vector<float> matte;
    if (matte_) matte = matte_->at(frame, window, shot_.display(), remarks);
    return shot_.maps(frame, offsets, depth, window, matte, remarks);
}

std::optional<std::string> FootageShot::missing_companion(const std::vector<int>& frames) const {
    std::error_code ignored;
    const auto check = [&](const FilePattern& files, const char* what) -> std::optional<std::string> {
        for (const int frame : frames) {
            const std::filesystem::path file = files.at(frame);
            if (!std::filesystem::exists(file, ignored))
                return fmt::format("frame {}: the {} '{}' does not exist; {}", frame, what, file.string(),
                                   files.is_sequence()
                                       ? "it must have every frame that is warped (`frames` names fewer)"
                                       : "check the name");
        }
        return {};
    };
    if (depth_.files())
        if (auto missing = check(*depth_.files(), "depth map")) return missing;
    return matte_ ? check(matte_->files(), "mask") : std::nullopt;
}

void FootageShot::try_companions(int frame, const FrameInput& input, const PixelWindow& window) const {
    std::vector<Remark> ignored;
    try {
        depth_of(frame, input, window, ignored);
        if (matte_) matte_->at(frame, window, shot_.display(), ignored);
    } catch (const FrameError&) {
        // The error is reported when the frame's turn comes.
    }
}

}  // namespace eikonal
