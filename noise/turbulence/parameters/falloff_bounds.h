/// Where turbulence is: everywhere, or below the height at which its falloff has left nothing of it.
#pragma once

#include <algorithm>
#include <glm/geometric.hpp>
#include <optional>

#include "noise/math/index_sample.h"
#include "noise/math/portable_math.h"
#include "noise/math/ray_bounds.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {

/// Lengths as those of MediumInstant. A falloff ends at g = kNegligibleIndex upward, and nowhere downward.
struct FalloffBounds {
    std::optional<Falloff> falloff;
    double step = 1;  ///< longest step inside [m]

    double height(const dvec3& x) const { return glm::dot(x - falloff->origin, falloff->normal); }
    double top() const { return -falloff->length * portable::log(kNegligibleIndex); }

    double longest_step(const dvec3& x) const { return step + (falloff ? std::max(0.0, height(x) - top()) : 0.0); }
    double clear_way(const dvec3& x, const dvec3& d) const {
        return falloff ? way_into_layer(height(x), glm::dot(d, falloff->normal), -kNever, top()) : 0;
    }
    double way_to_edge(const dvec3& x, const dvec3& d) const {
        return falloff ? way_to_plane(height(x), glm::dot(d, falloff->normal)) : kNever;
    }
};

}  // namespace eikonal
