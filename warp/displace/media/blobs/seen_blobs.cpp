#include "warp/displace/media/blobs/seen_blobs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "noise/math/portable_math.h"
#include "warp/displace/media/blobs/blob_grid.h"

namespace eikonal {
namespace {

/// b/σ beyond which e^{-b²/σ²} is zero in single precision.
constexpr double kLargestReach = 9;
constexpr double kWholePass = 3.5449077018110318;  // 2√π
constexpr double kSteepest = 0.42888194248035344;  // max t e^{-t²}, at t = 1/√2
constexpr int kLastPixel = 1 << 29;
/// The node spacings by which blobs are grouped [px].
constexpr std::array<int, 6> kSpacings{1, 2, 3, 4, 6, kWidestSpacing};

/// t beyond which t e^{-t²} < level, for 0 < level < kSteepest. Found by the fixed-point iteration t = √ln(t/level).
double tail_reach(double level) {
    double t = 1;
    for (int i = 0; i < 12; ++i) {
        const double last = t;
        t = std::sqrt(std::max(0.5, portable::log(t / level)));
        if (std::abs(t - last) < 1e-10) break;
    }
    return std::min(t * (1 + 1e-9), kLargestReach);
}

int pixel_floor(double x) {
    return static_cast<int>(std::floor(std::clamp(x, -double{kLastPixel}, double{kLastPixel})));
}

/// The smallest and largest slope of lines from the origin of the plane (across, forward) that touch a circle of radius
/// r. The circle does not hold the origin and lies ahead of it (forward > r).
struct Slopes {
    double least, most;
};
Slopes tangent_slopes(double across, double forward, double r) {
    const double ahead = (forward - r) * (forward + r);
    const double root = r * std::sqrt(across * across + ahead);
    return {(across * forward - root) / ahead, (across * forward + root) / ahead};
}

}  // namespace

double largest_blob_shift(const Blob& blob, double strength, const Camera& camera, double forward, double farthest) {
    const double angle = kWholePass * kSteepest * std::abs(blob.n * strength);
    const double vertical = std::max(1.0, camera.pixel_aspect);
    if (camera.projection == Projection::Orthographic)
        return camera.f_px * vertical * angle * std::max(0.0, farthest - forward + blob.sigma);
    // The bend of a slanted ray shows 1 + s² times as large. s is the largest slope in the picture.
    const double sx = camera.center.x / camera.f_px, sy = camera.center.y / (camera.f_px * camera.pixel_aspect);
    const double left = std::clamp(1 - (forward - blob.sigma) / farthest, 0.0, 1.0);
    return camera.f_px * vertical * (1 + sx * sx + sy * sy) * angle * left;
}

namespace {

/// A blob as the camera sees it, anywhere within `astray` of its centre [m]. Nothing if it displaces no pixel by `each`
/// [px] or more.
std::optional<SeenBlob> see(const Blob& blob, double astray, double strength, const Camera& camera, double farthest,
                            double gain, double each) {
    const bool perspective = camera.projection == Projection::Perspective;
    const dvec3 from = blob.center - camera.position;
    SeenBlob s{};
    s.right = glm::dot(from, camera.right);
    s.up = glm::dot(from, camera.up);
    s.forward = glm::dot(from, camera.forward);
    const double largest = largest_blob_shift(blob, strength, camera, s.forward - astray, farthest) * std::abs(gain);
    if (!(largest > each) || !(blob.sigma > 0)) return std::nullopt;
    s.sigma = blob.sigma;
    s.amplitude = -2 * blob.n * strength * camera.f_px;
    s.reach = blob.sigma * tail_reach(kSteepest * std::min(each / largest, 0.999)) + astray;
    if (s.forward < -s.reach || s.forward - s.reach > farthest) return std::nullopt;
    const double distance = std::max(s.forward, blob.sigma);
    const double sigma_px =
        blob.sigma * camera.f_px * std::min(1.0, camera.pixel_aspect) / (perspective ? distance : 1.0);
    for (const int spacing : kSpacings)
        if (spacing == 1 || spacing <= kNodeSpacing * sigma_px) s.spacing = spacing;
    dvec2 low{-kLastPixel, -kLastPixel}, high{kLastPixel, kLastPixel};
    if (!perspective) {
        low = camera.pixel({s.right - s.reach, s.up + s.reach});
        high = camera.pixel({s.right + s.reach, s.up - s.reach});
    } else if (s.forward > s.reach) {
        const Slopes x = tangent_slopes(s.right, s.forward, s.reach), y = tangent_slopes(s.up, s.forward, s.reach);
        low = camera.pixel({x.least, y.most});
        high = camera.pixel({x.most, y.least});
    }
    s.disc = {pixel_floor(low.x), pixel_floor(low.y), 0, 0};
    s.disc.width = pixel_floor(high.x) + 1 - s.disc.x0;
    s.disc.height = pixel_floor(high.y) + 1 - s.disc.y0;
    return s;
}

/// Whether a blob's disc holds pixels of a tile. The disc's rectangle decides. A blob beside the camera has none; the
/// planes of the tile's pyramid then decide.
bool meets(const SeenBlob& b, const Camera& camera, const PixelWindow& tile) {
    if (b.disc.x0 >= tile.x0 + tile.width || b.disc.x0 + b.disc.width <= tile.x0 ||
        b.disc.y0 >= tile.y0 + tile.height || b.disc.y0 + b.disc.height <= tile.y0)
        return false;
    if (camera.projection == Projection::Orthographic) return true;
    const dvec2 least = camera.slope(tile.x0, tile.y0 + tile.height),
                most = camera.slope(tile.x0 + tile.width, tile.y0);
    const auto beside = [&](double across, double slope) {
        return (across - slope * b.forward) / std::sqrt(1 + slope * slope);
    };
    return beside(b.right, least.x) > -b.reach && beside(b.right, most.x) < b.reach &&
           beside(b.up, least.y) > -b.reach && beside(b.up, most.y) < b.reach;
}

}  // namespace

SeenBlobs::SeenBlobs(std::vector<Blob> blobs, double strength, const Camera& camera, double farthest, double gain)
    : camera_(camera), blobs_(std::move(blobs)) {
    const double each = kNegligibleShift / static_cast<double>(blobs_.size());
    for (const Blob& blob : blobs_)
        if (const auto s = see(blob, 0, strength, camera, farthest, gain, each)) seen_.push_back(*s);
}

bool may_be_seen(const std::vector<BlobHome>& homes, double strength, const Camera& camera, const PixelWindow& window,
                 double farthest, double negligible) {
    double count = 0;
    for (const BlobHome& home : homes) count += home.most;
    return std::any_of(homes.begin(), homes.end(), [&](const BlobHome& home) {
        const auto s = see(home.largest, home.radius, strength, camera, farthest, 1, negligible / count);
        return s && meets(*s, camera, window);
    });
}

namespace {

/// At most kMostBlobDepths depths: nearest, farthest, and the others spread evenly over the depths where blobs are.
std::vector<double> spread_depths(const std::vector<const SeenBlob*>& blobs, double nearest, double farthest) {
    struct Stretch {
        double begin, end;
    };
    std::vector<Stretch> each, stretches;
    for (const SeenBlob* b : blobs) {
        const Stretch s{std::max(nearest, b->forward - b->reach), std::min(farthest, b->forward + b->reach)};
        if (s.begin < s.end) each.push_back(s);
    }
    std::sort(each.begin(), each.end(), [](const Stretch& a, const Stretch& b) { return a.begin < b.begin; });
    for (const Stretch& s : each) {
        if (!stretches.empty() && s.begin <= stretches.back().end)
            stretches.back().end = std::max(stretches.back().end, s.end);
        else
            stretches.push_back(s);
    }
    while (stretches.size() > kMostBlobDepths / 8) {  // join the two stretches with the smallest gap
        std::size_t least = 1;
        for (std::size_t i = 2; i < stretches.size(); ++i)
            if (stretches[i].begin - stretches[i - 1].end < stretches[least].begin - stretches[least - 1].end)
                least = i;
        stretches[least - 1].end = stretches[least].end;
        stretches.erase(stretches.begin() + static_cast<std::ptrdiff_t>(least));
    }
    double length = 0;
    for (const Stretch& s : stretches) length += s.end - s.begin;
    const auto left = static_cast<double>(kMostBlobDepths - 2 - 2 * static_cast<int>(stretches.size()));
    std::vector<double> depths{nearest, farthest};
    for (const Stretch& s : stretches) {
        const int steps = 1 + static_cast<int>(left * ((s.end - s.begin) / length));
        for (int i = 0; i <= steps; ++i) depths.push_back(s.begin + (s.end - s.begin) * i / steps);
    }
    std::sort(depths.begin(), depths.end());
    depths.erase(std::unique(depths.begin(), depths.end()), depths.end());
    return depths;
}

/// Depths at which the blobs of a group are computed [m].
std::vector<double> blob_depths(const std::vector<const SeenBlob*>& blobs, double nearest, double farthest) {
    if (!(farthest > nearest)) return {nearest};
    const auto spaced = [&](double apart) {
        std::vector<double> depths{nearest};
        double z = nearest;
        while (z < farthest && depths.size() < kMostBlobDepths) {
            double step = farthest - z;
            for (const SeenBlob* b : blobs) {
                const double begin = b->forward - b->reach, end = b->forward + b->reach;
                if (end <= z) continue;
                // The next depth is at most where the blob begins or ends.
                step = std::min(step, begin > z ? begin - z : std::min(apart * b->sigma, end - z + 1e-3 * b->sigma));
            }
            z = std::min(farthest, z + std::max(step, 1e-6 * z));
            depths.push_back(z);
        }
        return depths;
    };
    double apart = kDepthSpacing;
    for (int i = 0; i < 12; ++i, apart *= 2)
        if (std::vector<double> depths = spaced(apart); depths.back() == farthest) return depths;
    return spread_depths(blobs, nearest, farthest);
}

}  // namespace

int SeenBlobs::finest_spacing() const {
    int spacing = kWidestSpacing;
    for (const SeenBlob& b : seen_) spacing = std::min(spacing, b.spacing);
    return spacing;
}

std::vector<double> SeenBlobs::depths(double nearest, double farthest) const {
    std::vector<const SeenBlob*> all;
    for (const SeenBlob& b : seen_) all.push_back(&b);
    return blob_depths(all, nearest, farthest);
}

std::vector<DisplacementGrid> SeenBlobs::grids(const PixelWindow& tile, const PixelWindow& cover, double nearest,
                                               double farthest) const {
    std::vector<DisplacementGrid> result;
    for (const int spacing : kSpacings) {
        // Interpolation reads nodes beyond the tile.
        const int margin = 3 * spacing;
        const PixelWindow around{tile.x0 - margin, tile.y0 - margin, tile.width + 2 * margin, tile.height + 2 * margin};
        std::vector<const SeenBlob*> group;
        for (const SeenBlob& b : seen_)
            if (b.spacing == spacing && meets(b, camera_, around)) group.push_back(&b);
        if (group.empty()) continue;
        result.push_back(filled_grid(group, camera_, spacing, blob_depths(group, nearest, farthest), cover));
    }
    return result;
}

DisplacementGrid SeenBlobs::every_pixel(const PixelWindow& window, double depth) const {
    std::vector<const SeenBlob*> group;
    for (const SeenBlob& b : seen_)
        if (meets(b, camera_, window)) group.push_back(&b);
    return filled_grid(group, camera_, 1, {depth}, window);
}

}  // namespace eikonal
