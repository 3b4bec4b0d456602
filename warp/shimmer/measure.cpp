#include "warp/shimmer/measure.h"

#include <algorithm>
#include <chrono>

#include "warp/shimmer/depth_input.h"

namespace eikonal {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Time to resample a whole picture [s], estimated from its middle rows.
double resample_seconds(const DisplacementMap& map, Filter filter) {
    const int rows = std::min(kMeasuredRows, map.window.height);
    const PixelWindow strip{0, (map.window.height - rows) / 2, map.window.width, rows};
    const std::vector<float> plate(4 * strip.area(), 0.5F);
    std::vector<float> out(plate.size());
    const float* uv = map.uv.data() + 2 * static_cast<std::size_t>(strip.y0) * static_cast<std::size_t>(strip.width);
    const auto start = Clock::now();
    resample({plate.data(), strip, 4, 4 * strip.width}, {uv, strip, 2 * strip.width},
             {out.data(), strip, 4, 4 * strip.width}, {filter});
    return static_cast<double>(map.window.height) / rows * seconds_since(start);
}

}  // namespace

FrameMeasure measure_frame(const Shot& shot, double frame, const SharedDepth& depth, std::optional<Filter> filter) {
    const PixelWindow picture{0, 0, shot.display().width, shot.display().height};
    const DepthRange range = range_of(depth);
    FrameMeasure measure;
    DisplacementMap map{picture, std::vector<float>(2 * picture.area())};
    auto start = Clock::now();
    const Displacer::Instant instant = shot.displacer().at(frame, range.nearest, range.farthest, shot.gain());
    measure.instant = seconds_since(start);
    start = Clock::now();
    instant.map(picture, range.source, shot.meeting(), map.uv.data());
    measure.map = seconds_since(start);
    measure.size = statistics(map);
    measure.error = instant.stated_error(picture, range.source, shot.meeting(), map.uv.data());
    if (filter) measure.resample = resample_seconds(map, *filter);
    return measure;
}

}  // namespace eikonal
