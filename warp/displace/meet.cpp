#include "warp/displace/meet.h"

#include <algorithm>
#include <cmath>

namespace eikonal {
namespace {

using Range = DepthPlane::Range;

int floor_block(int a) {
    return a >= 0 ? a / DepthPlane::kBlock : -((-a + DepthPlane::kBlock - 1) / DepthPlane::kBlock);
}

/// Whole pixels, far within an int for any displacement.
int whole(float v) {
    constexpr float kMost = 1e6f;
    return static_cast<int>(std::floor(v > -kMost ? (v < kMost ? v : kMost) : -kMost));
}

/// One pixel's bent ray and the depth buffer.
struct Ray {
    BandRows& bands;
    const DepthPlane& depth;
    int x, y;

    Shift at(double z) const { return bands.at(x, z); }
    /// The depth buffer where a displacement points to.
    float buffer(Shift d) const { return depth.at(x + whole(d.x + 0.5f), y + whole(d.y + 0.5f)); }

    /// Whether the picture's samples around pixel + d mix the facet there, at depth `facet`, with one much nearer.
    bool at_edge(Shift d, float facet) const {
        const float limit = kEdgeRatio * facet;
        if (limit <= depth.nearest()) return false;
        const int xi = whole(d.x), yi = whole(d.y);
        const int nx = d.x != static_cast<float>(xi) ? 1 : 0, ny = d.y != static_cast<float>(yi) ? 1 : 0;
        for (int j = 0; j <= ny; ++j)
            for (int i = 0; i <= nx; ++i)
                if (depth.at(x + xi + i, y + yi + j) < limit) return true;
        return false;
    }
    bool blocked(Shift d, double z) const {
        const float facet = buffer(d);
        return facet <= static_cast<float>(z) || at_edge(d, facet);
    }
};

bool same_pixel(Shift a, Shift b) {
    return whole(a.x + 0.5f) == whole(b.x + 0.5f) && whole(a.y + 0.5f) == whole(b.y + 0.5f);
}

/// Largest component of a - b.
float motion(Shift a, Shift b) {
    return std::max(std::abs(a.x - b.x), std::abs(a.y - b.y));
}

/// The last clear point between clear (z, d) and blocked (behind, e).
Shift bisect(const Ray& ray, double z, Shift d, double behind, Shift e) {
    for (int i = 0; i < 32 && motion(d, e) > kMarchError; ++i) {
        const double middle = 0.5 * (z + behind);
        const Shift m = ray.at(middle);
        if (ray.blocked(m, middle)) {
            behind = middle;
            e = m;
        } else {
            z = middle;
            d = m;
        }
    }
    return d;
}

Shift march(const Ray& ray, const Range& range) {
    double z = range.nearest;
    Shift d = ray.at(z);
    if (range.nearest == range.farthest) return d;
    for (int step = 0; step < kMostMarchSteps; ++step) {
        const float under = ray.buffer(d);
        const double facet = std::min(under, range.farthest);
        if (facet <= z || ray.at_edge(d, under)) return d;
        const Shift upon = ray.at(facet);
        if (same_pixel(upon, d) && !ray.at_edge(upon, under)) return upon;
        double next = facet;
        Shift e = upon;
        if (const double way = motion(upon, d); way > kMarchStep) {
            // even in inverse depth: the displacement of an object changes most where it is near
            next = 1 / (1 / z + (1 / facet - 1 / z) * (kMarchStep / way));
            e = ray.at(next);
        }
        if (ray.blocked(e, next)) {
            // a facet met exactly at its own depth, or something that the ray ran into on its way there
            const float there = ray.buffer(e);
            return there == static_cast<float>(next) && !ray.at_edge(e, there) ? e : bisect(ray, z, d, next, e);
        }
        z = next;
        d = e;
    }
    return d;
}

Shift fixed_point(const Ray& ray) {
    float z = ray.depth.at(ray.x, ray.y);
    Shift d = ray.at(z);
    for (int i = 0; i < kFixedPointSteps; ++i) {
        const float next = ray.buffer(d);
        if (next == z) break;
        z = next;
        d = ray.at(z);
    }
    return d;
}

Range unite(const Range& a, const Range& b) {
    return {std::min(a.nearest, b.nearest), std::max(a.farthest, b.farthest)};
}

}  // namespace

DepthPlane::DepthPlane(const PixelWindow& window, std::vector<float> metres)
    : window_(window), metres_(std::move(metres)) {
    block_columns_ = (window.width + kBlock - 1) / kBlock;
    block_rows_ = (window.height + kBlock - 1) / kBlock;
    const auto [low, high] = std::minmax_element(metres_.begin(), metres_.end());
    all_ = {*low, *high};
    blocks_.assign(static_cast<std::size_t>(block_columns_) * static_cast<std::size_t>(block_rows_),
                   {all_.farthest, all_.nearest});
    const float* z = metres_.data();
    for (int y = 0; y < window.height; ++y) {
        Range* row = blocks_.data() + static_cast<std::size_t>(y / kBlock) * static_cast<std::size_t>(block_columns_);
        for (int x = 0; x < window.width; ++x, ++z) row[x / kBlock] = unite(row[x / kBlock], {*z, *z});
    }
}

float DepthPlane::at(int x, int y) const {
    const int cx = std::clamp(x - window_.x0, 0, window_.width - 1);
    const int cy = std::clamp(y - window_.y0, 0, window_.height - 1);
    return metres_[static_cast<std::size_t>(cy) * static_cast<std::size_t>(window_.width) +
                   static_cast<std::size_t>(cx)];
}

std::vector<Range> DepthPlane::around(const PixelWindow& tile, int reach) const {
    const auto column = [&](int b) { return static_cast<std::size_t>(std::clamp(b, 0, block_columns_ - 1)); };
    const auto row = [&](int b) { return static_cast<std::size_t>(std::clamp(b, 0, block_rows_ - 1)); };
    const int x0 = floor_block(tile.x0 - window_.x0), x1 = floor_block(tile.x0 + tile.width - 1 - window_.x0);
    const int y0 = floor_block(tile.y0 - window_.y0), y1 = floor_block(tile.y0 + tile.height - 1 - window_.y0);
    // a block's pixels reach so many blocks on
    const int blocks = std::min((reach + kBlock - 1) / kBlock, std::max(block_columns_, block_rows_));
    const auto columns = static_cast<std::size_t>(x1 - x0 + 1);
    const auto stride = static_cast<std::size_t>(block_columns_);
    // along the rows, then along the columns
    std::vector<Range> lines, result;
    for (int by = y0 - blocks; by <= y1 + blocks; ++by)
        for (int bx = x0; bx <= x1; ++bx) {
            Range r = blocks_[row(by) * stride + column(bx)];
            for (int i = bx - blocks; i <= bx + blocks; ++i) r = unite(r, blocks_[row(by) * stride + column(i)]);
            lines.push_back(r);
        }
    for (int by = y0; by <= y1; ++by)
        for (std::size_t bx = 0; bx < columns; ++bx) {
            Range r = lines[static_cast<std::size_t>(by - y0) * columns + bx];
            for (int j = 1; j <= 2 * blocks; ++j)
                r = unite(r, lines[static_cast<std::size_t>(by - y0 + j) * columns + bx]);
            result.push_back(r);
        }
    return result;
}

MeetTile::MeetTile(const DepthPlane& depth, const PixelWindow& tile, DepthMeeting how, int reach)
    : depth_(depth), tile_(tile), how_(how) {
    if (how != DepthMeeting::March) return;
    ranges_ = depth.around(tile, reach);
    range_columns_ =
        floor_block(tile.x0 + tile.width - 1 - depth.window().x0) - floor_block(tile.x0 - depth.window().x0) + 1;
}

void MeetTile::row(BandRows& bands, int y, float* uv) const {
    const PixelWindow& window = depth_.window();
    const int first_column = floor_block(tile_.x0 - window.x0);
    const auto first =
        static_cast<std::size_t>((floor_block(y - window.y0) - floor_block(tile_.y0 - window.y0)) * range_columns_);
    for (int i = 0; i < tile_.width; ++i) {
        const Ray ray{bands, depth_, tile_.x0 + i, y};
        Shift d;
        switch (how_) {
            case DepthMeeting::March:
                d = march(ray,
                          ranges_[first + static_cast<std::size_t>(floor_block(ray.x - window.x0) - first_column)]);
                break;
            case DepthMeeting::FixedPoint:
                d = fixed_point(ray);
                break;
            case DepthMeeting::Own:
                d = ray.at(depth_.at(ray.x, y));
                break;
        }
        uv[2 * i] = d.x;
        uv[2 * i + 1] = d.y;
    }
}

}  // namespace eikonal
