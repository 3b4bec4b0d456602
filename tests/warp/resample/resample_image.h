/// Pictures, maps and the call of the resampler that its tests share.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "warp/resample/resample.h"

namespace eikonal {

struct Image {
    Window window;
    int channels;
    std::vector<float> data;

    Image(Window w, int c)
        : window(w), channels(c), data(std::size_t(w.width) * std::size_t(w.height) * std::size_t(c)) {}
    float& at(int x, int y, int c = 0) {
        return data[(std::size_t(y - window.y0) * std::size_t(window.width) + std::size_t(x - window.x0)) *
                        std::size_t(channels) +
                    std::size_t(c)];
    }
    float at(int x, int y, int c = 0) const { return const_cast<Image*>(this)->at(x, y, c); }
    void fill(const std::function<float(int, int, int)>& f) {
        for (int y = window.y0; y < window.y0 + window.height; ++y)
            for (int x = window.x0; x < window.x0 + window.width; ++x)
                for (int c = 0; c < channels; ++c) at(x, y, c) = f(x, y, c);
    }
    std::ptrdiff_t stride() const { return std::ptrdiff_t{window.width} * channels; }
};

inline Image run(const Image& in, const Image& map, const ResampleOptions& options) {
    Image out(map.window, in.channels);
    resample({in.data.data(), in.window, in.channels, in.stride()}, {map.data.data(), map.window, map.stride()},
             {out.data.data(), out.window, out.channels, out.stride()}, options);
    return out;
}

inline Image constant_map(Window window, float u, float v) {
    Image map(window, 2);
    map.fill([&](int, int, int c) { return c == 0 ? u : v; });
    return map;
}

inline Image noise(Window window, int channels, unsigned seed, float low = 0, float high = 1) {
    Image image(window, channels);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(low, high);
    for (float& v : image.data) v = uniform(random);
    return image;
}

/// d = gradient of a sum of random waves; wavelengths of `shortest` ... 8 times that; rms of |d| in pixels.
inline Image shimmer(Window window, double shortest, double rms, unsigned seed) {
    Image map(window, 2);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> turn(0, 2 * std::numbers::pi);
    for (int m = 0; m < 16; ++m) {
        const double k = 2 * std::numbers::pi / (shortest * std::pow(8.0, m / 15.0)), angle = turn(random),
                     phase = turn(random);
        const double kx = k * std::cos(angle), ky = k * std::sin(angle);
        for (int y = 0; y < window.height; ++y)
            for (int x = 0; x < window.width; ++x) {
                const double wave = std::cos(kx * x + ky * y + phase) / std::pow(k, 1.5);
                map.at(window.x0 + x, window.y0 + y, 0) += static_cast<float>(kx * wave);
                map.at(window.x0 + x, window.y0 + y, 1) += static_cast<float>(ky * wave);
            }
    }
    double sum = 0;
    for (float v : map.data) sum += double{v} * v;
    const double gain = rms / std::sqrt(2 * sum / static_cast<double>(map.data.size()));
    for (float& v : map.data) v = static_cast<float>(v * gain);
    return map;
}

inline bool same_bits(const Image& a, const Image& b) {
    return a.data.size() == b.data.size() &&
           std::memcmp(a.data.data(), b.data.data(), a.data.size() * sizeof(float)) == 0;
}

}  // namespace eikonal
