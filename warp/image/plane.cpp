#include "warp/image/plane.h"

#include <OpenImageIO/strutil.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "noise/base/error.h"
#include "warp/image/pixel_codec.h"

namespace eikonal {
namespace {

struct Place {
    const Part* part;
    int channel;
};

std::string part_name(const Part& part) {
    return part.spec.get_string_attribute("name", part.spec.get_string_attribute("oiio:subimagename"));
}

std::optional<Place> find(const Picture& picture, std::string_view wanted) {
    for (const bool exact : {true, false}) {
        const auto same = [&](const std::string& name) {
            return exact ? name == wanted
                         : OIIO::Strutil::iequals(name, OIIO::string_view(wanted.data(), wanted.size()));
        };
        for (const Part& part : picture.parts)
            for (int c = 0; c < part.spec.nchannels; ++c) {
                const std::string name(part.spec.channel_name(c));
                if (same(name) || same(part_name(part) + "." + name)) return Place{&part, c};
            }
    }
    return std::nullopt;
}

/// All values of one channel on the part's data window.
std::vector<float> decode(const Place& place) {
    const Part& part = *place.part;
    std::vector<float> values(data_window(part).area());
    const auto type = static_cast<OIIO::TypeDesc::BASETYPE>(part.spec.channelformat(place.channel).basetype);
    decode_values(type, part.pixels.data() + part.channel_offset(place.channel), part.pixel_bytes(), values.data(), 1,
                  values.size());
    return values;
}

/// The first channel of a picture that holds one number a pixel.
std::optional<Place> single(const Picture& picture) {
    const Part& part = picture.parts.front();
    if (part.spec.nchannels == 1) return Place{&part, 0};
    if (part.groups.empty()) return std::nullopt;
    const ChannelGroup& main = part.groups.front();
    const Place first{&part, main.channel[0]};
    if (main.count == 1) return first;
    if (main.count != 3) return std::nullopt;
    const std::vector<float> red = decode(first);
    const bool grey = red == decode({&part, main.channel[1]}) && red == decode({&part, main.channel[2]});
    return grey ? std::optional(first) : std::nullopt;
}

std::string channel_list(const Picture& picture) {
    std::string list;
    for (const Part& part : picture.parts)
        for (const std::string& name : part.spec.channelnames) {
            const bool named = picture.parts.size() > 1 && !part_name(part).empty();
            list += (list.empty() ? "" : ", ") + (named ? part_name(part) + "." : "") + name;
        }
    return list;
}

/// Remarks about a matte. `chosen`: whether the user named none of the channels `all`.
void add_remarks(const Plane& matte, const std::filesystem::path& file, bool chosen, const std::string& all,
                 std::vector<Remark>& remarks) {
    if (chosen && all != matte.channel)
        remarks.push_back({"matte_channel",
                           fmt::format("mask: channel '{}' of '{}', which has {}", matte.channel, file.string(), all),
                           false});
    const auto [lowest, highest] = finite_range(matte.values);
    const auto strange =
        std::count_if(matte.values.begin(), matte.values.end(), [](float v) { return !std::isfinite(v); });
    if (lowest < 0 || highest > 1 || strange > 0)
        remarks.push_back(
            {"matte_codes",
             fmt::format("'{}': the mask holds values from {:g} to {:g}{}; they are limited to 0 … 1", file.string(),
                         lowest, highest, strange > 0 ? fmt::format(" and {} that are not finite", strange) : "")});
}

}  // namespace

Plane take_plane(const Picture& picture, const std::filesystem::path& file, std::string_view channel,
                 std::span<const std::string_view> preferred, const PixelWindow& data, const PixelWindow& display,
                 float outside) {
    std::optional<Place> place;
    if (!channel.empty()) {
        place = find(picture, channel);
    } else {
        for (const std::string_view name : preferred)
            if (!place) place = find(picture, name);
        if (!place) place = single(picture);
    }
    if (!place)
        throw UserError(fmt::format("'{}': {}; it has {}", file.string(),
                                    channel.empty()
                                        ? std::string("which channel to use is not clear, name it as FILE:CHANNEL")
                                        : fmt::format("there is no channel '{}'", channel),
                                    channel_list(picture)));

    const Part& part = *place->part;
    const PixelWindow own = data_window(part), shown = display_window(part);
    int dx = 0, dy = 0;  // shift from the footage's coordinates to the file's
    if (shown.width == display.width && shown.height == display.height) {
        dx = shown.x0 - display.x0;
        dy = shown.y0 - display.y0;
    } else if (own.width == data.width && own.height == data.height) {
        dx = own.x0 - data.x0;
        dy = own.y0 - data.y0;
    } else {
        throw FrameError(fmt::format("'{}' is {}x{} pixels, the picture {}x{}; they must have the same size",
                                     file.string(), shown.width, shown.height, display.width, display.height));
    }

    const std::vector<float> values = decode(*place);
    Plane plane{data,
                std::vector<float>(data.area(), outside),
                std::string(part.spec.channel_name(place->channel)),
                !part.spec.channelformat(place->channel).is_floating_point(),
                {}};
    const int x_first = std::max(data.x0, own.x0 - dx),
              x_last = std::min(data.x0 + data.width, own.x0 + own.width - dx);
    const int y_first = std::max(data.y0, own.y0 - dy),
              y_last = std::min(data.y0 + data.height, own.y0 + own.height - dy);
    if (x_first < x_last && y_first < y_last) plane.held = {x_first, y_first, x_last - x_first, y_last - y_first};
    for (int y = y_first; y < y_last && x_first < x_last; ++y) {
        const auto from = static_cast<std::ptrdiff_t>(y + dy - own.y0) * own.width + (x_first + dx - own.x0);
        const auto to = static_cast<std::ptrdiff_t>(y - data.y0) * data.width + (x_first - data.x0);
        std::copy_n(values.begin() + from, x_last - x_first, plane.values.begin() + to);
    }
    return plane;
}

std::array<float, 2> finite_range(std::span<const float> values) {
    std::array<float, 2> range{};
    bool any = false;
    for (const float v : values) {
        if (!std::isfinite(v)) continue;
        range = any ? std::array{std::min(range[0], v), std::max(range[1], v)} : std::array{v, v};
        any = true;
    }
    return range;
}

std::vector<float> read_matte(const std::filesystem::path& file, const std::string& channel, const PixelWindow& data,
                              const PixelWindow& display, std::vector<Remark>* remarks) {
    const Picture picture = read_picture(file);
    std::string_view wanted = channel;
    if (channel.empty())
        if (const auto alpha = find(picture, "A")) {
            const std::vector<float> values = decode(*alpha);
            if (std::any_of(values.begin(), values.end(), [](float v) { return v != 1; })) wanted = "A";
        }
    static constexpr std::array<std::string_view, 2> kNames = {"mask", "matte"};
    Plane plane = take_plane(picture, file, wanted, kNames, data, display, 0);
    if (remarks != nullptr) add_remarks(plane, file, channel.empty(), channel_list(picture), *remarks);
    for (float& v : plane.values) v = v > 0 ? std::min(v, 1.0f) : 0.0f;  // NaN too
    return std::move(plane.values);
}

}  // namespace eikonal
