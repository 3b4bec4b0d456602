#include "reference/compare/resident_memory.h"

#include <malloc.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace eikonal::reference {
namespace {

/// The number in a line "KEY:  N kB" of the process's status, in bytes. 0 if there is no such line.
double status_bytes(const std::string& key) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with(key + ":")) return 1024 * std::stod(line.substr(key.size() + 1));
    return 0;
}

}  // namespace

MemoryWatch::MemoryWatch() {
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << "5";  // resets the peak to the present size
    start_ = status_bytes("VmRSS");
}

double MemoryWatch::most_grown() const {
    return std::max(0.0, status_bytes("VmHWM") - start_);
}

}  // namespace eikonal::reference
