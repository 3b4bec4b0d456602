#include "warp/shimmer/depth_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "noise/base/error.h"

namespace eikonal {
namespace {

/// UserError unless `metres` lies in the range of every length in a scene file.
void check_length(std::string_view what, double metres) {
    if (!(metres >= kSmallestPositive && metres <= kLargestValue))
        throw UserError(
            fmt::format("{} {:g} must be from {:g} to {:g} m", what, metres, kSmallestPositive, kLargestValue));
}

/// Converts depth along the pixels' rays to axial depth. Every depth is limited to kNearestDepth … deepest.
void make_axial(DepthBuffer& buffer, const PixelWindow& seen, const Camera& camera, float deepest) {
    const bool oblique = buffer.along_ray && camera.projection == Projection::Perspective;
    const float nearest = std::min(kNearestDepth, deepest);
    for (int y = 0; y < seen.height; ++y)
        for (int x = 0; x < seen.width; ++x) {
            float& z = buffer.metres[static_cast<std::size_t>(y) * static_cast<std::size_t>(seen.width) +
                                     static_cast<std::size_t>(x)];
            if (oblique) {
                const dvec2 s = camera.slope(seen.x0 + x + 0.5, seen.y0 + y + 0.5);
                z = static_cast<float>(z / std::sqrt(1 + s.x * s.x + s.y * s.y));
            }
            z = std::max(std::min(z, deepest), nearest);
        }
}

}  // namespace

FileChannel split_channel(const std::string& text) {
    std::error_code ignored;
    const auto colon = text.rfind(':');
    if (colon == std::string::npos || std::filesystem::exists(text, ignored)) return {text, ""};
    if (text.find('/', colon) != std::string::npos) return {text, ""};
    return {text.substr(0, colon), text.substr(colon + 1)};
}

void refuse_movie(std::string_view setting, const std::filesystem::path& file, std::string_view name) {
    if (is_movie(file))
        throw UserError(fmt::format(
            "{}: '{}' is a movie, and numbers a pixel come from pictures; make a sequence of it first, e.g. "
            "ffmpeg -i {} {}.%04d.png",
            setting, file.string(), file.filename().string(), name));
}

DepthInput::DepthInput(const DepthSettings& s, const Scene& scene)
    : meeting_(s.depth_meeting.value_or(DepthMeeting::March)), given_(s.given) {
    options_.type = s.depth_type.value_or(DepthType::Z);
    options_.range = s.depth_range;
    KnownDepth known{KnownDepth::Kind::Constant, s.distance, {}, s.far};
    if (s.depth || s.given) {
        known.kind = KnownDepth::Kind::Map;
        if (s.depth_range) known.farthest_code = std::max((*s.depth_range)[0], (*s.depth_range)[1]);
        if (s.depth) use_map(*s.depth);
    } else if (!s.distance && (s.ground || scene.plate.ground)) {
        known.kind = KnownDepth::Kind::Ground;
        use_ground(s.ground ? *s.ground : GroundSettings{(*scene.plate.ground)[0], (*scene.plate.ground)[1], true});
    } else {
        constant_ = constant_distance(scene, known);
    }
    background_ = background_of(scene, known);
    const double far = options_.far = background_.far;
    if (constant_ && *constant_ > far)
        throw UserError(
            fmt::format("`far` {:g} is nearer than the distance {:g}; give a larger `far` or a smaller `distance`", far,
                        *constant_));
    if (constant_ && s.depth_meeting)
        throw UserError(
            "`depth_meeting`: has no meaning where everything is at one distance; give `depth` or `ground`");
    if (known.kind == KnownDepth::Kind::Map) check_depth_options(options_);
    check_length("`depth_range`: the farthest distance", far);  // the other settings are within the range already
}

void DepthInput::use_map(const std::string& file_and_channel) {
    const FileChannel split = split_channel(file_and_channel);
    options_.channel = split.channel;
    inside_picture_ = split.file.empty();
    if (inside_picture_ && split.channel.empty())
        throw UserError(fmt::format(
            "`depth`: '{}' names neither a file nor a channel; give FILE, FILE:CHANNEL or :CHANNEL", file_and_channel));
    if (inside_picture_) return;
    refuse_movie("`depth`", split.file, "depth");
    files_ = FilePattern::parse(split.file);
}

void DepthInput::use_ground(const GroundSettings& ground) {
    ground_ = ground;
    check_length("`ground`: the camera's height", ground.height);
}

ShotDepth DepthInput::of_shot(const PixelWindow& display, const Camera& camera) const {
    if (constant_) return {*constant_, meeting_};
    if (!ground_ && (!files_ || files_->is_sequence())) return {{}, meeting_};
    std::vector<Remark> told_later;
    try {
        return {at(0, {}, display, display, camera, told_later), meeting_};
    } catch (const FrameError&) {
        return {{}, meeting_};  // an error of the map is reported with the first frame
    }
}

std::string DepthInput::description() const {
    const double far = background_.far;
    if (constant_) return fmt::format("everything at {:g} m along the axis", *constant_);
    if (ground_) return fmt::format("flat ground {:g} m below the camera, background at {:g} m", ground_->height, far);
    const bool goes_back = background_.mirage && background_.is_open();
    const std::string background =
        fmt::format("background at {:g} m{}", far, goes_back ? ", or where the farthest thing is" : "");
    if (given_) return fmt::format("given for every pixel, {}", background);
    if (inside_picture_) return fmt::format("channel '{}' of the input, {}", options_.channel, background);
    return fmt::format("'{}'{}, {}", files_->text().string(),
                       options_.channel.empty() ? "" : fmt::format(" channel '{}'", options_.channel), background);
}

PixelWindow seen_from(const PixelWindow& data, const PixelWindow& display) {
    return {data.x0 - display.x0, data.y0 - display.y0, data.width, data.height};
}

double DepthInput::horizon_row(const PixelWindow& display) const {
    return ground_->fraction ? ground_->horizon * display.height : ground_->horizon;
}

std::string DepthInput::unseen_ground(const PixelWindow& display) const {
    const double row = horizon_row(display);
    if (row >= display.height)
        return fmt::format(
            "ground: the horizon, row {:g}, lies below the {} rows of the picture: all of it is background, at {:g} m",
            row, display.height, background_.far);
    return fmt::format(
        "ground: {:g} m below the camera, it is nowhere in the picture nearer than the background, at {:g} m; check "
        "height and horizon, or give a larger `far`",
        ground_->height, background_.far);
}

DepthPlane DepthInput::ground_plane(const PixelWindow& data, const PixelWindow& display, const Camera& camera) const {
    const double horizon = display.y0 + horizon_row(display);
    const double f = camera.f_px * camera.pixel_aspect;
    std::vector<float> metres(data.area());
    for (int y = 0; y < data.height; ++y) {
        const double below = data.y0 + y + 0.5 - horizon;
        const double z = below > 0 ? std::min(ground_->height * f / below, background_.far) : background_.far;
        const auto row = metres.begin() + static_cast<std::ptrdiff_t>(y) * data.width;
        std::fill(row, row + data.width, static_cast<float>(z));
    }
    return {seen_from(data, display), std::move(metres)};
}

DepthBuffer DepthInput::stored(int frame, const FrameInput& input, const PixelWindow& data,
                               const PixelWindow& display) const {
    if (given_) {
        if (input.values.size() != data.area())
            throw UserError(fmt::format("`depth`: frame {} comes with {} values, and the picture has {} x {} pixels",
                                        frame, input.values.size(), data.width, data.height));
        return depth_from_values({input.values.begin(), input.values.end()}, fmt::format("frame {}", frame), options_,
                                 data);
    }
    if (!inside_picture_) return read_depth(files_->at(frame), options_, data, display);
    if (input.picture == nullptr)
        throw UserError(fmt::format("`depth` :{}: a movie holds no depth channel; name a file", options_.channel));
    return depth_from_picture(*input.picture, input.file, options_, data, display);
}

SharedDepth DepthInput::at(int frame, const FrameInput& input, const PixelWindow& data, const PixelWindow& display,
                           const Camera& camera, std::vector<Remark>& remarks) const {
    if (constant_) return *constant_;
    if (ground_) {
        DepthPlane plane = ground_plane(data, display, camera);
        if (plane.nearest() >= static_cast<float>(background_.far))
            remarks.push_back({"ground_unseen", unseen_ground(display)});
        return plane;
    }
    const PixelWindow seen = seen_from(data, display);
    DepthBuffer buffer = stored(frame, input, data, display);
    remarks.insert(remarks.end(), buffer.remarks.begin(), buffer.remarks.end());
    make_axial(buffer, seen, camera, static_cast<float>(background_.deepest));
    if (background_.mirage) put_background_behind(buffer.metres, background_.far);
    return DepthPlane(seen, std::move(buffer.metres));
}

DepthRange range_of(const SharedDepth& depth) {
    if (const auto* distance = std::get_if<double>(&depth)) return {*distance, *distance, *distance};
    const auto& plane = std::get<DepthPlane>(depth);
    return {&plane, plane.nearest(), plane.farthest()};
}

}  // namespace eikonal
