/// How much memory a field may take.
#pragma once

#include <cstdint>

namespace eikonal {

/// Half the memory of the machine, or of the container [bytes]: what one field, or the frames under way, may take.
std::uint64_t memory_limit();

}  // namespace eikonal
