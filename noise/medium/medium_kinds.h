/// The kinds of medium that a program knows: the possible values of `type` of a [[medium]].
///
/// The list is made by CMake: one call of eikonal_medium() in noise/CMakeLists.txt registers a kind.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "noise/medium/medium_spec.h"

namespace eikonal {

struct MediumKind {
    std::string_view type;     ///< the value of `type` in the scene file
    MediumSpec (*defaults)();  ///< the parameters of a table without other keys
};

template <MediumParameters P>
MediumKind make_kind() {
    return {P::kType, [] { return MediumSpec(P{}); }};
}

/// The kinds in the order of registration.
std::span<const MediumKind> medium_kinds();

}  // namespace eikonal
