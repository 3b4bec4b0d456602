#include "warp/app/depth_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "noise/base/error.h"

namespace eikonal {
namespace {

/// The range of every length in a scene file.
void check_length(std::string_view what, double metres) {
    if (!(metres >= kSmallestPositive && metres <= kLargestValue))
        throw UserError(
            fmt::format("{} {:g} must be from {:g} to {:g} m", what, metres, kSmallestPositive, kLargestValue));
}

double parse_part(const std::string& all, std::string_view text) {
    const std::optional<double> value = parse_number(text);
    if (!value)
        throw UserError(fmt::format(
            "--ground: '{}' must be HEIGHT,HORIZON: metres above the ground, and the horizon's row from the top in "
            "pixels or as a part of the height like 55%",
            all));
    return *value;
}

}  // namespace

FileChannel split_channel(const std::string& text) {
    std::error_code ignored;
    const auto colon = text.rfind(':');
    if (colon == std::string::npos || std::filesystem::exists(text, ignored)) return {text, ""};
    if (text.find('/', colon) != std::string::npos) return {text, ""};
    return {text.substr(0, colon), text.substr(colon + 1)};
}

void refuse_movie(std::string_view option, const std::filesystem::path& file, std::string_view name) {
    if (is_movie(file))
        throw UserError(fmt::format(
            "{}: '{}' is a movie, and numbers a pixel come from pictures; make a sequence of it first, e.g. "
            "ffmpeg -i {} {}.%04d.png",
            option, file.string(), file.filename().string(), name));
}

DepthInput::DepthInput(const DepthArguments& a, const Scene& scene) {
    const PlateSpec& plate = scene.plate;
    const double unstated = default_far(scene);
    mirage_ = has_mirage(scene);
    options_.type = a.type.value_or(DepthType::Z);
    options_.range = a.range;
    if (a.depth) {
        const FileChannel split = split_channel(*a.depth);
        options_.channel = split.channel;
        inside_input_ = split.file.empty();
        if (inside_input_ && split.channel.empty())
            throw UserError(fmt::format(
                "--depth: '{}' names neither a file nor a channel; give FILE, FILE:CHANNEL or :CHANNEL", *a.depth));
        if (!inside_input_) {
            refuse_movie("--depth", split.file, "depth");
            files_ = FilePattern::parse(split.file);
        }
    } else if (a.distance) {
        constant_ = a.distance;
    } else if (a.ground) {
        const auto comma = a.ground->find(',');
        if (comma == std::string::npos) parse_part(*a.ground, "?");
        std::string_view horizon = std::string_view(*a.ground).substr(comma + 1);
        const bool fraction = horizon.ends_with('%');
        if (fraction) horizon.remove_suffix(1);
        ground_ = Ground{parse_part(*a.ground, std::string_view(*a.ground).substr(0, comma)),
                         parse_part(*a.ground, horizon), fraction};
        if (!fraction && ground_->horizon > 0 && ground_->horizon < 1)
            throw UserError(
                fmt::format("--ground: the horizon's row {0} is within the first pixel; did you mean {1:g}%?", horizon,
                            ground_->horizon * 100));
        if (fraction) ground_->horizon /= 100;
        check_length("--ground: the camera's height", ground_->height);
    } else if (plate.ground) {
        ground_ = Ground{(*plate.ground)[0], (*plate.ground)[1], true};
    } else {
        constant_ = plate.distance.value_or(plate.far.value_or(unstated));
    }
    const std::optional<double> range_far =
        a.range ? std::optional(std::max((*a.range)[0], (*a.range)[1])) : std::nullopt;
    limited_ = a.far || range_far || !a.depth;
    far_in_scene_ = plate.far.has_value();
    far_unstated_ = !(a.far || range_far || a.distance || plate.far || plate.distance);
    if (a.far)
        far_ = *a.far;
    else if (constant_)
        far_ = *constant_;
    else
        far_ = range_far.value_or(plate.far.value_or(unstated));
    if (constant_ && *constant_ > far_)
        throw UserError(
            fmt::format("--far {:g} is nearer than the distance {:g}; give a larger --far or a smaller --distance",
                        far_, *constant_));
    if (constant_ && a.meeting)
        throw UserError(
            "--depth-meeting: has no meaning where everything is at one distance; give --depth or --ground");
    options_.far = far_;
    if (a.depth) check_depth_options(options_);
    check_length("--depth-range: the farthest distance", far_);  // all others are within it already
}

std::string DepthInput::description() const {
    if (constant_) return fmt::format("everything at {:g} m along the axis", *constant_);
    if (ground_) return fmt::format("flat ground {:g} m below the camera, background at {:g} m", ground_->height, far_);
    const std::string background =
        fmt::format("background at {:g} m{}", far_, mirage_ && !limited_ ? ", or where the farthest thing is" : "");
    if (inside_input_) return fmt::format("channel '{}' of the input, {}", options_.channel, background);
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
            row, display.height, far_);
    return fmt::format(
        "ground: {:g} m below the camera, it is nowhere in the picture nearer than the background, at {:g} m; check "
        "height and horizon, or give a larger --far",
        ground_->height, far_);
}

