/// [[medium]] type = "profile": the absolute index of all space in closed form, for validation. A profile must be the
/// only medium of a scene. PHYSICS.md#closed-forms
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <string_view>

#include "noise/medium/medium_hooks.h"

namespace eikonal {

using glm::dvec3;

enum class ProfileKind { Luneburg, FishEye, Linear, LinearSquared, Exponential, Rod, Sech };

struct ProfileSpec {
    static constexpr std::string_view kType = "profile";
    static constexpr bool kAbsoluteIndex = true;

    ProfileKind profile = ProfileKind::Luneburg;
    dvec3 center{0, 0, 0};
    dvec3 axis{0, 1, 0};  ///< normalised by the reader
    double radius = 1;    ///< [m] > 0
    double n0 = 1;        ///< > 0
    double slope = 0;     ///< per metre
    double g = 1;         ///< 1/m
};

// Hooks of the medium interface (noise/medium/medium_spec.h).
Keys keys(ProfileSpec& spec);
std::string why_still(const ProfileSpec& spec, const OpticsSpec& optics);
std::unique_ptr<const Medium> build_medium(const ProfileSpec& spec, const MediumSetting& setting);

}  // namespace eikonal
