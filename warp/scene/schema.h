/// The keys of every table of a scene file: the one list of their names, meanings, ranges and contradictions.
/// Internal to the scene reader.
#pragma once

#include "warp/scene/scene.h"
#include "warp/scene/table.h"

namespace eikonal::scene_file {

/// Sizes for which FFTW has a fast transform are 2 … kLargestLattice without a prime factor above kLargestFactor.
inline constexpr int kLargestFactor = 13;
inline constexpr int kLargestLattice = 65536;

/// Reads the scene whose file's root table is `root`. Throws UserError.
void read_scene(const Entry& root, Scene& scene);

}  // namespace eikonal::scene_file
