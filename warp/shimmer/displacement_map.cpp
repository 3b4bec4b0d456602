#include "warp/shimmer/displacement_map.h"

#include <algorithm>
#include <cmath>

namespace eikonal {

MapStatistics statistics(const DisplacementMap& map) {
    double sum = 0, largest = 0;
    for (std::size_t i = 0; i < map.uv.size(); i += 2) {
        const double d2 = double{map.uv[i]} * map.uv[i] + double{map.uv[i + 1]} * map.uv[i + 1];
        sum += d2;
        largest = std::max(largest, d2);
    }
    return {std::sqrt(sum / (0.5 * static_cast<double>(std::max<std::size_t>(map.uv.size(), 2)))), std::sqrt(largest)};
}

}  // namespace eikonal
