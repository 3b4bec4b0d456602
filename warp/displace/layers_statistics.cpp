#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "noise/math/random.h"
#include "warp/displace/layers.h"

namespace eikonal {
namespace {

/// Blobs that the expected rms is taken over, instants that have so many between them, those with blobs if a wind,
/// which is dear, carries these, and pixels of each.
constexpr double kRmsBlobs = 600;
constexpr int kFewestRmsInstants = 2, kMostRmsInstants = 512, kMostRmsWinds = 16, kFewestRmsPixels = 16;

int rms_instants(const BlobsSpec& spec, const BlobCloud& cloud) {
    if (spec.sources.empty()) return 1;
    return static_cast<int>(
        std::clamp<double>(std::ceil(kRmsBlobs / cloud.most()), kFewestRmsInstants, kMostRmsInstants));
}

/// So many are never all away at once, and so many pixels give their rms roughly.
constexpr double kManyBlobs = 64;
constexpr int kRoughRays = 64;
/// How far from its middle a blob moves anything to speak of [σ], and more blobs than this leave no pixel still.
constexpr double kRmsReach = 3;
constexpr std::size_t kDenseBlobs = 4096;
/// Steps that all rays of an estimate take together, about, and the fewest rays that it is taken from.
constexpr double kRmsSteps = 256e3;
constexpr int kFewestRmsRays = 32;
/// Pairs of pixels among blobs.
constexpr std::size_t kBlobPairs = 96;

/// d of a pixel for an object at D, and how it changes to the next one, to the right or below.
struct PixelPair {
    PixelWindow window;

    PixelPair(int x, int y, bool across) : window{x, y, across ? 2 : 1, across ? 1 : 2} {}
    struct Shifts {
        Shift d;
        double slope;
    };
    Shifts shifts(const std::vector<DisplacementGrid>& grids, double D) const {
        GridRows row;
        row.start(grids, window.y0);
        const Shift d = row.at(window.x0, D);
        if (window.height == 2) row.start(grids, window.y0 + 1);
        const Shift next = row.at(window.x0 + window.width - 1, D);
        return {d, window.width == 2 ? double{next.x} - d.x : double{next.y} - d.y};
    }
};

/// Pixel i of many that keep apart, however many there are.
std::array<int, 2> spread_pixel(int i, int width, int height) {
    const auto along = [i](double step, int size) {
        const double place = step * (i + 1);
        return static_cast<int>((place - std::floor(place)) * size);
    };
    return {along(0.7548776662466927, width), along(0.5698402909980532, height)};
}

/// Where pixels are drawn from that blobs may move: half of them from the whole picture, half from around a blob that
/// is in it.
class BlobPixels {
  public:
    BlobPixels(const std::vector<SeenBlob>& blobs, const Camera& camera, const PixelWindow& picture)
        : picture_(picture) {
        if (blobs.size() > kDenseBlobs) return;
        for (const SeenBlob& blob : blobs) {
            const bool perspective = camera.projection == Projection::Perspective;
            const double scale = perspective ? 1 / std::max(blob.forward, blob.sigma) : 1;
            const dvec2 middle = camera.pixel(scale * dvec2(blob.right, blob.up));
            const double reach = kRmsReach * blob.sigma * scale * camera.f_px;
            const auto low = [](double edge) { return static_cast<int>(std::clamp(std::floor(edge), 0.0, 1e9)); };
            const auto high = [](double edge, int size) {
                return static_cast<int>(std::clamp<double>(std::ceil(edge), 0, size));
            };
            const int x0 = low(middle.x - reach), x1 = high(middle.x + reach, picture.width);
            const int y0 = low(middle.y - reach * camera.pixel_aspect),
                      y1 = high(middle.y + reach * camera.pixel_aspect, picture.height);
            if (x1 > x0 && y1 > y0) around_.push_back({x0, y0, x1 - x0, y1 - y0});
        }
    }
    /// Pixel i, and what one drawn evenly from the picture would count in its place.
    struct Drawn {
        int x, y;
        double weight;
    };
    Drawn draw(const RandomStream& stream, int i) const {
        if (around_.empty()) {
            const auto [x, y] = spread_pixel(i, picture_.width, picture_.height);
            return {x, y, 1};
        }
        auto [x, y] = spread_pixel(i / 2, picture_.width, picture_.height);
        if (i % 2 == 1) {
            const auto at = [&](std::uint64_t c, double size) {
                return static_cast<int>(stream.uniform(4 * static_cast<std::uint64_t>(i) + c) * size);
            };
            const PixelWindow& w = around_[static_cast<std::size_t>(at(1, static_cast<double>(around_.size())))];
            x = w.x0 + at(2, w.width);
            y = w.y0 + at(3, w.height);
        }
        double times = 0;
        for (const PixelWindow& w : around_)
            if (x >= w.x0 && y >= w.y0 && x < w.x0 + w.width && y < w.y0 + w.height)
                times += static_cast<double>(picture_.area()) / static_cast<double>(w.area());
        return {x, y, 1 / (0.5 + 0.5 * times / static_cast<double>(around_.size()))};
    }

