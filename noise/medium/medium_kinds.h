/// The kinds of medium that a program knows: what `type` of a [[medium]] may be.
///
/// The list is made by CMake: one call of eikonal_medium() in noise/CMakeLists.txt registers a kind.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "noise/medium/medium_spec.h"

namespace eikonal {

struct MediumKind {
    std::string_view type;     ///< as the scene file's `type`
    MediumSpec (*defaults)();  ///< parameters of a table without keys
};

template <MediumParameters P>
MediumKind make_kind() {
    return {P::kType, [] { return MediumSpec(P{}); }};
}

/// In the order of registration.
std::span<const MediumKind> medium_kinds();

}  // namespace eikonal
