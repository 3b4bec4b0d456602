#include "warp/displace/blob_bends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

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
/// Spacings of nodes that blobs are grouped by [px].
constexpr std::array<int, 6> kSpacings{1, 2, 3, 4, 6, kWidestSpacing};

/// t beyond which t e^{-t²} < level, 0 < level < kSteepest: fixed-point iteration of t = √ln(t/level).
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

/// Nodes that a loop over a row takes at a time: rows are filled up to whole ones, which saves the loops' remainders.
constexpr int kLanes = 8;

int whole_lanes(int n) {
    return (n + kLanes - 1) / kLanes * kLanes;
}

/// The nodes of a band as four planes of floats, X.x, X.y, S.x, S.y, for loops to add to; rows are kLanes longer.
class Planes {
  public:
    explicit Planes(const Band& band)
        : depths_(band.depths.size()),
          stride_(static_cast<std::size_t>(band.columns + kLanes)),
          plane_(static_cast<std::size_t>(band.rows) * depths_ * stride_),
          values_(4 * plane_) {}

    std::array<float*, 4> row(int j, std::size_t depth, int column) {
        float* p = values_.data() + (static_cast<std::size_t>(j) * depths_ + depth) * stride_ +
                   static_cast<std::size_t>(column);
        return {p, p + plane_, p + 2 * plane_, p + 3 * plane_};
    }
    void store(Band& band) {
        for (int j = 0; j < band.rows; ++j)
            for (std::size_t k = 0; k < depths_; ++k) {
                const auto [x, y, sx, sy] = row(j, k, 0);
                Node* to = band.row(j, k);
                for (int i = 0; i < band.columns; ++i) to[i] = Node{x[i], y[i], sx[i], sy[i]};
            }
    }

  private:
    std::size_t depths_, stride_, plane_;
    std::vector<float> values_;
};

/// A row of rays past one blob: ray i has the slopes sx + i step, sy.
struct RowGeometry {
    double right, up, forward, inverse_sigma, amplitude, aspect;
    double sx, step, sy;
};

/// What a row of nodes past one blob has in common for all depths, for layers within the blob.
struct RowPast {
    std::vector<float> x, y;        ///< amplitude e^{-b²/σ²} b⊥ [px m]
    std::vector<double> a, length;  ///< -w_j/σ; L/σ
    explicit RowPast(int n) : x(to(n)), y(to(n)), a(to(n)), length(to(n)) {}
    static std::size_t to(int n) { return static_cast<std::size_t>(whole_lanes(n)); }
};

/// What cancels is double, the rest float; in two loops, each of one width. g by value: the arrays then cannot alias
/// it.
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

/// nodes += the blob at depth z, within it or with the camera near it.
EIKONAL_CLONES void add_layer(const float* __restrict x, const float* __restrict y, const double* __restrict a,
                              const double* __restrict length, double z, int n, float* __restrict X,
                              float* __restrict Y, float* __restrict SX, float* __restrict SY) {
    for (int i = 0; i < n; ++i) {
        const BlobProfile p = blob_profile(static_cast<float>(a[i]), static_cast<float>(z * length[i] + a[i]));
        const float rate = static_cast<float>(length[i]) * p.e;
        X[i] += x[i] * p.i1;
        Y[i] += y[i] * p.i1;
        SX[i] += x[i] * rate;
        SY[i] += y[i] * rate;
    }
}

/// A row of rays all the way through one blob, up to depth z behind it, as polynomials in the node's number i. Within
/// the blob's disc no term of theirs is much larger than their sum: single precision loses nothing.
struct WholePass {
    float x, dx, y;             ///< b⊥ [m]: x + i dx, y
    float twist, dtwist;        ///< |b|² L² = b⊥² + (twist + i dtwist)²
    float L2, dL2, ddL2;        ///< L²
    float past, dpast, ddpast;  ///< L (z L - w_j) [m]
    float inverse_sigma, amplitude_x, amplitude_y;

