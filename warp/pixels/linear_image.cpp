#include "warp/pixels/linear_image.h"

#include <algorithm>

namespace eikonal {

LinearImage cropped(const LinearImage& image, const PixelWindow& window) {
    LinearImage result{window, image.display, image.pixel_aspect, std::vector<float>(4 * window.area())};
    const int x_first = std::max(window.x0, image.data.x0);
    const int x_last = std::min(window.x0 + window.width, image.data.x0 + image.data.width);
    const int y_first = std::max(window.y0, image.data.y0);
    const int y_last = std::min(window.y0 + window.height, image.data.y0 + image.data.height);
    if (x_first >= x_last) return result;
    const auto offset = [](const PixelWindow& w, int x, int y) {
        return 4 * (static_cast<std::size_t>(y - w.y0) * static_cast<std::size_t>(w.width) +
                    static_cast<std::size_t>(x - w.x0));
    };
    for (int y = y_first; y < y_last; ++y)
        std::copy_n(image.pixels.begin() + static_cast<std::ptrdiff_t>(offset(image.data, x_first, y)),
                    4 * (x_last - x_first),
                    result.pixels.begin() + static_cast<std::ptrdiff_t>(offset(window, x_first, y)));
    return result;
}

}  // namespace eikonal
