/// Where the picture's objects are, frame by frame: one distance, flat ground, a depth map's file or channel, values
/// that the caller gives, or what the scene's [plate] says. The result is axial depth in metres.
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

/// FILE[:CHANNEL] taken apart.
struct FileChannel {
    std::filesystem::path file;  ///< empty: the channel is in the frame's own picture
    std::string channel;
};
FileChannel split_channel(const std::string& text);

/// UserError if `file`, which the setting `setting` names, is a movie. It says how to make a sequence called `name`.
void refuse_movie(std::string_view setting, const std::filesystem::path& file, std::string_view name);

/// A window counted from the display window's corner: the camera's view begins there, wherever the file puts it.
PixelWindow seen_from(const PixelWindow& data, const PixelWindow& display);

/// What a frame brings along that may hold its depth.
struct FrameInput {
    const Picture* picture = nullptr;  ///< its picture, if it is one
    std::filesystem::path file;        ///< of the picture, for messages
    std::span<const float> values;     ///< given depth (DepthSettings::given), a value for each pixel of the window
};

/// Immutable, thread-safe.
class DepthInput {
  public:
    /// UserError: values out of range, nothing that tells a distance, settings without effect.
    DepthInput(const DepthSettings& settings, const Scene& scene);

    const Background& background() const { return background_; }
    /// The distance of all pixels, if it is one [m].
    std::optional<double> constant() const { return constant_; }
    /// The depth map's files; empty if there is none or it is a channel of the frame's own picture.
    const std::optional<FilePattern>& files() const { return files_; }
    bool inside_picture() const { return inside_picture_; }
    DepthMeeting meeting() const { return meeting_; }
    /// Depth that all frames of a shot have, seen by `camera`, as far as it is known before any frame.
    ShotDepth of_shot(const PixelWindow& display, const Camera& camera) const;
    /// One line that says where depth comes from.
    std::string description() const;

    /// Axial depth on the pixels `data`, at most background().deepest, as the camera sees them (seen_from). Remarks
    /// are those of the map, and ground that is nowhere seen. FrameError: depth_map.h.
    SharedDepth at(int frame, const FrameInput& input, const PixelWindow& data, const PixelWindow& display,
                   const Camera& camera, std::vector<Remark>& remarks) const;

  private:
    void use_map(const std::string& file_and_channel);
    void use_ground(const GroundSettings& ground);
    /// Counted from the display window's top.
    double horizon_row(const PixelWindow& display) const;
    /// Why no pixel is nearer than the background.
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

/// Depth as Displacer takes it, and its range [m]. Refers to `depth`.
struct DepthRange {
    DepthSource source;
    double nearest, farthest;
};
DepthRange range_of(const SharedDepth& depth);

}  // namespace eikonal
