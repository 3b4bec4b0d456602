#include "reference/compare/error_measures.h"

#include <fmt/format.h>
#include <jxl/butteraugli.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>

#include "warp/image/transfer.h"
#include "warp/pixels/depth_range.h"

namespace eikonal::reference {
namespace {

using Plane = std::vector<double>;

/// The value that a display shows for linear light.
float limited(float v) {
    return v > 0 ? std::min(v, 1.0f) : 0.0f;
}

Plane luma(std::span<const float> rgba) {
    Plane plane(rgba.size() / 4);
    for (std::size_t i = 0; i < plane.size(); ++i) {
        const auto code = [&](std::size_t c) { return from_linear(Transfer::SRGB, limited(rgba[4 * i + c])); };
        plane[i] = 0.2126 * code(0) + 0.7152 * code(1) + 0.0722 * code(2);
    }
    return plane;
}

/// The Gaussian-weighted mean around each pixel. Edge pixels are repeated.
Plane blurred(const Plane& in, int width, int height) {
    std::array<double, 2 * kSsimRadius + 1> weights{};
    double sum = 0;
    for (int k = -kSsimRadius; k <= kSsimRadius; ++k)
        sum += weights[static_cast<std::size_t>(k + kSsimRadius)] = std::exp(-k * k / (2 * kSsimSigma * kSsimSigma));
    for (double& w : weights) w /= sum;
    const auto pass = [&](const Plane& from, bool rows) {
        Plane to(from.size());
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                double value = 0;
                for (int k = -kSsimRadius; k <= kSsimRadius; ++k) {
                    const int px = rows ? std::clamp(x + k, 0, width - 1) : x;
                    const int py = rows ? y : std::clamp(y + k, 0, height - 1);
                    value += weights[static_cast<std::size_t>(k + kSsimRadius)] *
                             from[static_cast<std::size_t>(py) * static_cast<std::size_t>(width) +
                                  static_cast<std::size_t>(px)];
                }
                to[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] = value;
            }
        return to;
    };
    return pass(pass(in, true), false);
}

double ssim(const Plane& a, const Plane& b, int width, int height) {
    const auto products = [](const Plane& p, const Plane& q) {
        Plane result(p.size());
        std::transform(p.begin(), p.end(), q.begin(), result.begin(), std::multiplies<>());
        return result;
    };
    const auto blur = [&](const Plane& plane) { return blurred(plane, width, height); };
    const Plane mean_a = blur(a), mean_b = blur(b), aa = blur(products(a, a)), bb = blur(products(b, b)),
                ab = blur(products(a, b));
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double ma = mean_a[i], mb = mean_b[i];
        const double variances = aa[i] - ma * ma + bb[i] - mb * mb, covariance = ab[i] - ma * mb;
        sum += (2 * ma * mb + kSsimC1) * (2 * covariance + kSsimC2) /
               ((ma * ma + mb * mb + kSsimC1) * (variances + kSsimC2));
    }
    return sum / static_cast<double>(a.size());
}

double psnr(std::span<const float> a, std::span<const float> b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (i % 4 == 3) continue;
        const double d =
            double{from_linear(Transfer::SRGB, limited(a[i]))} - double{from_linear(Transfer::SRGB, limited(b[i]))};
        sum += d * d;
    }
    return -10 * std::log10(sum / (0.75 * static_cast<double>(a.size())));
}

