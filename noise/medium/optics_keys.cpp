#include "noise/medium/keys.h"
#include "noise/medium/optics.h"
#include "noise/medium/refractivity.h"

namespace eikonal {

static EnumNames<RayEquation> names(RayEquation) {
    static constexpr std::pair<std::string_view, RayEquation> list[] = {{"physical", RayEquation::Physical},
                                                                        {"paper", RayEquation::Paper}};
    return list;
}

static EnumNames<IndexModel> names(IndexModel) {
    static constexpr std::pair<std::string_view, IndexModel> list[] = {{"air", IndexModel::Air},
                                                                       {"paper", IndexModel::Paper}};
    return list;
}

Keys keys(OpticsSpec& o) {
    return {
        {"ray_equation", "convention of the ray equation", o.ray_equation},
        {"ambient_temperature", "", "K", o.ambient_temperature, {between(kLeastTemperature, kGreatestTemperature)}},
        {"index", "index of air from its temperature", o.index},
        {"exaggeration", "factor on index minus ambient index", o.exaggeration},
        Key("aperture", "diameter of the lens", "m", o.aperture, {at_least(0)}).note("0 is a point"),
    };
}

}  // namespace eikonal
