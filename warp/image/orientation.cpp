#include "warp/image/orientation.h"

#include <cstring>

#include "warp/pixels/rows.h"

namespace eikonal {
namespace {

/// Meaning of Exif's numbers 1 … 8: exchange x and y of a stored pixel, then count x or y from the other side.
struct Turn {
    bool exchange, from_right, from_below;
};
constexpr std::array<Turn, 9> kTurns{{{},
                                      {false, false, false},
                                      {false, true, false},
                                      {false, true, true},
                                      {false, false, true},
                                      {true, false, false},
                                      {true, true, false},
                                      {true, true, true},
                                      {true, false, true}}};

/// Exchanges the values of two attributes, if the picture has both.
void exchange(OIIO::ImageSpec& spec, const char* a, const char* b) {
    const OIIO::ParamValue *first = spec.find_attribute(a), *second = spec.find_attribute(b);
    if (first == nullptr || second == nullptr) return;
    const OIIO::ParamValue of_a = *first, of_b = *second;
    spec.attribute(a, of_b.type(), of_b.data());
    spec.attribute(b, of_a.type(), of_a.data());
}

}  // namespace

bool may_lie_turned(std::string_view format) {
    return format != "openexr" && format != "dpx";
}

void turn_upright(Part& part) {
    OIIO::ImageSpec& spec = part.spec;
    const int orientation = spec.get_int_attribute("Orientation", 1);
    if (orientation < 2 || orientation > 8) return;
    const Turn turn = kTurns[static_cast<std::size_t>(orientation)];
    const int stored_width = spec.width;
    if (turn.exchange) {
        std::swap(spec.x, spec.y);
        std::swap(spec.width, spec.height);
        std::swap(spec.full_x, spec.full_y);
        std::swap(spec.full_width, spec.full_height);
        std::swap(spec.tile_width, spec.tile_height);
        exchange(spec, "XResolution", "YResolution");
        exchange(spec, "Exif:PixelXDimension", "Exif:PixelYDimension");
        if (const float aspect = spec.get_float_attribute("PixelAspectRatio", 1); aspect > 0 && aspect != 1)
            spec.attribute("PixelAspectRatio", 1 / aspect);
    }
    if (turn.from_right) spec.x = 2 * spec.full_x + spec.full_width - spec.x - spec.width;
    if (turn.from_below) spec.y = 2 * spec.full_y + spec.full_height - spec.y - spec.height;
    spec.attribute("Orientation", 1);
    if (part.pixels.empty()) return;

    const std::size_t bytes = part.pixel_bytes();
    std::vector<std::byte> upright(part.pixels.size());
    for_rows(spec.height, [&](int y) {
        std::byte* to = upright.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(spec.width) * bytes;
        const int across = turn.from_below ? spec.height - 1 - y : y;
        for (int x = 0; x < spec.width; ++x, to += bytes) {
            const int along = turn.from_right ? spec.width - 1 - x : x;
            const int row = turn.exchange ? along : across, column = turn.exchange ? across : along;
            const auto from = static_cast<std::size_t>(row) * static_cast<std::size_t>(stored_width) +
                              static_cast<std::size_t>(column);
            std::memcpy(to, part.pixels.data() + from * bytes, bytes);
        }
    });
    part.pixels = std::move(upright);
}

}  // namespace eikonal
