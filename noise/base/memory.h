/// How much memory the program may take.
#pragma once

#include <cstdint>

namespace eikonal {

/// Half the memory of the machine or of its container, whichever is less [bytes]. One field may take this much, and so
/// may the frames that are in work.
std::uint64_t memory_limit();

}  // namespace eikonal
