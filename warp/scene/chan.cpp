#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "noise/base/error.h"
#include "noise/math/portable_math.h"
#include "warp/scene/camera.h"
#include "warp/scene/message.h"

namespace eikonal {

namespace {

constexpr std::size_t kColumns = 7, kColumnsWithFov = 8;

/// Rotation by an angle in degrees about an axis (0 x, 1 y, 2 z).
glm::dquat rotation(int axis, double degrees) {
    double s, c;
    portable::sincos_turns(degrees / 720, s, c);  // sine and cosine of half the angle
    return {c, axis == 0 ? s : 0, axis == 1 ? s : 0, axis == 2 ? s : 0};
}

std::string_view next_word(std::string_view& line) {
    constexpr std::string_view kBlank = " \t\r\f\v";
    line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(kBlank));
    line.remove_prefix(word.size());
    return word;
}

}  // namespace

std::vector<ChanKey> parse_chan(std::string_view text, const std::filesystem::path& name) {
    std::vector<ChanKey> keys;
    std::size_t columns = 0, line_number = 0;
    const auto refuse = [&](std::string_view what) {
        throw UserError(scene_file::printable(fmt::format("{}:{}: {}", name.string(), line_number, what)));
    };
    while (!text.empty()) {
        ++line_number;
        std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(line.size() + 1, text.size()));
        line = line.substr(0, line.find('#'));

        double v[kColumnsWithFov] = {};
        std::size_t n = 0;
        for (std::string_view word = next_word(line); !word.empty(); word = next_word(line), ++n) {
            if (n == kColumnsWithFov) refuse("more than 8 columns; expected: frame tx ty tz rx ry rz [vertical_fov]");
            const std::string_view digits = word.substr(word[0] == '+' ? 1 : 0);
            const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), v[n]);
            if (error != std::errc() || end != digits.data() + digits.size() || !(std::abs(v[n]) <= kLargestValue))
                refuse(
                    fmt::format("column {}: '{}' is no number within ±{}", n + 1, word.substr(0, 40), kLargestValue));
        }
        if (n == 0) continue;
        if (n < kColumns) refuse(fmt::format("{} columns; expected 7 or 8: frame tx ty tz rx ry rz [vertical_fov]", n));
        if (columns != 0 && n != columns) refuse(fmt::format("{} columns, but {} in the lines before", n, columns));
        columns = n;
        if (n == kColumnsWithFov && !(v[7] >= kSmallestFov && v[7] <= kLargestFov))
            refuse(fmt::format("vertical field of view {}, must be >= {} and <= {} degrees", v[7], kSmallestFov,
                               kLargestFov));
        if (!keys.empty() && !(v[0] > keys.back().frame))
            refuse(fmt::format("frame {} after frame {}; frames must increase", v[0], keys.back().frame));
        const glm::dquat orientation = rotation(1, v[5]) * rotation(0, v[4]) * rotation(2, v[6]);
        keys.push_back({v[0], {v[1], v[2], v[3]}, orientation, v[7]});
    }
    if (keys.empty()) refuse("no camera key; expected lines: frame tx ty tz rx ry rz [vertical_fov]");
    return keys;
}

}  // namespace eikonal
