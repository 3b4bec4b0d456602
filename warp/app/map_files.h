/// Displacement maps as files.
#pragma once

#include <filesystem>

#include "warp/shimmer/displacement_map.h"

namespace eikonal {

/// Writes channels u and v [px].
void write_displacement(const std::filesystem::path& file, const DisplacementMap& map, const PixelWindow& display);
/// Writes an STMap with R = (x + dx + 0.5)/width, G = 1 - (y + dy + 0.5)/height, B = 1.
void write_stmap(const std::filesystem::path& file, const DisplacementMap& map, const PixelWindow& display);

}  // namespace eikonal
