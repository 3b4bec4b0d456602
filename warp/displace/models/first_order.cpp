#include "warp/displace/models/first_order.h"

#include "noise/math/portable_math.h"

namespace eikonal {
namespace {

constexpr int kMostDepths = 33;
/// The nearest depth of a grid, in cells. Within one cell X is a parabola in depth, so that nearer pixels need no
/// depths of their own.
constexpr double kNearestDepthCells = 0.1;

}  // namespace

DisplacementGrid FirstOrderRays::grid(const Camera& camera, double nearest, double farthest) const {
    DisplacementGrid grid;
    grid.perspective = camera.projection == Projection::Perspective;
    grid.interpolation = DepthInterpolation::Hermite;
    nearest = std::min(std::max(nearest, kNearestDepthCells / cells_along(camera.forward)), farthest);
    if (farthest > nearest) {
        const double wanted = (farthest - nearest) * cells_along(camera.forward) / 2;
        const int intervals = std::clamp(static_cast<int>(std::ceil(std::min(wanted, 1e6))), 1, kMostDepths - 1);
        for (int i = 0; i <= intervals; ++i) {
            // Near objects need finer depths, because their angles are larger.
            const double t = static_cast<double>(i) / intervals;
            grid.depths.push_back(i == 0           ? nearest
                                  : i == intervals ? farthest
                                                   : nearest * portable::pow(farthest / nearest, t));
        }
        grid.depths.erase(std::unique(grid.depths.begin(), grid.depths.end()), grid.depths.end());
    } else {
        grid.depths = {nearest};
    }
    grid.spacing = node_spacing(finest_cell() * camera.f_px / (grid.perspective ? farthest : 1.0));
    return grid;
}

}  // namespace eikonal
