#include "warp/app/map_files.h"

#include <string>
#include <vector>

#include "warp/image/picture.h"

namespace eikonal {

void write_displacement(const std::filesystem::path& file, const DisplacementMap& map, const PixelWindow& display) {
    static const std::vector<std::string> names{"u", "v"};
    write_float_exr(file, map.window, display, names, map.uv);
}

void write_stmap(const std::filesystem::path& file, const DisplacementMap& map, const PixelWindow& display) {
    static const std::vector<std::string> names{"R", "G", "B"};
    std::vector<float> st(3 * map.window.area());
    for (int row = 0; row < map.window.height; ++row)
        for (int column = 0; column < map.window.width; ++column) {
            const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(map.window.width) +
                           static_cast<std::size_t>(column);
            const double x = map.window.x0 - display.x0 + column + 0.5 + double{map.uv[2 * i]};
            const double y = map.window.y0 - display.y0 + row + 0.5 + double{map.uv[2 * i + 1]};
            st[3 * i] = static_cast<float>(x / display.width);
            st[3 * i + 1] = static_cast<float>(1 - y / display.height);
            st[3 * i + 2] = 1;
        }
    write_float_exr(file, map.window, display, names, st);
}

}  // namespace eikonal
