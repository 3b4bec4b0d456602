/// [[medium]] type = "puff": a kind of medium added in one folder and one line, as CONTRIBUTING.md describes. It is one
/// Gaussian cloud, n - n_ambient = index · exp(-|x - center|²/size²). The closed form of blobs can therefore judge it.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <string_view>

#include "noise/medium/medium_hooks.h"

namespace eikonal {

struct PuffSpec {
    static constexpr std::string_view kType = "puff";

    glm::dvec3 center{0, 0, 0};
    double size = 0.1;     ///< [m] > 0
    double index = -1e-5;  ///< n - n_ambient in the middle
};

Keys keys(PuffSpec& spec);
std::string why_still(const PuffSpec& spec, const OpticsSpec& optics);
std::unique_ptr<const Medium> build_medium(const PuffSpec& spec, const MediumSetting& setting);

}  // namespace eikonal