double butteraugli(std::span<const float> a, std::span<const float> b, int width, int height) {
    // The library finds no difference in pictures of less than 8 pixels a side, so their edges are repeated.
    const int w = std::max(width, 8), h = std::max(height, 8);
    const auto light = [&](std::span<const float> rgba) {
        std::vector<float> rgb;
        rgb.reserve(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) {
                const auto i = static_cast<std::size_t>(std::min(y, height - 1) * width + std::min(x, width - 1));
                for (std::size_t c = 0; c < 3; ++c) rgb.push_back(limited(rgba[4 * i + c]));
            }
        return rgb;
    };
    const std::vector<float> p = light(a), q = light(b);
    const JxlPixelFormat format{3, JXL_TYPE_FLOAT, JXL_NATIVE_ENDIAN, 0};
    const std::unique_ptr<JxlButteraugliApi, decltype(&JxlButteraugliApiDestroy)> eye(JxlButteraugliApiCreate(nullptr),
                                                                                      JxlButteraugliApiDestroy);
    JxlButteraugliApiSetHFAsymmetry(eye.get(), 1);  // lost and new detail count alike
    const std::unique_ptr<JxlButteraugliResult, decltype(&JxlButteraugliResultDestroy)> result(
        JxlButteraugliCompute(eye.get(), static_cast<std::uint32_t>(w), static_cast<std::uint32_t>(h), &format,
                              p.data(), p.size() * sizeof p[0], &format, q.data(), q.size() * sizeof q[0]),
        JxlButteraugliResultDestroy);
    if (!result) throw std::runtime_error(fmt::format("libjxl compares no pictures of {} × {}", width, height));
    return JxlButteraugliResultGetDistance(result.get(), kButteraugliNorm);
}

/// Whether a silhouette passes between the second and the third of four neighbours in a row.
bool jumps(const std::array<double, 4>& q) {
    const double limit = kSilhouetteJump * std::max(q[1], q[2]);
    if (q[1] == q[2] || std::abs(q[1] - q[2]) <= limit) return false;
    return std::abs(2 * q[1] - q[0] - q[2]) > limit && std::abs(2 * q[2] - q[3] - q[1]) > limit;
}

}  // namespace

ErrorStatistics error_statistics(std::vector<float> errors) {
    ErrorStatistics s;
    s.count = errors.size();
    if (errors.empty()) return s;
    std::sort(errors.begin(), errors.end());
    const auto quantile = [&](double q) {
        return double{errors[static_cast<std::size_t>(q * static_cast<double>(errors.size() - 1) + 0.5)]};
    };
    for (const float e : errors) s.mean += e;
    s.mean /= static_cast<double>(errors.size());
    s.p50 = quantile(0.5);
    s.p95 = quantile(0.95);
    s.p99 = quantile(0.99);
    s.largest = errors.back();
    return s;
}

PictureError picture_error(std::span<const float> a, std::span<const float> b, int width, int height) {
    return {psnr(a, b), ssim(luma(a), luma(b), width, height), butteraugli(a, b, width, height)};
}

std::vector<int> silhouette_distance(std::span<const float> depth, int width, int height, Projection projection) {
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(std::clamp(y, 0, height - 1)) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(std::clamp(x, 0, width - 1));
    };
    const auto q = [&](int x, int y) {
        const double z = std::min(depth[at(x, y)], kInfiniteDepth);
        return projection == Projection::Perspective ? 1 / z : z;
    };
    std::vector<int> distance(depth.size(), width + height);
    const auto look = [&](int x, int y, int dx, int dy) {
        if (x + dx >= width || y + dy >= height) return;
        if (jumps({q(x - dx, y - dy), q(x, y), q(x + dx, y + dy), q(x + 2 * dx, y + 2 * dy)}))
            distance[at(x, y)] = distance[at(x + dx, y + dy)] = 0;
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            look(x, y, 1, 0);
            look(x, y, 0, 1);
        }
    // Two passes, forth and back over the rows. A pixel is one more than the least of the neighbours before it.
    const auto spread = [&](int x, int y, int back) {
        int& d = distance[at(x, y)];
        for (const auto& [nx, ny] : {std::array{x - back, y}, {x - 1, y - back}, {x, y - back}, {x + 1, y - back}})
            if (nx >= 0 && nx < width && ny >= 0 && ny < height) d = std::min(d, distance[at(nx, ny)] + 1);
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) spread(x, y, 1);
    for (int y = height - 1; y >= 0; --y)
        for (int x = width - 1; x >= 0; --x) spread(x, y, -1);
    return distance;
}

}  // namespace eikonal::reference
