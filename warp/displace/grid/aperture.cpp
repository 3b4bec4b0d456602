#include "warp/displace/grid/aperture.h"

#include <algorithm>
#include <cmath>

#include "noise/math/portable_math.h"

namespace eikonal {
namespace {

constexpr int kFewestRays = 7, kMostRays = 64;

}  // namespace

std::vector<glm::dvec2> aperture_points(double aperture, double cell) {
    if (aperture <= 0) return {{0, 0}};
    const double across = std::min(aperture / cell, 100.0);
    const int n = std::clamp(static_cast<int>(across * across), kFewestRays, kMostRays);
    std::vector<glm::dvec2> points;
    constexpr double kGoldenTurns = 0.38196601125010515;
    for (int j = 0; j < n; ++j) {
        double s, c;
        portable::sincos_turns(j * kGoldenTurns, s, c);
        const double r = std::sqrt((j + 0.5) / n);
        points.push_back({r * c, r * s});
    }
    return points;
}

}  // namespace eikonal
