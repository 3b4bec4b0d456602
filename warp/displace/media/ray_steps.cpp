#include "warp/displace/media/ray_steps.h"

#include <fmt/format.h>

#include <algorithm>

#include "warp/displace/models/first_order.h"

namespace eikonal {
namespace {

/// Steps of a first-order ray above which the user is warned that frames take long.
constexpr double kManySteps = 2000;

}  // namespace

double cells_a_metre(const ShotContext& shot, const Camera& camera, const dvec3& cell) {
    double most = 0;  // largest over the rays through the corners, which are the longest and most oblique
    for (const double x : {0, shot.settings.width})
        for (const double y : {0, shot.settings.height})
            most = std::max(most, glm::length(straight_ray(camera, x, y).direction / cell));
    return most;
}

std::string check_steps(const ShotContext& shot, const std::string& medium, const dvec3& cell) {
    const double most = cells_a_metre(shot, shot.reference, cell), steps = shot.settings.far * most;
    if (!(steps > kManySteps)) return {};
    const std::string what =
        fmt::format("{}: {} takes {:.0f} steps a ray, the path of {:g} m in cells of {:.3g} m", medium,
                    name_of(shot.own_model(Model::FirstOrder)), steps, shot.settings.far, 1 / most);
    const std::string remedy = "form=\"screens\", a shorter `far`, or a longer period or inner_scale";
    if (steps > kMostFirstOrderSteps)
        throw UserError(fmt::format("{}; allowed are at most {:g}; use {}", what, kMostFirstOrderSteps, remedy));
    return fmt::format("{}: frames take long; quicker are {}", what, remedy);
}

void check_frame_steps(const ShotContext& shot, const std::string& medium, const dvec3& cell, const Camera& camera,
                       double farthest) {
    const double steps = farthest * cells_a_metre(shot, camera, cell);
    if (!(steps > kMostFirstOrderSteps)) return;
    const std::string cause = is_beyond(farthest, shot.settings.far)
                                  ? fmt::format("depth reaches {:g} m, up to which", farthest)
                                  : "the camera has turned or zoomed out so that";
    throw FrameError(fmt::format(
        "{}: {} {} takes {:.0f} steps a ray; allowed are at most {:g}; use a shorter `far`, which limits depth, or a "
        "longer period or inner_scale",
        medium, cause, name_of(shot.own_model(Model::FirstOrder)), steps, kMostFirstOrderSteps));
}

std::string many_steps_beyond(const ShotContext& shot, const std::string& medium, const dvec3& cell, double farthest,
                              Model model) {
    const double steps = farthest * cells_a_metre(shot, shot.reference, cell);
    if (!(steps > kManySteps)) return {};
    return fmt::format("{}: {} takes {:.0f} steps a ray, and frames take long", medium, name_of(model), steps);
}

}  // namespace eikonal
