#include "warp/displace/media/sampled_variance.h"

#include <algorithm>
#include <cmath>

#include "noise/math/random.h"

namespace eikonal {
namespace {

/// Approximate number of steps of all rays of an estimate together, and the smallest number of rays.
constexpr double kRmsSteps = 256e3;
constexpr int kFewestRmsRays = 32;

}  // namespace

std::array<int, 2> spread_pixel(int i, int width, int height) {
    const auto along = [i](double step, int size) {
        const double place = step * (i + 1);
        return static_cast<int>((place - std::floor(place)) * size);
    };
    return {along(0.7548776662466927, width), along(0.5698402909980532, height)};
}

PixelPair::Shifts PixelPair::shifts(const std::vector<DisplacementGrid>& grids, double D) const {
    GridRows row;
    row.start(grids, window.y0);
    const Shift d = row.at(window.x0, D);
    if (window.height == 2) row.start(grids, window.y0 + 1);
    const Shift next = row.at(window.x0 + window.width - 1, D);
    return {d, window.width == 2 ? double{next.x} - d.x : double{next.y} - d.y};
}

SampledVariance sampled_variance(const ShotContext& shot, const MediumBend& bend, double D, double steps) {
    const RandomStream stream(1, "expected rms");
    const int rays = std::clamp(static_cast<int>(std::min(kRmsSteps / steps, 1e6)), kFewestRmsRays, kRmsRays);
    SampledVariance sum;
    for (int i = 0; i < rays; ++i) {
        check_stop(shot.settings.stop);
        const auto [x, y] = spread_pixel(i, shot.settings.width, shot.settings.height);
        const double t = i == 0 ? 0 : 1e3 * stream.uniform(static_cast<std::uint64_t>(i));
        const PixelPair pair(x, y, i % 2 == 0);
        const auto [d, slope] = pair.shifts(bend.at({shot.reference, t, D, D})->every_pixel(pair.window), D);
        sum.shift += (double{d.x} * d.x + double{d.y} * d.y) / rays;
        sum.slope += slope * slope / rays;
    }
    return sum;
}

}  // namespace eikonal