DepthPlane DepthInput::ground_plane(const PixelWindow& data, const PixelWindow& display, const Camera& camera) const {
    const double horizon = display.y0 + horizon_row(display);
    const double f = camera.f_px * camera.pixel_aspect;
    std::vector<float> metres(data.area());
    for (int y = 0; y < data.height; ++y) {
        const double below = data.y0 + y + 0.5 - horizon;
        const double z = below > 0 ? std::min(ground_->height * f / below, far_) : far_;
        const auto row = metres.begin() + static_cast<std::ptrdiff_t>(y) * data.width;
        std::fill(row, row + data.width, static_cast<float>(z));
    }
    return {seen_from(data, display), std::move(metres)};
}

DepthPlane DepthInput::plane(int frame, const Picture* input, const std::filesystem::path& input_file,
                             const PixelWindow& data, const PixelWindow& display, const Camera& camera,
                             std::vector<Remark>& remarks) const {
    if (constant_) return {seen_from(data, display), std::vector<float>(data.area(), static_cast<float>(*constant_))};
    if (ground_) {
        DepthPlane plane = ground_plane(data, display, camera);
        if (plane.nearest() >= static_cast<float>(far_)) remarks.push_back({"ground_unseen", unseen_ground(display)});
        return plane;
    }
    if (inside_input_ && input == nullptr)
        throw UserError(fmt::format("--depth :{}: a movie holds no depth channel; name a file", options_.channel));
    DepthBuffer buffer = inside_input_ ? depth_from_picture(*input, input_file, options_, data, display)
                                       : read_depth(files_->at(frame), options_, data, display);
    remarks.insert(remarks.end(), buffer.remarks.begin(), buffer.remarks.end());
    const auto deepest = static_cast<float>(this->deepest());
    for (int y = 0; y < data.height; ++y)
        for (int x = 0; x < data.width; ++x) {
            float& z = buffer.metres[static_cast<std::size_t>(y) * static_cast<std::size_t>(data.width) +
                                     static_cast<std::size_t>(x)];
            if (buffer.along_ray && camera.projection == Projection::Perspective) {
                const dvec2 s = camera.slope(data.x0 - display.x0 + x + 0.5, data.y0 - display.y0 + y + 0.5);
                z = static_cast<float>(z / std::sqrt(1 + s.x * s.x + s.y * s.y));
            }
            z = std::max(std::min(z, deepest), std::min(kNearestDepth, deepest));
        }
    if (mirage_) put_background_behind(buffer.metres, far_);
    return {seen_from(data, display), std::move(buffer.metres)};
}

}  // namespace eikonal
