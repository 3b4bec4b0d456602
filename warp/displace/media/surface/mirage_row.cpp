#include "warp/displace/media/surface/mirage_row.h"

#include <algorithm>

namespace eikonal {

void MirageRow::start(const Mirage& mirage, int y, double gain, const MirageAir* air) {
    mirage_ = &mirage;
    air_ = air;
    y_ = y;
    known_ = false;
    gain_ = static_cast<float>(gain);
}

void MirageRow::look(int x) {
    x_ = x;
    known_ = true;
    if (air_ == nullptr) {
        moves_ = mirage_->ray(x, y_, pixel_);
        return;
    }
    air_->pixel(x, y_, bent_);
    moves_ = mirage_->ray(x, y_, pixel_, bent_.launch);
    axes_ = mirage_->axes(x, y_);
}

Shift MirageRow::at(int x, double z) {
    if (!ready(x)) return {};
    Shift d = mirage_->shift(pixel_, z);
    if (air_ != nullptr) {
        const double way = std::min(z, pixel_.end);
        const auto [across, along] = air_->bend(bent_, way);
        const dvec2 more = (across * axes_.across + along * axes_.along) / (mirage_->perspective() ? way : 1.0);
        d.x += static_cast<float>(more.x);
        d.y += static_cast<float>(more.y);
    }
    return {gain_ * d.x, gain_ * d.y};
}

void MirageRow::add_constant_depth(int x0, int n, double z, float* uv) {
    for (int i = 0; i < n; ++i) {
        const Shift d = at(x0 + i, z);
        uv[2 * i] += d.x;
        uv[2 * i + 1] += d.y;
    }
}

}  // namespace eikonal
