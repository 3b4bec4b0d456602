#include "warp/displace/blob_bends.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "noise/blob_profile.h"
#include "noise/dispatch.h"
#include "noise/erf.h"
#include "noise/portable_math.h"

namespace eikonal {
namespace {

/// b/σ beyond which even e^{-b²/σ²} is nothing in single precision.
constexpr double kLargestReach = 9;
constexpr double kWholePass = 3.5449077018110318;  // 2√π
constexpr double kSteepest = 0.42888194248035344;  // max t e^{-t²}, at t = 1/√2
constexpr int kLastPixel = 1 << 29;

/// t beyond which t e^{-t²} < level, 0 < level < kSteepest: fixed-point iteration of t = √ln(t/level).
double tail_reach(double level) {
    double t = 1;
    for (int i = 0; i < 12; ++i) t = std::sqrt(std::max(0.5, portable::log(t / level)));
    return std::min(t * (1 + 1e-9), kLargestReach);
}

int pixel_floor(double x) {
    return static_cast<int>(std::floor(std::clamp(x, -double{kLastPixel}, double{kLastPixel})));
}

/// Extreme slopes of lines from the origin of the plane (across, forward) tangent to a circle of radius r that does not
/// hold it and lies ahead (forward > r).
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
    // a slanted ray's bend shows by 1 + s², s the largest slope in the picture
    const double sx = camera.center.x / camera.f_px, sy = camera.center.y / (camera.f_px * camera.pixel_aspect);
    const double left = std::clamp(1 - (forward - blob.sigma) / farthest, 0.0, 1.0);
    return camera.f_px * vertical * (1 + sx * sx + sy * sy) * angle * left;
}

BlobBends::BlobBends(const std::vector<Blob>& blobs, double strength, const Camera& camera, double farthest,
                     double gain)
    : camera_(camera) {
    if (blobs.empty()) return;
    const bool perspective = camera.projection == Projection::Perspective;
    const double each = kNegligibleShift / static_cast<double>(blobs.size());
    for (const Blob& blob : blobs) {
        const dvec3 from = blob.center - camera.position;
        SeenBlob s{};
        s.right = glm::dot(from, camera.right);
        s.up = glm::dot(from, camera.up);
        s.forward = glm::dot(from, camera.forward);
        const double largest = largest_blob_shift(blob, strength, camera, s.forward, farthest) * std::abs(gain);
        if (!(largest > each) || !(blob.sigma > 0)) continue;
        s.sigma = blob.sigma;
        s.amplitude = -2 * blob.n * strength * camera.f_px;
        s.reach = blob.sigma * tail_reach(kSteepest * std::min(each / largest, 0.999));
        if (s.forward < -s.reach || s.forward - s.reach > farthest) continue;
        const double distance = std::max(s.forward, blob.sigma);
        const double sigma_px =
            blob.sigma * camera.f_px * std::min(1.0, camera.pixel_aspect) / (perspective ? distance : 1.0);
        s.spacing = 1;
        while (2 * s.spacing <= std::min(kNodeSpacing * sigma_px, double{kWidestSpacing})) s.spacing *= 2;
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
        seen_.push_back(s);
    }
}

/// Whether a blob's disc holds pixels of a tile: by its rectangle and, for one beside the camera, which has none, by
/// the planes of the tile's pyramid.
bool BlobBends::meets(const SeenBlob& b, const PixelWindow& tile) const {
    if (b.disc.x0 >= tile.x0 + tile.width || b.disc.x0 + b.disc.width <= tile.x0 ||
        b.disc.y0 >= tile.y0 + tile.height || b.disc.y0 + b.disc.height <= tile.y0)
        return false;
    if (camera_.projection == Projection::Orthographic) return true;
    const dvec2 least = camera_.slope(tile.x0, tile.y0 + tile.height),
                most = camera_.slope(tile.x0 + tile.width, tile.y0);
    const auto beside = [&](double across, double slope) {
        return (across - slope * b.forward) / std::sqrt(1 + slope * slope);
    };
    return beside(b.right, least.x) > -b.reach && beside(b.right, most.x) < b.reach &&
           beside(b.up, least.y) > -b.reach && beside(b.up, most.y) < b.reach;
}

namespace {

/// Depths at which the blobs of a group are worked out.
std::vector<double> blob_layers(const std::vector<const SeenBlob*>& blobs, double nearest, double farthest) {
    if (!(farthest > nearest)) return {nearest};
    const auto spaced = [&](double apart) {
        std::vector<double> depths{nearest};
        double z = nearest;
        while (z < farthest && depths.size() < kMostBlobLayers) {
            double step = farthest - z;
            for (const SeenBlob* b : blobs) {
                const double begin = b->forward - b->reach, end = b->forward + b->reach;
                if (end <= z) continue;
                // up to where the blob ends, or begins
                step = std::min(step, begin > z ? begin - z : std::min(apart * b->sigma, end - z + 1e-3 * b->sigma));
            }
            z = std::min(farthest, z + std::max(step, 1e-6 * z));
            depths.push_back(z);
        }
        return depths;
    };
    double apart = kLayerSpacing;
    for (int i = 0; i < 12; ++i, apart *= 2)
        if (std::vector<double> depths = spaced(apart); depths.back() == farthest) return depths;
    std::vector<double> even;
    for (int k = 0; k < kMostBlobLayers; ++k)
        even.push_back(k + 1 == kMostBlobLayers ? farthest
                                                : nearest + (farthest - nearest) * k / (kMostBlobLayers - 1));
    return even;
}

/// A row of nodes past one blob: what does not depend on depth.
struct RowPast {
    std::vector<float> x, y;        ///< amplitude e^{-b²/σ²} b⊥ [px m]
    std::vector<double> a, length;  ///< -w_j/σ; L/σ
    std::vector<float> e, g;        ///< ∫e^{-s²}, ∫s e^{-s²} from a to infinity
    explicit RowPast(int n) : x(to(n)), y(to(n)), a(to(n)), length(to(n)), e(to(n)), g(to(n)) {}
    static std::size_t to(int n) { return static_cast<std::size_t>(n); }
};

struct RowGeometry {
    double right, up, forward, inverse_sigma, amplitude, aspect;
    double sx, step, sy;  ///< slopes of the first node, between nodes, of the row
};

/// What cancels is double, the rest float; in two loops, each of one width. g by value: the arrays then cannot alias it.
EIKONAL_CLONES void pass_perspective(const RowGeometry g, int n, float* __restrict x, float* __restrict y,
                                     double* __restrict a, double* __restrict length) {
    const double lat_y = g.sy * g.forward - g.up, along = g.forward + g.sy * g.up, square = 1 + g.sy * g.sy;
    const double twist_y = g.sy * g.right, inverse_sigma = g.inverse_sigma;
    for (int i = 0; i < n; ++i) {
        const double sx = g.sx + i * g.step;
        x[i] = static_cast<float>(sx * g.forward - g.right);
        y[i] = static_cast<float>(sx * g.up - twist_y);
        const double L = std::sqrt(square + sx * sx);
        length[i] = L * inverse_sigma;
        a[i] = -(along + sx * g.right) * inverse_sigma / L;
    }
    const auto along_y = static_cast<float>(lat_y), amplitude = static_cast<float>(g.amplitude);
    const auto aspect = static_cast<float>(-g.aspect), sigma2 = static_cast<float>(inverse_sigma * inverse_sigma);
    for (int i = 0; i < n; ++i) {
        // b/σ = √(b² L²) / (L/σ) / σ²
        const float b = std::sqrt(x[i] * x[i] + along_y * along_y + y[i] * y[i]) / static_cast<float>(length[i]);
        const float e = amplitude * gaussian_f(b * sigma2);
        x[i] = e * x[i];
        y[i] = aspect * e * along_y;
    }
}

EIKONAL_CLONES void pass_orthographic(const RowGeometry g, int n, float* __restrict x, float* __restrict y,
                                      double* __restrict a, double* __restrict length) {
    const double lat_y = g.sy - g.up;
    for (int i = 0; i < n; ++i) {
        const double lat_x = g.sx + i * g.step - g.right;
        const double b = std::sqrt(lat_x * lat_x + lat_y * lat_y);
        const double e = g.amplitude * double{gaussian_f(static_cast<float>(b * g.inverse_sigma))};
        x[i] = static_cast<float>(e * lat_x);
        y[i] = static_cast<float>(-g.aspect * e * lat_y);
        a[i] = -g.forward * g.inverse_sigma;
        length[i] = g.inverse_sigma;
    }
}

/// nodes += the blob at depth z, within it.
EIKONAL_CLONES void add_layer(const float* x, const float* y, const double* a, const double* length, double z, int n,
                              Node* nodes) {
    for (int i = 0; i < n; ++i) {
        const BlobProfile p = blob_profile(static_cast<float>(a[i]), static_cast<float>(z * length[i] + a[i]));
        const float rate = static_cast<float>(length[i]) * p.e;
        nodes[i] += Node{x[i] * p.i1, y[i] * p.i1, x[i] * rate, y[i] * rate};
    }
}

/// ∫e^{-s²}, ∫s e^{-s²} from a on: √π and nothing for a blob well ahead.
EIKONAL_CLONES void whole_integrals(const double* a, int n, float* e, float* g) {
    double latest = a[0];
    for (int i = 1; i < n; ++i) latest = a[i] > latest ? a[i] : latest;
    if (latest <= -kBlobAfar) {
        std::fill(e, e + n, static_cast<float>(portable::kSqrtPi));
        std::fill(g, g + n, 0.0f);
        return;
    }
    for (int i = 0; i < n; ++i) {
        const BlobProfile p = blob_profile(static_cast<float>(a[i]), kBlobProfileRange);
        e[i] = p.e;
        g[i] = p.g;
    }
}

/// nodes += the blob at depth z behind it: i1 = c e - g, straight in z.
EIKONAL_CLONES void add_layer_behind(const float* x, const float* y, const double* a, const double* length,
                                     const float* e, const float* g, double z, int n, Node* nodes) {
    for (int i = 0; i < n; ++i) {
        const float i1 = static_cast<float>(z * length[i] + a[i]) * e[i] - g[i];
        const float rate = static_cast<float>(length[i]) * e[i];
        nodes[i] += Node{x[i] * i1, y[i] * i1, x[i] * rate, y[i] * rate};
    }
}

/// Columns begin … end - 1 of a row of nodes.
struct NodeRange {
    int begin, end;
};

/// Those of `within` that a blob's disc cuts out of row j.
NodeRange chord(const SeenBlob& b, const Camera& camera, const Band& band, int j, const NodeRange& within) {
    const auto at = [&](int column) {
        return camera.slope((band.column0 + column) * band.spacing + 0.5, (band.row0 + j) * band.spacing + 0.5);
    };
    const dvec2 first = at(within.begin), last = at(within.end - 1);
    // b² L² = lat_x² + lat_y² + twist² is at least the first two, L² at most that of the row's ends
    double forward = 1, reach2 = b.reach * b.reach;
    if (band.perspective) {
        if (b.forward <= b.reach) return within;
        forward = b.forward;
        reach2 *= 1 + std::max(first.x * first.x, last.x * last.x) + first.y * first.y;
    }
    const double lat_y = first.y * forward - b.up;
    const double half2 = reach2 - lat_y * lat_y;
    if (!(half2 > 0)) return {within.begin, within.begin};
    const double half = std::sqrt(half2), step = band.spacing / camera.f_px;
    const double low = ((b.right - half) / forward - first.x) / step,
                 high = ((b.right + half) / forward - first.x) / step;
    const int count = within.end - within.begin;
    return {within.begin + std::max(0, static_cast<int>(std::floor(std::clamp(low, 0.0, double(count))))),
            within.begin + std::min(count, static_cast<int>(std::ceil(std::clamp(high, -1.0, double(count)))) + 1)};
}

/// Adds one blob to the part of a band that its disc holds.
void add_blob(const SeenBlob& b, const Camera& camera, Band& band, RowPast& past) {
    const int spacing = band.spacing;
    const auto node_floor = [&](int pixel) { return pixel_floor(static_cast<double>(pixel) / spacing); };
    const NodeRange columns{std::max(0, node_floor(b.disc.x0) - band.column0),
                            std::min(band.columns, node_floor(b.disc.x0 + b.disc.width) + 1 - band.column0)};
    const int j0 = std::max(0, node_floor(b.disc.y0) - band.row0);
    const int j1 = std::min(band.rows, node_floor(b.disc.y0 + b.disc.height) + 1 - band.row0);
    if (columns.begin >= columns.end) return;
    const auto pass = band.perspective ? pass_perspective : pass_orthographic;
    float *x = past.x.data(), *y = past.y.data(), *e = past.e.data(), *g = past.g.data();
    double *a = past.a.data(), *length = past.length.data();
    for (int j = j0; j < j1; ++j) {
        const auto [i0, i1] = chord(b, camera, band, j, columns);
        const int n = i1 - i0;
        if (n <= 0) continue;
        const dvec2 first = camera.slope((band.column0 + i0) * spacing + 0.5, (band.row0 + j) * spacing + 0.5);
        pass({b.right, b.up, b.forward, 1 / b.sigma, b.amplitude, camera.pixel_aspect, first.x, spacing / camera.f_px,
              first.y},
             n, x, y, a, length);
        bool whole = false;
        for (std::size_t k = 0; k < band.depths.size(); ++k) {
            const double z = band.depths[k];
            Node* nodes = band.row(j, k) + i0;
            if (z < b.forward - b.reach) continue;
            if (z < b.forward + b.reach) {
                add_layer(x, y, a, length, z, n, nodes);
                continue;
            }
            if (!whole) whole_integrals(a, n, e, g);
            whole = true;
            add_layer_behind(x, y, a, length, e, g, z, n, nodes);
        }
    }
}

}  // namespace

std::vector<Band> BlobBends::bands(const PixelWindow& tile, const PixelWindow& cover, double nearest,
                                   double farthest) const {
    std::vector<Band> result;
    const bool perspective = camera_.projection == Projection::Perspective;
    for (int spacing = 1; spacing <= kWidestSpacing; spacing *= 2) {
        // interpolation reads nodes beyond the tile
        const int margin = 3 * spacing;
        const PixelWindow around{tile.x0 - margin, tile.y0 - margin, tile.width + 2 * margin, tile.height + 2 * margin};
        std::vector<const SeenBlob*> group;
        for (const SeenBlob& b : seen_)
            if (b.spacing == spacing && meets(b, around)) group.push_back(&b);
        if (group.empty()) continue;
        Band band;
        band.spacing = spacing;
        band.perspective = perspective;
        band.interpolation = DepthInterpolation::Hermite;
        band.depths = blob_layers(group, nearest, farthest);
        band.cover(cover);
        RowPast past(band.columns);
        for (const SeenBlob* b : group) add_blob(*b, camera_, band, past);
        result.push_back(std::move(band));
    }
    return result;
}

}  // namespace eikonal