    WholePass(const RowGeometry& g, double z, bool perspective) {
        const auto f = [](double v) { return static_cast<float>(v); };
        const double forward = perspective ? g.forward : 1;
        x = f(g.sx * forward - g.right);
        dx = f(g.step * forward);
        y = f(g.sy * forward - g.up);
        twist = perspective ? f(g.sx * g.up - g.sy * g.right) : 0;
        dtwist = perspective ? f(g.step * g.up) : 0;
        L2 = perspective ? f(1 + g.sx * g.sx + g.sy * g.sy) : 1;
        dL2 = perspective ? f(2 * g.sx * g.step) : 0;
        ddL2 = perspective ? f(g.step * g.step) : 0;
        past = f(z - g.forward + (perspective ? g.sx * (z * g.sx - g.right) + g.sy * (z * g.sy - g.up) : 0));
        dpast = perspective ? f(g.step * (2 * z * g.sx - g.right)) : 0;
        ddpast = perspective ? f(g.step * g.step * z) : 0;
        inverse_sigma = f(g.inverse_sigma);
        amplitude_x = f(g.amplitude * static_cast<double>(portable::kSqrtPi));
        amplitude_y = f(-g.aspect * g.amplitude * static_cast<double>(portable::kSqrtPi));
    }
};

/// nodes += the blob well ahead of the camera, at a depth behind it: i1 = c √π, straight in z.
EIKONAL_CLONES void add_whole(const WholePass p, int n, float* __restrict X, float* __restrict Y, float* __restrict SX,
                              float* __restrict SY) {
    for (int k = 0; k < n; ++k) {
        const auto i = static_cast<float>(k);
        const float x = p.x + i * p.dx, twist = p.twist + i * p.dtwist;
        const float L2 = p.L2 + i * (p.dL2 + i * p.ddL2), past = p.past + i * (p.dpast + i * p.ddpast);
        const float per_sigma = p.inverse_sigma / std::sqrt(L2);
        const float e = gaussian_f(std::sqrt(x * x + p.y * p.y + twist * twist) * per_sigma);
        const float vx = e * (p.amplitude_x * x), vy = e * (p.amplitude_y * p.y);
        const float c = past * per_sigma, rate = L2 * per_sigma;
        X[k] += vx * c;
        Y[k] += vy * c;
        SX[k] += vx * rate;
        SY[k] += vy * rate;
    }
}

/// Columns begin … end - 1 of a row of nodes.
struct NodeRange {
    int begin, end;
};

/// Fills a band with blobs, one after the other.
class BandFiller {
  public:
    BandFiller(Band& band, const Camera& camera)
        : band_(band), camera_(camera), planes_(band), past_(band.columns), step_(band.spacing / camera.f_px) {
        const double first = slope(0, 0).x, last = slope(band.columns - 1, 0).x;
        widest2_ = std::max(first * first, last * last);
    }
    void add(const SeenBlob& b);
    void finish() { planes_.store(band_); }

  private:
    dvec2 slope(int column, int row) const {
        return camera_.slope((band_.column0 + column) * band_.spacing + 0.5, (band_.row0 + row) * band_.spacing + 0.5);
    }
    /// Those of `within` that a blob's disc cuts out of a row whose first node, of the band, has a slope.
    NodeRange chord(const SeenBlob& b, const dvec2& first, const NodeRange& within) const;
    /// One row of a blob, at every depth.
    void add_row(const SeenBlob& b, bool ahead, int j, const NodeRange& columns);

    Band& band_;
    const Camera& camera_;
    Planes planes_;
    RowPast past_;
    double step_;     ///< between nodes' slopes
    double widest2_;  ///< largest square of a row's slopes
};

NodeRange BandFiller::chord(const SeenBlob& b, const dvec2& first, const NodeRange& within) const {
    // b² L² = lat_x² + lat_y² + twist² is at least the first two, L² at most that of the row's ends
    double forward = 1, reach2 = b.reach * b.reach;
    if (band_.perspective) {
        if (b.forward <= b.reach) return within;
        forward = b.forward;
        reach2 *= 1 + widest2_ + first.y * first.y;
    }
    const double lat_y = first.y * forward - b.up;
    const double half2 = reach2 - lat_y * lat_y;
    if (!(half2 > 0)) return {within.begin, within.begin};
    const double half = std::sqrt(half2), scale = 1 / (forward * step_);
    const double middle = (b.right - first.x * forward) * scale;
    const auto column = [&](double x) { return static_cast<int>(std::clamp<double>(x, within.begin, within.end - 1)); };
    const double low = middle - half * scale, high = middle + half * scale;
    if (high < within.begin || low > within.end) return {within.begin, within.begin};
    return {column(low), column(high) + 1};
}

