#include "warp/displace/media/medium_bend.h"

#include <fmt/format.h>

#include <algorithm>

#include "warp/displace/models/second_order.h"

namespace eikonal {

double BendInstant::bent_step() const {
    return kStep;
}

std::optional<double> BendInstant::reach(bool) const {
    return {};
}

std::vector<DisplacementGrid> LaidOutInstant::filled(const PixelWindow& cover, bool every_pixel) const {
    std::vector<DisplacementGrid> result;
    for (DisplacementGrid grid : blank_) {
        if (every_pixel) grid.spacing = 1;
        grid.cover(cover);
        fill(grid);
        grid.scale(static_cast<float>(gain_));
        result.push_back(std::move(grid));
    }
    return result;
}

std::vector<DisplacementGrid> LaidOutInstant::grids(const PixelWindow&, const PixelWindow& cover) const {
    return filled(cover, false);
}

std::vector<DisplacementGrid> LaidOutInstant::every_pixel(const PixelWindow& window) const {
    return filled(window, true);
}

NodeLayout LaidOutInstant::layout() const {
    NodeLayout layout;
    for (const DisplacementGrid& grid : blank_) {
        layout.spacing = std::min(layout.spacing, grid.spacing);
        layout.depths.insert(layout.depths.end(), grid.depths.begin(), grid.depths.end());
    }
    return layout;
}

double MediumBend::corner_gain() const {
    const double L = straight_ray(shot_.reference, 0, 0).length;
    return L * L * L;
}

std::vector<std::string> MediumBend::beyond_far(double) const {
    return {};
}

std::string MediumBend::name() const {
    return fmt::format("medium.{}", medium_);
}

}  // namespace eikonal
