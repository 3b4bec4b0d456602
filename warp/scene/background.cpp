#include "warp/scene/background.h"

#include <algorithm>
#include <variant>

namespace eikonal {

bool has_mirage(const Scene& scene) {
    return std::any_of(scene.media.begin(), scene.media.end(), [&](const MediumSpec& medium) {
        const auto* surface = std::get_if<SurfaceSpec>(&medium);
        return surface != nullptr && surface->surface_temperature != scene.optics.ambient_temperature;
    });
}

double default_far(const Scene& scene) {
    const bool surfaces_only = std::all_of(scene.media.begin(), scene.media.end(), [](const MediumSpec& medium) {
        return std::holds_alternative<SurfaceSpec>(medium);
    });
    return surfaces_only && has_mirage(scene) ? kDefaultSky : kDefaultFar;
}

void put_background_behind(std::vector<float>& metres, double far) {
    const auto background = static_cast<float>(far);
    const float farthest = metres.empty() ? background : *std::max_element(metres.begin(), metres.end());
    std::replace(metres.begin(), metres.end(), background, std::max(background, farthest));
}

}  // namespace eikonal
