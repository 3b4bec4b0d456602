/// One pixel of 1..4 channels in a vector of four floats, and the source that it is read from. Private to the
/// resampler.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "warp/resample/resample.h"

namespace eikonal::resampling {

/// Four floats. Absent channels are zero. Arithmetic is per lane, so the processor's vector width changes no bit.
using Pixel = float __attribute__((vector_size(16)));

template <int channels>
inline __attribute__((always_inline)) Pixel load(const float* p) {
    Pixel pixel{};
    if constexpr (channels == 4) {
        std::memcpy(&pixel, p, sizeof pixel);
    } else {
        pixel[0] = p[0];
        if constexpr (channels > 1) pixel[1] = p[1];
        if constexpr (channels > 2) pixel[2] = p[2];
    }
    return pixel;
}

/// The input. Pixel (0, 0) is the upper left corner of its window.
struct Source {
    const float* data;
    std::ptrdiff_t stride;  ///< floats
    int width, height;
    int channels;
    Edge edge;

    const float* at(int x, int y) const { return at(x, y, channels); }
    /// The same for a number of channels that is known at compile time.
    const float* at(int x, int y, int pixel) const { return data + y * stride + std::ptrdiff_t{x} * pixel; }
};

/// The sample that stands at any position i of an axis of n samples. -1 where it is black.
inline int resolve(std::int64_t i, int n, Edge edge) {
    if (i >= 0 && i < n) return static_cast<int>(i);
    switch (edge) {
        case Edge::Clamp:
            return i < 0 ? 0 : n - 1;
        case Edge::Wrap:
            return static_cast<int>((i % n + n) % n);
        case Edge::Mirror: {
            const std::int64_t period = 2 * std::int64_t{n};
            const std::int64_t k = (i % period + period) % period;
            return static_cast<int>(k < n ? k : period - 1 - k);
        }
        case Edge::Black:
            break;
    }
    return -1;
}

}  // namespace eikonal::resampling
