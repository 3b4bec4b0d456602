#include "warp/displace/depth/depth_plane.h"

#include <tbb/parallel_for.h>

#include <cstddef>
#include <utility>

namespace eikonal {
namespace {

using Range = DepthPlane::Range;

Range unite(const Range& a, const Range& b) {
    return {std::min(a.nearest, b.nearest), std::max(a.farthest, b.farthest), std::min(a.front, b.front)};
}

}  // namespace

DepthPlane::DepthPlane(const PixelWindow& window, std::vector<float> metres)
    : window_(window), metres_(std::move(metres)) {
    block_columns_ = (window.width + kBlock - 1) / kBlock;
    block_rows_ = (window.height + kBlock - 1) / kBlock;
    const auto [low, high] = std::minmax_element(metres_.begin(), metres_.end());
    all_ = {*low, *high};
    blocks_.assign(static_cast<std::size_t>(block_columns_) * static_cast<std::size_t>(block_rows_),
                   {all_.farthest, all_.nearest});
    fronts_.resize(metres_.size());
    tbb::parallel_for(0, block_rows_, [&](int block) {
        Range* row = blocks_.data() + static_cast<std::size_t>(block) * static_cast<std::size_t>(block_columns_);
        for (int y = block * kBlock; y < std::min(window.height, (block + 1) * kBlock); ++y) {
            find_fronts(y);
            const auto line = static_cast<std::size_t>(y) * static_cast<std::size_t>(window.width);
            const float *z = metres_.data() + line, *front = fronts_.data() + line;
            for (int x = 0; x < window.width; ++x) row[x / kBlock] = unite(row[x / kBlock], {z[x], z[x], front[x]});
        }
    });
}

void DepthPlane::find_fronts(int y) {
    for (int x = 0; x < window_.width; ++x) {
        const int px = window_.x0 + x, py = window_.y0 + y;
        const float z = at(px, py), limit = kEdgeRatio * z;
        float front = std::numeric_limits<float>::infinity();
        for (int j = -1; j <= 1; ++j)
            for (int i = -1; i <= 1; ++i) {
                const float there = at(px + i, py + j);
                if (there >= limit) continue;
                const float slope = std::max(0.0f, 1 / z - 1 / at(px - i, py - j));
                if (kEdgeRatio / there > 1 / z + slope) front = std::min(front, there);
            }
        fronts_[index(px, py)] = front;
    }
}

std::vector<Range> DepthPlane::around(const PixelWindow& tile, int radius) const {
    const auto column = [&](int b) { return static_cast<std::size_t>(std::clamp(b, 0, block_columns_ - 1)); };
    const auto row = [&](int b) { return static_cast<std::size_t>(std::clamp(b, 0, block_rows_ - 1)); };
    const int x0 = block_column(tile.x0), x1 = block_column(tile.x0 + tile.width - 1);
    const int y0 = block_row(tile.y0), y1 = block_row(tile.y0 + tile.height - 1);
    // pixels within the radius lie within so many blocks
    const int blocks = std::min((radius + kBlock - 1) / kBlock, std::max(block_columns_, block_rows_));
    const auto columns = static_cast<std::size_t>(x1 - x0 + 1);
    const auto stride = static_cast<std::size_t>(block_columns_);
    // First along the rows, then along the columns.
    std::vector<Range> lines, result;
    for (int by = y0 - blocks; by <= y1 + blocks; ++by)
        for (int bx = x0; bx <= x1; ++bx) {
            Range r = blocks_[row(by) * stride + column(bx)];
            for (int i = bx - blocks; i <= bx + blocks; ++i) r = unite(r, blocks_[row(by) * stride + column(i)]);
            lines.push_back(r);
        }
    for (int by = y0; by <= y1; ++by)
        for (std::size_t bx = 0; bx < columns; ++bx) {
            Range r = lines[static_cast<std::size_t>(by - y0) * columns + bx];
            for (int j = 1; j <= 2 * blocks; ++j)
                r = unite(r, lines[static_cast<std::size_t>(by - y0 + j) * columns + bx]);
            result.push_back(r);
        }
    return result;
}

}  // namespace eikonal
