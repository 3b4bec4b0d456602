#include "warp/displace/media/blobs/blob_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "noise/base/instruction_sets.h"
#include "noise/blobs/blob_profile.h"

namespace eikonal {
namespace {

/// Loops over a row take this many nodes at a time. Rows are padded to whole multiples, so that no remainder is left.
constexpr int kLanes = 8;

int whole_lanes(int n) {
    return (n + kLanes - 1) / kLanes * kLanes;
}

/// The nodes of a grid as four planes of floats: X.x, X.y, S.x, S.y. Loops add to them. Rows are kLanes longer than the
/// grid's.
class Planes {
  public:
    Planes(const DisplacementGrid& grid, std::size_t depths)
        : depths_(depths),
          stride_(static_cast<std::size_t>(grid.columns + kLanes)),
          plane_(static_cast<std::size_t>(grid.rows) * depths_ * stride_),
          values_(4 * plane_) {}

    std::array<float*, 4> row(int j, std::size_t depth, int column) {
        float* p = values_.data() + (static_cast<std::size_t>(j) * depths_ + depth) * stride_ +
                   static_cast<std::size_t>(column);
        return {p, p + plane_, p + 2 * plane_, p + 3 * plane_};
    }

  private:
    std::size_t depths_, stride_, plane_;
    std::vector<float> values_;
};

/// nodes = (X, S) of one depth.
EIKONAL_CLONES void store_depth(const float* __restrict X, const float* __restrict Y, const float* __restrict SX,
                                const float* __restrict SY, int n, Node* __restrict to) {
    for (int i = 0; i < n; ++i) to[i] = Node{X[i], Y[i], SX[i], SY[i]};
}

/// Behind a blob X is straight. Adds X and S of one depth to those of another, dz metres behind it.
EIKONAL_CLONES void go_on(const float* __restrict X0, const float* __restrict Y0, const float* __restrict SX0,
                          const float* __restrict SY0, float dz, int n, float* __restrict X, float* __restrict Y,
                          float* __restrict SX, float* __restrict SY) {
    for (int i = 0; i < n; ++i) {
        X[i] += X0[i] + dz * SX0[i];
        Y[i] += Y0[i] + dz * SY0[i];
        SX[i] += SX0[i];
        SY[i] += SY0[i];
    }
}

EIKONAL_CLONES void add_nodes(const float* __restrict X, const float* __restrict Y, const float* __restrict SX,
                              const float* __restrict SY, int n, Node* __restrict to) {
    for (int i = 0; i < n; ++i) to[i] += Node{X[i], Y[i], SX[i], SY[i]};
}

/// A row of rays that pass one blob. Ray i has the slopes sx + i step, sy.
struct RowGeometry {
    double right, up, forward, inverse_sigma, amplitude, aspect;
    double sx, step, sy;
};

/// What a row of nodes has in common at all depths within one blob.
struct RowPast {
    std::vector<float> x, y;        ///< amplitude e^{-b²/σ²} b⊥ [px m]
    std::vector<double> a, length;  ///< -w_j/σ; L/σ
    explicit RowPast(int n) : x(to(n)), y(to(n)), a(to(n)), length(to(n)) {}
    static std::size_t to(int n) { return static_cast<std::size_t>(whole_lanes(n)); }
};

/// Differences that would lose digits are computed in double, all else in float. There are two loops, each of one
/// width. g is passed by value, so that the arrays cannot alias it.
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

/// nodes += the blob at depth z, which lies within the blob or is seen by a camera near it.
EIKONAL_CLONES void add_depth(const float* __restrict x, const float* __restrict y, const double* __restrict a,
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

/// A row of rays that pass one blob completely, up to depth z behind it. Its terms are polynomials in the number i of
/// the node. Within the blob's disc no term is much larger than their sum, so that single precision loses nothing.
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

/// nodes += the blob, which lies completely between the camera and the depth: i1 = c √π, linear in z.
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

/// Fills a grid with blobs, one after the other. A blob is added to every depth within it and to the first depth behind
/// it. From there on it is straight, and finish() carries the sum of all blobs on to the depths beyond.
class BandFiller {
  public:
    BandFiller(DisplacementGrid& grid, const Camera& camera)
        : grid_(grid),
          camera_(camera),
          goes_on_(grid.depths.size() > 1),
          within_(grid, grid.depths.size()),
          behind_(grid, goes_on_ ? grid.depths.size() : 0),
          past_(grid.columns),
          step_(grid.spacing / camera.f_px) {
        const double first = slope(0, 0).x, last = slope(grid.columns - 1, 0).x;
        widest2_ = std::max(first * first, last * last);
    }
    void add(const SeenBlob& b);
    void finish();

  private:
    dvec2 slope(int column, int row) const {
        return camera_.slope((grid_.column0 + column) * grid_.spacing + 0.5, (grid_.row0 + row) * grid_.spacing + 0.5);
    }
    /// The columns of `within` that lie in a blob's disc, in a row whose first node has the slope `first`.
    NodeRange chord(const SeenBlob& b, const dvec2& first, const NodeRange& within) const;
    /// Adds one row of a blob at every depth within it and at the first depth behind it.
    void add_row(const SeenBlob& b, bool ahead, int j, const NodeRange& columns);

    DisplacementGrid& grid_;
    const Camera& camera_;
    bool goes_on_;  ///< whether the grid has more than one depth
    Planes within_, behind_;
    RowPast past_;
    double step_;     ///< difference of slope between neighbouring nodes
    double widest2_;  ///< largest square of a slope in the row
};

NodeRange BandFiller::chord(const SeenBlob& b, const dvec2& first, const NodeRange& within) const {
    // b² L² = lat_x² + lat_y² + twist² is at least the sum of the first two terms. L² is at most that of the row's
    // ends.
    double forward = 1, reach2 = b.reach * b.reach;
    if (grid_.perspective) {
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
    for (std::size_t k = 0; k < grid_.depths.size(); ++k) {
        const double z = grid_.depths[k];
        if (z < b.forward - b.reach) continue;
        const bool behind = z >= b.forward + b.reach;
        const auto [X, Y, SX, SY] = (behind && goes_on_ ? behind_ : within_).row(j, k, part.begin);
        if (ahead && behind) {
            add_whole(WholePass(row, z, grid_.perspective), n, X, Y, SX, SY);
            return;
        }
        float *x = past_.x.data(), *y = past_.y.data();
        double *a = past_.a.data(), *length = past_.length.data();
        if (!passed) (grid_.perspective ? pass_perspective : pass_orthographic)(row, n, x, y, a, length);
        passed = true;
        add_depth(x, y, a, length, z, n, X, Y, SX, SY);
        if (behind) return;
    }
}

void BandFiller::finish() {
    const int n = grid_.columns;
    for (int j = 0; j < grid_.rows; ++j)
        for (std::size_t k = 0; k < grid_.depths.size(); ++k) {
            Node* nodes = grid_.row(j, k);
            const auto [x, y, sx, sy] = within_.row(j, k, 0);
            store_depth(x, y, sx, sy, n, nodes);
            if (!goes_on_) continue;
            const auto [X, Y, SX, SY] = behind_.row(j, k, 0);
            if (k > 0) {
                const auto [X0, Y0, SX0, SY0] = behind_.row(j, k - 1, 0);
                go_on(X0, Y0, SX0, SY0, static_cast<float>(grid_.depths[k] - grid_.depths[k - 1]), n, X, Y, SX, SY);
            }
            add_nodes(X, Y, SX, SY, n, nodes);
        }
}

/// Adds one blob to the part of the grid that its disc covers.
void BandFiller::add(const SeenBlob& b) {
    const auto node_floor = [&](int pixel) { return floor_div(pixel, grid_.spacing); };
    const NodeRange columns{std::max(0, node_floor(b.disc.x0) - grid_.column0),
                            std::min(grid_.columns, node_floor(b.disc.x0 + b.disc.width) + 1 - grid_.column0)};
    const int begin = std::max(0, node_floor(b.disc.y0) - grid_.row0);
    const int end = std::min(grid_.rows, node_floor(b.disc.y0 + b.disc.height) + 1 - grid_.row0);
    if (columns.begin >= columns.end) return;
    // w_j² = |x_j - q0|² - b², wherever the blob reaches
    const double afar = double{kBlobAfar} * b.sigma;
    const double w2 =
        (grid_.perspective ? b.right * b.right + b.up * b.up - b.reach * b.reach : 0) + b.forward * b.forward;
    const bool ahead = b.forward > (grid_.perspective ? b.reach : 0) && w2 >= afar * afar;
    for (int j = begin; j < end; ++j) add_row(b, ahead, j, columns);
}

}  // namespace

DisplacementGrid filled_grid(const std::vector<const SeenBlob*>& blobs, const Camera& camera, int spacing,
                             std::vector<double> depths, const PixelWindow& cover) {
    DisplacementGrid grid;
    grid.spacing = spacing;
    grid.perspective = camera.projection == Projection::Perspective;
    grid.interpolation = DepthInterpolation::Hermite;
    grid.depths = std::move(depths);
    grid.cover(cover);
    BandFiller filler(grid, camera);
    for (const SeenBlob* b : blobs) filler.add(*b);
    filler.finish();
    return grid;
}

}  // namespace eikonal
