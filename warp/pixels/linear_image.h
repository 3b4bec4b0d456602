/// The one form in which pictures, movie frames and the resampler exchange pixels.
///
/// Pixels are linear light (1 is reference white), premultiplied by alpha, interleaved float32, with row 0 on top. A
/// pixel always has four lanes: R, G, B, A. A picture without alpha has A = 1. A grey picture uses lane 0, and lanes 1
/// and 2 are 0. Pixel (x, y) has its centre at (x + 0.5, y + 0.5) in the coordinates of the display window's plane.
#pragma once

#include <cstddef>
#include <vector>

namespace eikonal {

/// A rectangle of pixels: columns x0 … x0 + width - 1, rows y0 … y0 + height - 1. Origins may be negative (overscan).
struct PixelWindow {
    int x0 = 0, y0 = 0, width = 0, height = 0;

    std::size_t area() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
    bool operator==(const PixelWindow&) const = default;
};

/// The pixels of a data window, and its place on the display window. Both windows share one coordinate system.
struct LinearImage {
    PixelWindow data;           ///< the pixels that exist
    PixelWindow display;        ///< the frame as shown. It may be smaller (overscan) or larger (crop) than `data`.
    double pixel_aspect = 1;    ///< width / height of a pixel
    std::vector<float> pixels;  ///< data.width * data.height * 4, lanes R G B A
};

/// The pixels of `image` on `window`. Black and transparent where `image` has none.
LinearImage cropped(const LinearImage& image, const PixelWindow& window);

}  // namespace eikonal
