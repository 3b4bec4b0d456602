#include "warp/displace/meet.h"

#include <algorithm>
#include <cmath>

namespace eikonal {
namespace {

constexpr int kBlock = 8;
constexpr int kBisections = 10;
/// Steps of the march per pixel of screen path, and the most of them: a path of a hundred pixels is beyond any warp.
constexpr float kStepsPerPixel = 2;
constexpr int kMostSteps = 256;

int round_to_pixel(float v) { return static_cast<int>(std::floor(v + 0.5f)); }

/// Whether a ray at depth z, seen at pixel (x, y) + d, has met the buffer or is about to pass over a nearer edge.
bool blocked(const DepthPlane& depth, int x, int y, Shift d, double z) {
    const auto zf = static_cast<float>(z);
    if (depth.at(x + round_to_pixel(d.x), y + round_to_pixel(d.y)) <= zf) return true;
    const float fx = std::floor(d.x), fy = std::floor(d.y);
    const int xi = x + static_cast<int>(fx), yi = y + static_cast<int>(fy);
    const int nx = d.x > fx ? 1 : 0, ny = d.y > fy ? 1 : 0;
    for (int j = 0; j <= ny; ++j)
        for (int i = 0; i <= nx; ++i)
            if (depth.at(xi + i, yi + j) < kEdgeRatio * zf) return true;
    return false;
}

Shift march(BandRows& row, int x, int y, const DepthPlane& depth, int reach) {
    const DepthPlane::Range range = depth.around(x, y, reach);
    Shift near_d = row.at(x, range.nearest);
    if (range.nearest == range.farthest) return near_d;
    const Shift far_d = row.at(x, range.farthest);
    const float span = std::max(std::abs(far_d.x - near_d.x), std::abs(far_d.y - near_d.y));
    if (span < kAlike) return row.at(x, depth.at(x + round_to_pixel(far_d.x), y + round_to_pixel(far_d.y)));
    if (depth.at(x + round_to_pixel(near_d.x), y + round_to_pixel(near_d.y)) <= range.nearest) return near_d;

    // Even steps in inverse depth: the displacement of an object changes most where it is near.
    const int steps = std::clamp(static_cast<int>(std::ceil(kStepsPerPixel * span)) + 3, 4, kMostSteps);
    const double inverse_near = 1.0 / range.nearest, inverse_far = 1.0 / range.farthest;
    double before = range.nearest;
    for (int i = 1; i <= steps; ++i) {
        const double z = i == steps ? range.farthest
                                    : 1 / (inverse_near + (inverse_far - inverse_near) * i / static_cast<double>(steps));
        const Shift d = row.at(x, z);
        if (!blocked(depth, x, y, d, z)) {
            before = z;
            near_d = d;
            continue;
        }
        double behind = z;
        for (int b = 0; b < kBisections; ++b) {
            const double middle = 0.5 * (before + behind);
            const Shift m = row.at(x, middle);
            if (blocked(depth, x, y, m, middle)) {
                behind = middle;
            } else {
                before = middle;
                near_d = m;
            }
        }
        return near_d;
    }
    return near_d;
}

Shift fixed_point(BandRows& row, int x, int y, const DepthPlane& depth) {
    float z = depth.at(x, y);
    Shift d = row.at(x, z);
    for (int i = 0; i < kFixedPointSteps; ++i) {
        const float next = depth.at(x + round_to_pixel(d.x), y + round_to_pixel(d.y));
        if (next == z) break;
        z = next;
        d = row.at(x, z);
    }
    return d;
}

}  // namespace

DepthPlane::DepthPlane(const PixelWindow& window, std::vector<float> metres) : window_(window), metres_(std::move(metres)) {
    block_columns_ = (window.width + kBlock - 1) / kBlock;
    block_rows_ = (window.height + kBlock - 1) / kBlock;
    const auto [low, high] = std::minmax_element(metres_.begin(), metres_.end());
    nearest_ = *low;
    farthest_ = *high;
    blocks_.assign(static_cast<std::size_t>(block_columns_) * static_cast<std::size_t>(block_rows_), {farthest_, nearest_});
    for (int y = 0; y < window.height; ++y)
        for (int x = 0; x < window.width; ++x) {
            Range& block = blocks_[static_cast<std::size_t>(y / kBlock) * static_cast<std::size_t>(block_columns_) +
                                   static_cast<std::size_t>(x / kBlock)];
            const float z = metres_[static_cast<std::size_t>(y) * static_cast<std::size_t>(window.width) +
                                    static_cast<std::size_t>(x)];
            block.nearest = std::min(block.nearest, z);
            block.farthest = std::max(block.farthest, z);
        }
}

float DepthPlane::at(int x, int y) const {
    const int cx = std::clamp(x - window_.x0, 0, window_.width - 1);
    const int cy = std::clamp(y - window_.y0, 0, window_.height - 1);
    return metres_[static_cast<std::size_t>(cy) * static_cast<std::size_t>(window_.width) + static_cast<std::size_t>(cx)];
}

DepthPlane::Range DepthPlane::around(int x, int y, int reach) const {
    const int cx = x - window_.x0, cy = y - window_.y0;
    const auto block = [](int c, int count) { return std::clamp((c >= 0 ? c : c - kBlock + 1) / kBlock, 0, count - 1); };
    const int x0 = block(cx - reach, block_columns_), x1 = block(cx + reach, block_columns_);
    const int y0 = block(cy - reach, block_rows_), y1 = block(cy + reach, block_rows_);
    Range range = blocks_[static_cast<std::size_t>(y0) * static_cast<std::size_t>(block_columns_) + static_cast<std::size_t>(x0)];
    for (int j = y0; j <= y1; ++j)
        for (int i = x0; i <= x1; ++i) {
            const Range& b = blocks_[static_cast<std::size_t>(j) * static_cast<std::size_t>(block_columns_) + static_cast<std::size_t>(i)];
            range.nearest = std::min(range.nearest, b.nearest);
            range.farthest = std::max(range.farthest, b.farthest);
        }
    return range;
}

void meet_row(BandRows& row, int x0, int n, int y, const DepthPlane& depth, DepthMeeting how, int reach, float* uv) {
    for (int i = 0; i < n; ++i) {
        const int x = x0 + i;
        Shift d;
        switch (how) {
            case DepthMeeting::March: d = march(row, x, y, depth, reach); break;
            case DepthMeeting::FixedPoint: d = fixed_point(row, x, y, depth); break;
            case DepthMeeting::Own: d = row.at(x, depth.at(x, y)); break;
        }
        uv[2 * i] += d.x;
        uv[2 * i + 1] += d.y;
    }
}

}  // namespace eikonal
