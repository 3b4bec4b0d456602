/// The depth of the picture's objects at each frame. It comes from one distance, flat ground, the file or channel of a
/// depth map, values that the caller gives, or the scene's [plate]. The result is axial depth in metres.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "warp/displace/choose_model.h"
#include "warp/image/plane.h"
#include "warp/image/sequence.h"
#include "warp/scene/background.h"
#include "warp/scene/camera.h"
#include "warp/scene/scene.h"
#include "warp/shimmer/settings.h"

namespace eikonal {

/// FILE[:CHANNEL], split.
struct FileChannel {
    std::filesystem::path file;  ///< empty: the channel is in the frame's own picture
    std::string channel;
};
FileChannel split_channel(const std::string& text);

/// UserError if `file`, which the setting `setting` names, is a movie. The message says how to make a sequence called
/// `name`.
void refuse_movie(std::string_view setting, const std::filesystem::path& file, std::string_view name);

/// The window counted from the display window's corner. The camera's view begins there, whatever origin the file has.
PixelWindow seen_from(const PixelWindow& data, const PixelWindow& display);

/// The parts of a frame that may hold its depth.
struct FrameInput {
    const Picture* picture = nullptr;  ///< the picture of the frame; null for a movie frame
    std::filesystem::path file;        ///< file of the picture, for messages
    std::span<const float> values;     ///< given depth (DepthSettings::given): one value a pixel of the window
};

/// Immutable, thread-safe.
class DepthInput {
  public:
    /// UserError: a value out of range, nothing that states a distance, or a setting without effect.
    DepthInput(const DepthSettings& settings, const Scene& scene);

    const Background& background() const { return background_; }
    /// The distance of all pixels if they share one [m].
    std::optional<double> constant() const { return constant_; }
    /// The files of the depth map. Nothing if there is none, or if it is a channel of the frame's own picture.
    const std::optional<FilePattern>& files() const { return files_; }
    bool inside_picture() const { return inside_picture_; }
    DepthMeeting meeting() const { return meeting_; }
    /// The depth that all frames of a shot share, as `camera` sees it, as far as it is known before any frame is read.
    ShotDepth of_shot(const PixelWindow& display, const Camera& camera) const;
    /// One line that says where depth comes from.
    std::string description() const;

    /// Axial depth of the pixels `data`, at most background().deepest, as the camera sees them (seen_from). Remarks are
    /// those on the map, and one on ground that no pixel shows. FrameError: as in depth_map.h.
    SharedDepth at(int frame, const FrameInput& input, const PixelWindow& data, const PixelWindow& display,
                   const Camera& camera, std::vector<Remark>& remarks) const;

  private:
    void use_map(const std::string& file_and_channel);
    void use_ground(const GroundSettings& ground);
    /// Row of the horizon, counted from the top of the display window [px].
    double horizon_row(const PixelWindow& display) const;
    /// The reason why no pixel is nearer than the background.
    std::string unseen_ground(const PixelWindow& display) const;
    DepthPlane ground_plane(const PixelWindow& data, const PixelWindow& display, const Camera& camera) const;
    DepthBuffer stored(int frame, const FrameInput& input, const PixelWindow& data, const PixelWindow& display) const;

    DepthOptions options_;
    Background background_;
    DepthMeeting meeting_ = DepthMeeting::March;
    std::optional<double> constant_;
    std::optional<FilePattern> files_;
    std::optional<GroundSettings> ground_;
    bool inside_picture_ = false;
    bool given_ = false;
};

/// Depth in the form that Displacer takes, and its range [m]. It refers to `depth`.
struct DepthRange {
    DepthSource source;
    double nearest, farthest;
};
DepthRange range_of(const SharedDepth& depth);

}  // namespace eikonal
