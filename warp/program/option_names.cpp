#include "warp/program/option_names.h"

#include <algorithm>
#include <array>

namespace eikonal {
namespace {

/// The settings that occur in messages of the libraries.
constexpr std::array<std::string_view, 21> kSettings{
    "codec", "depth",  "depth_meeting", "depth_range", "depth_type", "distance",   "far",
    "fov",   "frames", "gain",          "ground",      "integrator", "light_rays", "mask",
    "model", "models", "preset",        "quality",     "rms",        "set",        "tolerance"};

bool is_setting(std::string_view name) {
    return std::find(kSettings.begin(), kSettings.end(), name) != kSettings.end();
}

}  // namespace

std::string with_options(std::string_view message) {
    std::string text;
    while (true) {
        const std::size_t begin = message.find('`');
        const std::size_t end = begin == message.npos ? begin : message.find('`', begin + 1);
        if (end == message.npos) return text.append(message);
        std::string name(message.substr(begin + 1, end - begin - 1));
        if (is_setting(name)) {
            std::replace(name.begin(), name.end(), '_', '-');
            text.append(message.substr(0, begin)).append("--").append(name);
            message.remove_prefix(end + 1);
        } else {
            text.append(message.substr(0, end));
            message.remove_prefix(end);
        }
    }
}

}  // namespace eikonal
