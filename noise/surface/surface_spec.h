/// [[medium]] type = "surface": air over a heated or cooled plane, as the scene file states it.
///     T = T_a + (T_S - T_a) exp(-(x - origin)·normal/dropoff)        PHYSICS.md#heated-surface
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "noise/medium/ground_plane.h"
#include "noise/medium/medium_hooks.h"

namespace eikonal {

struct SurfaceSpec {
    static constexpr std::string_view kType = "surface";

    dvec3 origin{0, 0, 0};
    dvec3 normal{0, 1, 0};             ///< normalised by the reader
    double surface_temperature = 305;  ///< T_S [K] > 0
    double dropoff = 0.01;             ///< d0 [m] > 0
};

// Hooks of the medium interface (noise/medium/medium_spec.h).
Keys keys(SurfaceSpec& spec);
std::string why_still(const SurfaceSpec& spec, const OpticsSpec& optics);
std::unique_ptr<const Medium> build_medium(const SurfaceSpec& spec, const MediumSetting& setting);
std::optional<GroundPlane> mirage_ground(const SurfaceSpec& spec, const OpticsSpec& optics);

}  // namespace eikonal