void BandFiller::add_row(const SeenBlob& b, bool ahead, int j, const NodeRange& columns) {
    dvec2 first = slope(0, j);
    const NodeRange part = chord(b, first, columns);
    if (part.begin >= part.end) return;
    const int n = whole_lanes(part.end - part.begin);
    first.x += part.begin * step_;
    const RowGeometry row{b.right, b.up,  b.forward, 1 / b.sigma, b.amplitude, camera_.pixel_aspect,
                          first.x, step_, first.y};
    bool passed = false;
    for (std::size_t k = 0; k < band_.depths.size(); ++k) {
        const double z = band_.depths[k];
        if (z < b.forward - b.reach) continue;
        const auto [X, Y, SX, SY] = planes_.row(j, k, part.begin);
        if (ahead && z >= b.forward + b.reach) {
            add_whole(WholePass(row, z, band_.perspective), n, X, Y, SX, SY);
            continue;
        }
        float *x = past_.x.data(), *y = past_.y.data();
        double *a = past_.a.data(), *length = past_.length.data();
        if (!passed) (band_.perspective ? pass_perspective : pass_orthographic)(row, n, x, y, a, length);
        passed = true;
        add_layer(x, y, a, length, z, n, X, Y, SX, SY);
    }
}

/// Adds one blob to the part of a band that its disc holds.
void BandFiller::add(const SeenBlob& b) {
    const auto node_floor = [&](int pixel) { return floor_div(pixel, band_.spacing); };
    const NodeRange columns{std::max(0, node_floor(b.disc.x0) - band_.column0),
                            std::min(band_.columns, node_floor(b.disc.x0 + b.disc.width) + 1 - band_.column0)};
    const int begin = std::max(0, node_floor(b.disc.y0) - band_.row0);
    const int end = std::min(band_.rows, node_floor(b.disc.y0 + b.disc.height) + 1 - band_.row0);
    if (columns.begin >= columns.end) return;
    // w_j² = |x_j - q0|² - b², wherever the blob reaches
    const double afar = double{kBlobAfar} * b.sigma;
    const double w2 =
        (band_.perspective ? b.right * b.right + b.up * b.up - b.reach * b.reach : 0) + b.forward * b.forward;
    const bool ahead = b.forward > (band_.perspective ? b.reach : 0) && w2 >= afar * afar;
    for (int j = begin; j < end; ++j) add_row(b, ahead, j, columns);
}

/// A band of nodes `spacing` pixels apart, past these blobs.
Band filled_band(const std::vector<const SeenBlob*>& blobs, const Camera& camera, int spacing,
                 std::vector<double> depths, const PixelWindow& cover) {
    Band band;
    band.spacing = spacing;
    band.perspective = camera.projection == Projection::Perspective;
    band.interpolation = DepthInterpolation::Hermite;
    band.depths = std::move(depths);
    band.cover(cover);
    BandFiller filler(band, camera);
    for (const SeenBlob* b : blobs) filler.add(*b);
    filler.finish();
    return band;
}

}  // namespace

int BlobBends::finest_spacing() const {
    int spacing = kWidestSpacing;
    for (const SeenBlob& b : seen_) spacing = std::min(spacing, b.spacing);
    return spacing;
}

std::vector<double> BlobBends::layers(double nearest, double farthest) const {
    std::vector<const SeenBlob*> all;
    for (const SeenBlob& b : seen_) all.push_back(&b);
    return blob_layers(all, nearest, farthest);
}

std::vector<Band> BlobBends::bands(const PixelWindow& tile, const PixelWindow& cover, double nearest,
                                   double farthest) const {
    std::vector<Band> result;
    for (const int spacing : kSpacings) {
        // interpolation reads nodes beyond the tile
        const int margin = 3 * spacing;
        const PixelWindow around{tile.x0 - margin, tile.y0 - margin, tile.width + 2 * margin, tile.height + 2 * margin};
        std::vector<const SeenBlob*> group;
        for (const SeenBlob& b : seen_)
            if (b.spacing == spacing && meets(b, around)) group.push_back(&b);
        if (group.empty()) continue;
        result.push_back(filled_band(group, camera_, spacing, blob_layers(group, nearest, farthest), cover));
    }
    return result;
}

Band BlobBends::every_pixel(const PixelWindow& window, double depth) const {
    std::vector<const SeenBlob*> group;
    for (const SeenBlob& b : seen_)
        if (meets(b, window)) group.push_back(&b);
    return filled_band(group, camera_, 1, {depth}, window);
}

}  // namespace eikonal
