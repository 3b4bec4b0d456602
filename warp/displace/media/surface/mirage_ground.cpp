#include "warp/displace/media/surface/mirage_ground.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace eikonal {

MirageGround::MirageGround(const DepthPlane& depth, const PixelWindow& tile, int radius,
                           std::span<const Mirage> mirages)
    : depth_(depth), mirages_(mirages) {
    constexpr int kBlock = DepthPlane::kBlock;
    const PixelWindow& window = depth.window();
    const int x0 = std::max(tile.x0 - radius, window.x0), y0 = std::max(tile.y0 - radius, window.y0);
    const int x1 = std::min(tile.x0 + tile.width + radius, window.x0 + window.width) - 1;
    const int y1 = std::min(tile.y0 + tile.height + radius, window.y0 + window.height) - 1;
    column0_ = depth.block_column(x0);
    row0_ = depth.block_row(y0);
    columns_ = depth.block_column(x1) - column0_ + 1;
    rows_ = depth.block_row(y1) - row0_ + 1;
    nearest_object_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_),
                           std::numeric_limits<float>::max());
    const int bottom = std::min(window.y0 + window.height, window.y0 + (row0_ + rows_) * kBlock);
    const int right = std::min(window.x0 + window.width, window.x0 + (column0_ + columns_) * kBlock);
    for (int y = window.y0 + row0_ * kBlock; y < bottom; ++y) {
        float* row = nearest_object_.data() + static_cast<std::ptrdiff_t>((y - window.y0) / kBlock - row0_) * columns_;
        for (int x = window.x0 + column0_ * kBlock; x < right; ++x) {
            float& nearest = row[(x - window.x0) / kBlock - column0_];
            if (const float z = depth.at(x, y); z < nearest && !contains(x, y, z)) nearest = z;
        }
    }
}

bool MirageGround::is_mirror(int x, int y) const {
    Mirage::PixelRay pixel;
    return std::any_of(mirages_.begin(), mirages_.end(),
                       [&](const Mirage& mirage) { return mirage.ray(x, y, pixel) && std::isinf(pixel.end); });
}

bool MirageGround::is_clear(int x0, int y0, int x1, int y1, double z) const {
    const auto column = [this](int x) { return std::clamp(depth_.block_column(x) - column0_, 0, columns_ - 1); };
    const auto row = [this](int y) { return std::clamp(depth_.block_row(y) - row0_, 0, rows_ - 1); };
    for (int j = row(y0); j <= row(y1); ++j)
        for (int i = column(x0); i <= column(x1); ++i)
            if (nearest_object_[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) +
                                static_cast<std::size_t>(i)] <= z)
                return false;
    return true;
}

}  // namespace eikonal
