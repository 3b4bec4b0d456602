#include "warp/displace/models/first_order.h"

#include <algorithm>
#include <cmath>

#include "warp/displace/grid/aperture.h"
#include "warp/displace/grid/model.h"

namespace eikonal {
namespace {

template <class Medium>
void fill_node(DisplacementGrid& grid, const FirstOrderRays& model, const Medium& medium,
               const std::vector<dvec2>& disc, const Camera& camera, int row, int column) {
    const StraightRay ray =
        straight_ray(camera, (grid.column0 + column) * grid.spacing + 0.5, (grid.row0 + row) * grid.spacing + 0.5);
    const auto force = [&](double w) {
        const dvec3 p = ray.at(w);
        if (disc.size() == 1) return medium.sample(p).gradient;
        const double radius = 0.5 * model.aperture * (grid.perspective ? std::max(0.0, 1 - w / model.focus) : 1.0);
        dvec3 sum{0, 0, 0};
        for (const dvec2& q : disc) sum += medium.sample(p + radius * (q.x * camera.right + q.y * camera.up)).gradient;
        return sum / static_cast<double>(disc.size());
    };
    constexpr double kGauss = 0.21132486540518711775;  // (1 - 1/√3)/2
    dvec3 x{0, 0, 0}, slope{0, 0, 0};                  // of ∫∫F in axial depth
    double z = 0;
    const double cells = model.cells_along(ray.direction);  // a metre of depth
    const double scale = model.strength * ray.length * ray.length;
    for (std::size_t k = 0; k < grid.depths.size(); ++k) {
        const double target = grid.depths[k];
        const double steps = std::clamp(std::ceil((target - z) * cells), 1.0, kMostFirstOrderSteps);
        const double h = (target - z) / steps;
        for (double i = 0; i < steps; ++i) {
            const double w = z + i * h;
            const dvec3 f1 = force(w + kGauss * h), f2 = force(w + (1 - kGauss) * h);
            x += h * slope + (0.5 * h * h) * ((1 - kGauss) * f1 + kGauss * f2);
            slope += (0.5 * h) * (f1 + f2);
        }
        z = target;
        const dvec2 shift = image_shift(camera, ray, scale * x), rate = image_shift(camera, ray, scale * slope);
        grid.row(row, k)[column] += Node{static_cast<float>(shift.x), static_cast<float>(shift.y),
                                         static_cast<float>(rate.x), static_cast<float>(rate.y)};
    }
}

}  // namespace

void FirstOrderRays::fill(DisplacementGrid& grid, const Camera& camera) const {
    const std::vector<dvec2> disc = aperture_points(aperture, finest_cell());
    const auto fill_from = [&](const auto& field) {
        for (int r = 0; r < grid.rows; ++r)
            for (int c = 0; c < grid.columns; ++c) {
                check_cancelled(cancelled);
                fill_node(grid, *this, field, disc, camera, r, c);
            }
    };
    if (const auto* lattice = std::get_if<std::shared_ptr<const LatticeInstant>>(&medium))
        fill_from(**lattice);
    else
        fill_from(std::get<GradientNoiseInstant>(medium));
}

}  // namespace eikonal
