#include "noise/base/memory.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace eikonal {

std::uint64_t memory_limit() {
    auto bytes =
        static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
    // A container may have less memory than the machine.
    std::ifstream file("/sys/fs/cgroup/memory.max");
    if (std::uint64_t own = 0; file >> own) bytes = std::min(bytes, own);
    return bytes / 2;
}

}  // namespace eikonal
