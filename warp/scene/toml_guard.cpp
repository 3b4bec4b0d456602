#include "warp/scene/toml_guard.h"

namespace eikonal::scene_file {

std::size_t too_dotted_line(std::string_view text) {
    const auto digit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
    std::size_t dots = 0, line = 1;
    bool decimals = false;  // whether in the digits behind a decimal point, where a second dot separates keys
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '\n') ++line;
        if (text[i] != '.') {
            decimals = decimals && digit(i);
            continue;
        }
        decimals = !decimals && i > 0 && digit(i - 1) && digit(i + 1);
        if (!decimals && ++dots > kMostDots) return line;
    }
    return 0;
}

}  // namespace eikonal::scene_file
