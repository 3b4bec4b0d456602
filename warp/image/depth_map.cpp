#include "warp/image/depth_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "noise/base/error.h"

namespace eikonal {
namespace {

constexpr std::array<std::string_view, 3> kDepthChannels = {"Z", "depth.Z", "depth"};

/// Metres of a stored value before limits. Infinity for background.
double metres_of(double v, const DepthOptions& options) {
    constexpr double kBackground = std::numeric_limits<double>::infinity();
    if (!std::isfinite(v)) return kBackground;
    if (options.type == DepthType::Inverse) {
        if (v == 0) return kBackground;
        if (!options.range) return 1 / v;
        const double near = 1 / (*options.range)[0], far = 1 / (*options.range)[1];
        const double inverse = far + v * (near - far);
        return inverse == 0 ? kBackground : 1 / inverse;
    }
    if (options.range) return (*options.range)[0] + v * ((*options.range)[1] - (*options.range)[0]);
    return v == 0 ? kBackground : v;
}

/// Remarks about unusual values that are accepted.
std::vector<Remark> remarks_on(const Plane& plane, const std::filesystem::path& file, const DepthOptions& options) {
    const auto [lowest, highest] = finite_range(plane.values);
    if (options.range) {
        if (lowest >= 0 && highest <= 1) return {};
        return {
            {"depth_codes", fmt::format("'{}': channel '{}' holds values from {:g} to {:g}, but `depth_range` is for "
                                        "0 to 1; leave it out if they are metres",
                                        file.string(), plane.channel, lowest, highest)}};
    }
    if (options.type == DepthType::Inverse) return {};
    const auto zeros = std::count(plane.values.begin(), plane.values.end(), 0.0f);
    if (zeros == 0) return {};
    return {{"depth_zeros", fmt::format("'{}': {} of {} pixels are at 0 m and count as background, at `far` {:g}",
                                        file.string(), zeros, plane.values.size(), options.far)}};
}

/// Whether the file has any depth other than zero and NaN. A file without pixels on the window is all background.
bool holds_depth(const Plane& plane) {
    const PixelWindow &w = plane.window, &held = plane.held;
    for (int y = held.y0; y < held.y0 + held.height; ++y) {
        const auto row = plane.values.begin() + static_cast<std::ptrdiff_t>(y - w.y0) * w.width + (held.x0 - w.x0);
        if (std::any_of(row, row + held.width, [](float v) { return v != 0 && !std::isnan(v); })) return true;
    }
    return held.width == 0;
}

/// Turns stored values into metres, within the limits. Returns how many of them are negative.
std::size_t to_metres(std::vector<float>& values, const DepthOptions& options) {
    const auto far = static_cast<float>(std::min(options.far, static_cast<double>(kInfiniteDepth)));
    std::size_t negative = 0;
    for (float& value : values) {
        const double metres = metres_of(value, options);
        const bool below = metres < 0 || (std::isinf(value) && value < 0);
        negative += below ? 1 : 0;
        value = metres >= kInfiniteDepth ? std::max(far, kNearestDepth)
                                         : std::max(static_cast<float>(metres), kNearestDepth);
    }
    return negative;
}

}  // namespace

void check_depth_options(const DepthOptions& options) {
    if (!(options.far > 0) || !std::isfinite(options.far))
        throw UserError(fmt::format("`far` {}: must be a positive number of metres", options.far));
    if (!options.range) return;
    const auto [near, far] = *options.range;
    const bool inverse = options.type == DepthType::Inverse;
    const double least = std::min(near, far);
    if (!std::isfinite(near) || !std::isfinite(far) || near == far || (inverse ? least <= 0 : least < 0))
        throw UserError(fmt::format("`depth_range` {},{}: NEAR and FAR must be two different {} numbers of metres",
                                    near, far, inverse ? "positive" : "non-negative"));
}

DepthBuffer depth_from_picture(const Picture& picture, const std::filesystem::path& file, const DepthOptions& options,
                               const PixelWindow& data, const PixelWindow& display) {
    check_depth_options(options);
    constexpr float kOutside = std::numeric_limits<float>::infinity();
    Plane plane = take_plane(picture, file, options.channel, kDepthChannels, data, display, kOutside);
    if (plane.integer && !options.range)
        throw UserError(
            fmt::format("'{}': channel '{}' holds integers, which are no metres; say what they mean with "
                        "`depth_range` NEAR,FAR",
                        file.string(), plane.channel));
    if (!holds_depth(plane))
        throw FrameError(fmt::format(
            "'{}': channel '{}' holds no depth, only zeros{}", file.string(), plane.channel,
            std::any_of(plane.values.begin(), plane.values.end(), [](float v) { return std::isnan(v); }) ? " and NaN"
                                                                                                         : ""));

    std::vector<Remark> remarks = remarks_on(plane, file, options);
    if (const std::size_t negative = to_metres(plane.values, options); negative > 0)
        throw FrameError(
            fmt::format("'{}': channel '{}' has {} negative depth value{}; depth must be positive "
                        "(check `depth_type` and `depth_range`)",
                        file.string(), plane.channel, negative, negative == 1 ? "" : "s"));
    return {data, options.type == DepthType::Ray, std::move(plane.values), std::move(remarks)};
}

DepthBuffer depth_from_values(std::vector<float> values, std::string_view name, const DepthOptions& options,
                              const PixelWindow& window) {
    check_depth_options(options);
    if (const std::size_t negative = to_metres(values, options); negative > 0)
        throw FrameError(fmt::format("{}: {} of the depth values {} negative; depth must be positive", name, negative,
                                     negative == 1 ? "is" : "are"));
    return {window, options.type == DepthType::Ray, std::move(values), {}};
}

DepthBuffer read_depth(const std::filesystem::path& file, const DepthOptions& options, const PixelWindow& data,
                       const PixelWindow& display) {
    return depth_from_picture(read_picture(file), file, options, data, display);
}

}  // namespace eikonal
