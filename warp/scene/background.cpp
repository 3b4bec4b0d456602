#include "warp/scene/background.h"

#include <algorithm>
#include <variant>

#include "noise/medium/medium_spec.h"

namespace eikonal {

bool has_mirage(const Scene& scene) {
    return std::any_of(scene.media.begin(), scene.media.end(),
                       [&](const MediumSpec& medium) { return medium.mirage_ground(scene.optics).has_value(); });
}

double default_far(const Scene& scene) {
    const bool mirages_only = std::all_of(scene.media.begin(), scene.media.end(), [&](const MediumSpec& medium) {
        return medium.mirage_ground(scene.optics) || !medium.why_still(scene.optics).empty();
    });
    return mirages_only && has_mirage(scene) ? kDefaultSky : kDefaultFar;
}

double far_of_scene(const Scene& scene) {
    return scene.plate.far.value_or(scene.plate.distance.value_or(default_far(scene)));
}

double constant_distance(const Scene& scene, const KnownDepth& known) {
    if (known.distance) return *known.distance;
    return scene.plate.distance.value_or(scene.plate.far.value_or(default_far(scene)));
}

Background background_of(const Scene& scene, const KnownDepth& known) {
    const PlateSpec& plate = scene.plate;
    const bool constant = known.kind == KnownDepth::Kind::Constant;
    const bool code = known.kind == KnownDepth::Kind::Map && known.farthest_code;
    Background b;
    if (known.far)
        b.far = *known.far;
    else if (constant)
        b.far = constant_distance(scene, known);
    else if (code)
        b.far = *known.farthest_code;
    else
        b.far = plate.far.value_or(default_far(scene));
    const bool limited = known.far || code || known.kind != KnownDepth::Kind::Map;
    b.deepest = limited ? b.far : std::max<double>(b.far, kInfiniteDepth);
    b.stated = known.far || code || known.distance || plate.far || plate.distance;
    b.in_scene = plate.far.has_value();
    b.mirage = has_mirage(scene);
    return b;
}

void put_background_behind(std::vector<float>& metres, double far) {
    const auto background = static_cast<float>(far);
    const float farthest = metres.empty() ? background : *std::max_element(metres.begin(), metres.end());
    std::replace(metres.begin(), metres.end(), background, std::max(background, farthest));
}

}  // namespace eikonal
