/// Evenly spread sample positions in a pixel: the first two dimensions of Sobol's sequence, Owen-scrambled per pixel
/// and purpose (hash form of Laine and Karras 2011, as in Burley 2020). A pure function of its arguments.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

namespace eikonal::reference {

/// Point `index` in [0, 1)². Any 4^m consecutive points from a multiple of 4^m fill every cell of a 2^m x 2^m grid.
/// `stream`: 32 random bits; different streams are independent.
glm::dvec2 spread_point(std::uint32_t index, std::uint64_t stream);

}  // namespace eikonal::reference