  private:
    PixelWindow picture_;
    std::vector<PixelWindow> around_;
};

}  // namespace

double MediaLayers::expected_variance(const MediumLayer& layer, double D, bool rough) const {
    const double pixels = perspective() ? reference_.f_px / D : reference_.f_px;  // of one metre of x1
    const double strength2 = strength_ * strength_;
    const double aspect2 = reference_.pixel_aspect * reference_.pixel_aspect;
    if (const auto* screens = std::get_if<ScreenField>(&layer.field))
        return strength2 * (1 + aspect2) * screens->displacement_angle_variance(D) * (pixels * D) * (pixels * D);
    if (const auto* lattice = std::get_if<LatticeField>(&layer.field)) {
        const PathRays rays = nearest_axis(reference_, scene_.optics.aperture);
        const auto x1 = lattice->displacement_variance(rays.axis, D, rays.aperture);
        return strength2 * 0.5 * (1 + aspect2) * (x1[0] + x1[1]) * pixels * pixels;
    }
    if (const auto* cloud = std::get_if<BlobCloud>(&layer.field))
        return rough && cloud->most() >= kManyBlobs
                   ? blob_variance(layer, D, 1, kRoughRays)
                   : blob_variance(layer, D, rms_instants(std::get<BlobsSpec>(scene_.media[layer.medium]), *cloud),
                                   kRmsRays);
    return sampled_variance(layer, D).shift;
}

/// Over pixels, most of them among the blobs, and over `instants`, the first of them t = 0: a shot begins there, and
/// finds its wind made. Fewer if there is a wind and blobs at many of them.
double MediaLayers::blob_variance(const MediumLayer& layer, double D, int instants, int rays) const {
    const RandomStream stream(1, "expected rms");
    const auto& spec = std::get<BlobsSpec>(scene_.media[layer.medium]);
    const bool carried = !spec.sources.empty() && spec.wind && spec.wind->rms > 0;
    const int each = std::max(rays / instants, kFewestRmsPixels);
    double sum = 0;
    int tried = 0;
    for (int with_blobs = 0; tried < instants && !(carried && with_blobs == kMostRmsWinds); ++tried) {
        check_cancelled(settings_.cancelled);
        const double t = tried == 0 ? 0 : 1e3 * stream.uniform((1ULL << 32) + static_cast<std::uint64_t>(tried));
        const LayerInstant instant = this->instant(layer, reference_, t, D, D, 1);
        const auto& bends = std::get<SeenBlobs>(instant);
        if (!bends.blobs().empty()) ++with_blobs;
        if (bends.seen().empty()) continue;
        const BlobPixels pixels(bends.seen(), reference_, {0, 0, settings_.width, settings_.height});
        for (int i = 0; i < each; ++i) {
            const auto [x, y, weight] = pixels.draw(stream, tried * each + i);
            const DisplacementGrid grid = bends.every_pixel({x, y, 1, 1}, D);
            GridRow row;
            row.start(grid, y);
            const Shift d = row.at(x, D);
            sum += weight * (double{d.x} * d.x + double{d.y} * d.y) / each;
        }
    }
    return sum / tried;
}

/// Of gradient noise, over rays spread over the picture and their neighbours one pixel to the right or below, by turns,
/// each at its own instant.
MediaLayers::SampledVariance MediaLayers::sampled_variance(const MediumLayer& layer, double D) const {
    const RandomStream stream(1, "expected rms");
    const double steps = D * glm::length(reference_.forward / layer.cell);
    const int rays = std::clamp(static_cast<int>(std::min(kRmsSteps / steps, 1e6)), kFewestRmsRays, kRmsRays);
    SampledVariance sum;
    for (int i = 0; i < rays; ++i) {
        check_cancelled(settings_.cancelled);
        const auto [x, y] = spread_pixel(i, settings_.width, settings_.height);
        const double t = i == 0 ? 0 : 1e3 * stream.uniform(static_cast<std::uint64_t>(i));
        const LayerInstant instant = this->instant(layer, reference_, t, D, D, 1);
        const PixelPair pair(x, y, i % 2 == 0);
        std::vector<DisplacementGrid> grids = blank_grids(instant, reference_, D, D);
        grids.front().spacing = 1;
        grids.front().cover(pair.window);
        std::get<FirstOrderRays>(instant).fill(grids.front(), reference_);
        const auto [d, slope] = pair.shifts(grids, D);
        sum.shift += (double{d.x} * d.x + double{d.y} * d.y) / rays;
        sum.slope += slope * slope / rays;
    }
    return sum;
}

double MediaLayers::blob_focusing(const MediumLayer& layer, double D) const {
    const LayerInstant instant = this->instant(layer, reference_, 0, D, D, 1);
    const auto& bends = std::get<SeenBlobs>(instant);
    const std::vector<SeenBlob>& blobs = bends.seen();
    if (blobs.empty()) return 0;
    const RandomStream stream(1, "focusing of blobs");
    const PixelWindow picture{0, 0, settings_.width, settings_.height};
    std::array<std::optional<double>, kBlobPairs> slopes;
    tbb::parallel_for(std::size_t{0}, kBlobPairs, [&](std::size_t i) {
        check_cancelled(settings_.cancelled);
        const SeenBlob& blob =
            blobs[static_cast<std::size_t>(stream.uniform(4 * i) * static_cast<double>(blobs.size()))];
        const double scale = perspective() ? 1 / std::max(blob.forward, blob.sigma) : 1;
        const auto aside = [&](std::uint64_t c) { return (3 * stream.uniform(4 * i + c) - 1.5) * blob.sigma; };
        const dvec2 place = reference_.pixel(scale * dvec2(blob.right + aside(1), blob.up + aside(2)));
        if (!(place.x >= 0 && place.x < picture.width && place.y >= 0 && place.y < picture.height)) return;
        const PixelPair pair(static_cast<int>(place.x), static_cast<int>(place.y), i % 2 == 0);
        slopes[i] = pair.shifts({bends.every_pixel(pair.window, D)}, D).slope;
    });
    double sum = 0;
    int pairs = 0;
    for (const std::optional<double>& slope : slopes) {
        if (!slope) continue;
        sum += *slope * *slope;
        ++pairs;
    }
    return pairs > 0 ? sum / pairs : 0;
}

double MediaLayers::focusing_variance(const MediumLayer& layer, double D) const {
    if (std::holds_alternative<BlobCloud>(layer.field)) return blob_focusing(layer, D);
    const double strength2 = strength_ * strength_;
    if (const auto* screens = std::get_if<ScreenField>(&layer.field))
        return strength2 * screens->focusing_variance(D, perspective());
    if (const auto* lattice = std::get_if<LatticeField>(&layer.field)) {
        const PathRays rays = nearest_axis(reference_, scene_.optics.aperture);
        const auto slope = lattice->focusing_variance(rays.axis, D, perspective(), rays.aperture);
        return strength2 * 0.5 * (slope[0] + slope[1]);
    }
    return sampled_variance(layer, D).slope;
}

}  // namespace eikonal
