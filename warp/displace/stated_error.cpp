#include "warp/displace/stated_error.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "warp/displace/depth/depth_plane.h"

namespace eikonal {
namespace {

/// Steps of the additive recurrence of the plastic number. Any number of its points fill the unit square evenly.
constexpr double kPlasticX = 0.7548776662466927, kPlasticY = 0.5698402909980532;

double fraction(double x) {
    return x - std::floor(x);
}

/// Sorts pixels by depth into kDepthStrata classes of equal size. Within a class they are sorted by displacement,
/// ascending and descending by turns. Depth and displacement then change little from one pixel to the next.
void stratify(std::vector<SamplePixel>& pixels) {
    const auto strength = [](const SamplePixel& p) { return p.map.x * p.map.x + p.map.y * p.map.y; };
    std::stable_sort(pixels.begin(), pixels.end(),
                     [](const SamplePixel& a, const SamplePixel& b) { return a.depth < b.depth; });
    for (std::size_t s = 0; s < kDepthStrata; ++s) {
        const auto at = [&](std::size_t i) {
            return pixels.begin() + static_cast<std::ptrdiff_t>(i * pixels.size() / kDepthStrata);
        };
        std::stable_sort(at(s), at(s + 1), [&](const SamplePixel& a, const SamplePixel& b) {
            return s % 2 == 0 ? strength(a) < strength(b) : strength(b) < strength(a);
        });
    }
}

/// Distance [px] within which an edge of the depth buffer makes a pixel count as beside it.
int edge_reach(const SamplePixel& p) {
    const float most = std::max(std::abs(p.map.x), std::abs(p.map.y));
    return std::clamp(static_cast<int>(std::ceil(std::min<float>(most, kFarthestEdge))), kEdgeReach, kFarthestEdge);
}

/// Removes the pixels beside an edge, unless fewer than `least` would remain.
void keep_smooth(std::vector<SamplePixel>& pixels, const DepthPlane& depth, std::size_t least) {
    int reach = 0;
    for (const SamplePixel& p : pixels) reach = std::max(reach, edge_reach(p));
    constexpr int kBlock = DepthPlane::kBlock;
    const PixelWindow& window = depth.window();
    const std::vector<DepthPlane::Range> blocks = depth.around(window, reach);
    const int columns = (window.width + kBlock - 1) / kBlock;
    const auto beside_edge = [&](const SamplePixel& p) {
        const int block = (p.y - window.y0) / kBlock * columns + (p.x - window.x0) / kBlock;
        if (!std::isfinite(blocks[static_cast<std::size_t>(block)].front)) return false;
        const int r = edge_reach(p);
        for (int y = p.y - r; y <= p.y + r; ++y)
            for (int x = p.x - r; x <= p.x + r; ++x)
                if (std::isfinite(depth.front(x, y))) return true;
        return false;
    };
    std::vector<SamplePixel> smooth;
    std::copy_if(pixels.begin(), pixels.end(), std::back_inserter(smooth), std::not_fn(beside_edge));
    if (smooth.size() >= least) pixels = std::move(smooth);
}

}  // namespace

std::vector<SamplePixel> choose_samples(const PixelWindow& window, const DepthSource& depth, const float* uv,
                                        int count) {
    const auto* plane = std::get_if<const DepthPlane*>(&depth);
    std::vector<SamplePixel> candidates;
    for (int i = 0; i < kErrorCandidates; ++i) {
        const int x = static_cast<int>(fraction(0.5 + (i + 1) * kPlasticX) * window.width);
        const int y = static_cast<int>(fraction(0.5 + (i + 1) * kPlasticY) * window.height);
        const float* d = uv + 2 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(window.width) +
                                   static_cast<std::size_t>(x));
        const int px = window.x0 + x, py = window.y0 + y;
        candidates.push_back({px, py, plane ? double{(*plane)->at(px, py)} : std::get<double>(depth), {d[0], d[1]}});
    }
    const auto wanted = static_cast<std::size_t>(count);
    if (plane) keep_smooth(candidates, **plane, wanted);
    stratify(candidates);
    std::vector<SamplePixel> samples;
    for (std::size_t i = 0; i < wanted; ++i)
        samples.push_back(candidates[(2 * i + 1) * candidates.size() / (2 * wanted)]);
    return samples;
}

std::vector<double> sample_errors(const std::vector<SamplePixel>& samples,
                                  const std::function<Shift(const SamplePixel&)>& truth) {
    std::vector<double> errors(samples.size());
    tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
        const Shift d = truth(samples[i]);
        const double ex = double{samples[i].map.x} - d.x, ey = double{samples[i].map.y} - d.y;
        errors[i] = std::sqrt(ex * ex + ey * ey);
    });
    return errors;
}

std::string shown_error(double px) {
    return std::isfinite(px) ? fmt::format("{:.2g} px", px) : "an unknown number of px";
}

StatedError statistics_of(std::vector<double> errors) {
    std::sort(errors.begin(), errors.end());
    const auto quantile = [&](double q) {
        return errors[static_cast<std::size_t>(q * static_cast<double>(errors.size() - 1) + 0.5)];
    };
    return {static_cast<int>(errors.size()), quantile(0.5), quantile(0.95), errors.back()};
}

}  // namespace eikonal
