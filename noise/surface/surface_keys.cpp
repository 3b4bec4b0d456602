#include "noise/medium/keys.h"
#include "noise/medium/refractivity.h"
#include "noise/surface/surface_spec.h"

namespace eikonal {

Keys keys(SurfaceSpec& s) {
    return {
        {"origin", "a point of the surface", "m", s.origin},
        direction_key("normal", "of the surface", s.normal),
        {"surface_temperature", "", "K", s.surface_temperature, {between(kLeastTemperature, kGreatestTemperature)}},
        {"dropoff", "height over which the heat falls by e", "m", s.dropoff, {positive()}},
    };
}

}  // namespace eikonal
