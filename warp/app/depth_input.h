/// Where the picture's objects are, frame by frame: --distance, --depth, --ground or the scene's [plate], as axial
/// depth.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "warp/app/options.h"
#include "warp/image/sequence.h"
#include "warp/scene/background.h"
#include "warp/scene/camera.h"
#include "warp/scene/scene.h"

namespace eikonal {

/// FILE[:CHANNEL] taken apart.
struct FileChannel {
    std::filesystem::path file;  ///< empty: the channel is in INPUT
    std::string channel;
};
FileChannel split_channel(const std::string& text);

/// UserError if `file`, given to `option`, is a movie; says how to make a sequence of it, which is called `name`.
void refuse_movie(std::string_view option, const std::filesystem::path& file, std::string_view name);

/// A window counted from the display window's corner: the camera's view begins there, wherever the file puts it.
PixelWindow seen_from(const PixelWindow& data, const PixelWindow& display);

class DepthInput {
  public:
    /// Decides the source. UserError: ill-formed values, nothing that tells a distance, options without effect.
    DepthInput(const DepthArguments& arguments, const Scene& scene);

    /// Distance of the background [m]: --far, else the map's range, the constant distance, the scene's, or
    /// default_far().
    double far() const { return far_; }
    /// What no depth is beyond [m]: far(), or kInfiniteDepth where a map in metres, or in 1/metres, tells the depth and
    /// no --far limits it.
    double deepest() const { return limited_ ? far_ : std::max<double>(far_, kInfiniteDepth); }
    /// Whether far() is a default.
    bool far_is_unstated() const { return far_unstated_; }
    /// Where far() comes from, for messages.
    std::string_view far_name() const { return far_in_scene_ ? "the scene's plate.far =" : "the default --far"; }
    /// Whether one distance holds for all pixels.
    std::optional<double> constant() const { return constant_; }
    /// The depth map's files; empty if there is none or it is a channel of INPUT.
    const std::optional<FilePattern>& files() const { return files_; }
    bool inside_input() const { return inside_input_; }
    /// Whether every frame has the same depth, where the camera's focal length stays.
    bool still() const { return constant_ || ground_ || (files_ && !files_->is_sequence()); }
    /// One line for --verbose.
    std::string description() const;

    /// Axial depth on `data`, limited to deepest(), as the camera sees it (seen_from). `input`: the frame's picture,
    /// where the map is a channel of it (or null). Remarks, beside those of the map: ground that is nowhere seen.
    DepthPlane plane(int frame, const Picture* input, const std::filesystem::path& input_file, const PixelWindow& data,
                     const PixelWindow& display, const Camera& camera, std::vector<Remark>& remarks) const;

  private:
    struct Ground {
        double height, horizon;
        bool fraction;  ///< horizon is a part of the display's height, else pixels
    };
    /// Counted from the display window's top.
    double horizon_row(const PixelWindow& display) const;
    /// Why no pixel is nearer than the background.
    std::string unseen_ground(const PixelWindow& display) const;
    DepthPlane ground_plane(const PixelWindow& data, const PixelWindow& display, const Camera& camera) const;

    DepthOptions options_;
    double far_;
    bool limited_, far_in_scene_, far_unstated_;
    bool mirage_;  ///< the background stays behind all else
    std::optional<double> constant_;
    std::optional<FilePattern> files_;
    std::optional<Ground> ground_;
    bool inside_input_ = false;
};

}  // namespace eikonal
