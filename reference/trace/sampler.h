/// Evenly spread sample positions within a pixel: the first two dimensions of Sobol's sequence, Owen-scrambled for each
/// pixel and purpose (the hash of Laine and Karras 2011, as in Burley 2020). A pure function of its arguments.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

namespace eikonal::reference {

/// Point `index` in [0, 1)². Any 4^m consecutive points from a multiple of 4^m fill every cell of a 2^m x 2^m grid.
/// stream: random bits. Different streams are independent.
glm::dvec2 spread_point(std::uint32_t index, std::uint64_t stream);

}  // namespace eikonal::reference
