#include "warp/displace/media/surface/mirage_row.h"

#include <algorithm>

namespace eikonal {

void MirageRow::start_row(int y) {
    y_ = y;
    known_ = false;
    row_air_ = air_ != nullptr && air_->touches(y) ? air_ : nullptr;
}

void MirageRow::look_up(int x) {
    x_ = x;
    known_ = true;
    if (row_air_ == nullptr) {
        moves_ = mirage_->ray(x, y_, pixel_);
        return;
    }
    row_air_->pixel(x, y_, air_pixel_);
    moves_ = mirage_->ray(x, y_, pixel_, air_pixel_.launch);
    axes_ = mirage_->axes(x, y_);
}

Shift MirageRow::at(int x, double z) {
    if (!ready(x)) return {};
    Shift d = mirage_->shift(pixel_, z);
    if (row_air_ != nullptr) {
        const double way = std::min(z, pixel_.end);
        const auto [across, along] = row_air_->bend(air_pixel_, way);
        const dvec2 bend = (across * axes_.across + along * axes_.along) / (mirage_->perspective() ? way : 1.0);
        d.x += static_cast<float>(bend.x);
        d.y += static_cast<float>(bend.y);
    }
    return d;
}

MirageRows::MirageRows(std::span<const Mirage> mirages, const MirageAir* air) {
    for (const Mirage& mirage : mirages)
        rows_.emplace_back(mirage, air != nullptr && air->belongs_to(mirage) ? air : nullptr);
    for (MirageRow& row : rows_) benders_.push_back(&row);
}

KnownMirageRay::KnownMirageRay(std::span<const Mirage> mirages, int x, int y) {
    Mirage::PixelRay ray;
    moves_ = std::any_of(mirages.begin(), mirages.end(), [&](const Mirage& mirage) { return mirage.ray(x, y, ray); });
}

}  // namespace eikonal
