#include "warp/displace/depth/depth_meeting.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

namespace eikonal {
namespace {

using Range = DepthPlane::Range;

int floor_block(int a) {
    return floor_div(a, DepthPlane::kBlock);
}

/// What is nearer than this part of a ray's depth is before it, and the ray does not run into it.
constexpr double kBehind = 0.95;
/// Of a hidden ray's next step, to kMarchStep.
constexpr int kMostHalvings = 48;

/// Whole pixels, far within an int for any displacement.
int whole(float v) {
    constexpr float kMost = 1e6f;
    return static_cast<int>(std::floor(v > -kMost ? (v < kMost ? v : kMost) : -kMost));
}

/// One pixel's bent ray and the depth buffer.
struct Ray {
    GridRows& grids;
    const DepthPlane& depth;
    int x, y;
    float front;  ///< nearest within reach

    Shift at(double z) const { return grids.at(x, z); }
    /// The depth buffer where a displacement points to.
    float buffer(Shift d) const { return depth.at(x + whole(d.x + 0.5f), y + whole(d.y + 0.5f)); }
    /// Depth where the ray stops at the latest if it is at pixel + d then: the facet's there, or that of what fronts
    /// it or a pixel that the picture's samples mix it with.
    float stop(Shift d) const {
        const float facet = buffer(d), limit = kEdgeRatio * facet;
        if (limit <= front) return facet;
        const int xi = x + whole(d.x), yi = y + whole(d.y);
        const int nx = d.x != std::floor(d.x) ? 1 : 0, ny = d.y != std::floor(d.y) ? 1 : 0;
        float nearest = std::numeric_limits<float>::infinity();
        for (int j = yi; j <= yi + ny; ++j)
            for (int i = xi; i <= xi + nx; ++i) nearest = std::min(nearest, depth.front(i, j));
        return nearest < limit ? nearest : facet;
    }
    bool blocked(Shift d, double z) const { return stop(d) <= static_cast<float>(z); }
};

/// A ray that a mirage moves: ground stands in its way nowhere but where it ends.
struct SkimmingRay : Ray {
    const MirageGround& ground;
    double last;  ///< axial depth where it ends, on the ground or at the farthest object
    bool ends_on_ground;

    struct Facet {
        float seen;   ///< in the depth buffer
        double stop;  ///< of the ray
        float limit;  ///< objects nearer than this stand out before it: any before the ground
    };
    Facet under(Shift d) const {
        const int i = x + whole(d.x + 0.5f), j = y + whole(d.y + 0.5f);
        const float seen = depth.at(i, j);
        if (ground.is(i, j, seen)) return {seen, last, seen};
        return {seen, std::min<double>(seen, last), kEdgeRatio * seen};
    }
    bool blocked(Shift d, double z) const { return under(d).stop <= z; }
    /// Whether the picture around pixel + d holds some of an object nearer than `limit`: the samples there or,
    /// antialiased ones among these, their neighbours.
    bool at_edge(Shift d, float limit) const {
        if (limit <= depth.nearest()) return false;
        const int xi = x + whole(d.x), yi = y + whole(d.y);
        const int nx = d.x != std::floor(d.x) ? 1 : 0, ny = d.y != std::floor(d.y) ? 1 : 0;
        for (int j = yi - 1; j <= yi + ny + 1; ++j)
            for (int i = xi - 1; i <= xi + nx + 1; ++i)
                if (const float there = depth.at(i, j); there < limit && !ground.is(i, j, there)) return true;
        return false;
    }
    /// d, or where the picture's samples there mix in something much nearer, a point beside it that is as deep and
    /// clear of it; the centre of the facet if there is none. Off the ground, only outlines across the way that the
    /// mirage moves the picture matter: the others move along themselves. A ray that never comes down to the ground
    /// does not look for any.
    Shift settled(Shift d) const {
        const auto [seen, stop, limit] = under(d);
        if (!at_edge(d, limit) || (limit == seen && !ends_on_ground)) return d;
        const auto beside = [&](float wx, float wy) { return Shift{d.x + wx, d.y + wy}; };
        const auto alike = [&](Shift there) {
            const float z = under(there).seen;
            return z >= kEdgeRatio * seen && kEdgeRatio * z <= seen;
        };
        if (limit == seen) {
            constexpr std::array<std::array<float, 2>, 8> kWays{
                {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
            for (float aside = 0.5f; aside <= kFarthestBack; aside += 0.5f)
                for (const auto& [wx, wy] : kWays)
                    if (const Shift there = beside(aside * wx, aside * wy); alike(there) && !at_edge(there, limit))
                        return there;
        } else if (const float length = std::sqrt(d.x * d.x + d.y * d.y); length > 1) {
            constexpr float kRim = 1.5f;
            const float wx = d.x / length, wy = d.y / length;
            const auto object = [&](float way) { return under(beside(way * wx, way * wy)).seen < limit; };
            for (const float side : {1.0f, -1.0f}) {
                if (!object(side * kRim) || object(-side * kRim)) continue;
                for (float back = 0.5f; back <= kRim; back += 0.5f)
                    if (const Shift there = beside(-side * back * wx, -side * back * wy);
                        alike(there) && !object(side * (kRim - back)))
                        return there;
            }
        }
        return {static_cast<float>(whole(d.x + 0.5f)), static_cast<float>(whole(d.y + 0.5f))};
    }
    /// d, or where the ray passes over the ground for good but the picture's samples there mix in some that is much
    /// nearer than what it sees, as at the horizon: the nearest point along its way over the screen, to either side, or
    /// to any if it has none, that is as deep and clear of it. Only ground whose own pixel sees other things counts.
    Shift above_ground(Shift d) const {
        if (ends_on_ground) return d;
        const float seen = under(d).seen;
        const bool on_ground = ground.is(x + whole(d.x + 0.5f), y + whole(d.y + 0.5f), seen);
        const float limit = on_ground ? std::numeric_limits<float>::infinity() : kEdgeRatio * seen;
        const auto mixes_ground = [&](Shift there) {
            const int xi = x + whole(there.x), yi = y + whole(there.y);
            const int nx = there.x != std::floor(there.x) ? 2 : 1, ny = there.y != std::floor(there.y) ? 2 : 1;
            for (int j = yi - 1; j <= yi + ny; ++j)
                for (int i = xi - 1; i <= xi + nx; ++i)
                    if (const float near = depth.at(i, j);
                        near < limit && ground.is(i, j, near) && ground.mirrors(i, j))
                        return true;
            return false;
        };
        if (!mixes_ground(d)) return d;
        const float length = std::sqrt(d.x * d.x + d.y * d.y);
        std::array<Shift, 8> ways{{{0, -1}, {0, 1}, {-1, 0}, {1, 0}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
        std::size_t count = ways.size();
        if (length > 0) {
            ways[0] = {d.x / length, d.y / length};
            ways[1] = {-ways[0].x, -ways[0].y};
            count = 2;
        }
        for (float way = 0.25f; way <= kAboveGround; way += 0.25f)
            for (std::size_t k = 0; k < count; ++k) {
                const Shift there{d.x + way * ways[k].x, d.y + way * ways[k].y};
                const float z = under(there).seen;
                const bool alike = on_ground || (z >= kEdgeRatio * seen && kEdgeRatio * z <= seen);
                if (alike && !mixes_ground(there)) return there;
            }
        return d;
    }
    /// The last point d before the ray passes behind an object at `blocked`, moved back from the object's outline until
    /// no sample of a cubic filter there, antialiased ones beside the outline included, holds any of it.
    Shift stood_back(Shift d, Shift blocked, Shift before) const {
        const float bx = before.x - blocked.x, by = before.y - blocked.y, length = std::sqrt(bx * bx + by * by);
        const auto [seen, stop, limit] = under(d);
        for (float back = 0.5f; length > 0 && back <= kFarthestBack; back += 0.5f) {
            const Shift there{d.x + back / length * bx, d.y + back / length * by};
            if (under(there).seen >= kEdgeRatio * seen && !at_edge(there, limit)) return there;
        }
        return settled(d);
    }
    /// What stands in for `end`, where a ray ends that has passed behind an object at depth `passed`: to either side of
    /// it, along the plane, hence at right angles to the ray's way `along` over the screen. The nearest ground as deep,
    /// where it ends on ground, else the nearest that lies behind the object.
    std::optional<Shift> beside(Shift end, Shift along, double passed) const {
        constexpr double kAlike = 0.05;
        const float length = std::sqrt(along.x * along.x + along.y * along.y);
        if (!(length > 0)) return std::nullopt;
        const float ax = -along.y / length, ay = along.x / length;
        const PixelWindow& w = depth.window();
        for (int k = 1; k <= kFarthestAside; ++k)
            for (const int side : {-k, k}) {
                const Shift there{end.x + static_cast<float>(side) * ax, end.y + static_cast<float>(side) * ay};
                const int i = x + whole(there.x + 0.5f), j = y + whole(there.y + 0.5f);
                if (i < w.x0 || j < w.y0 || i >= w.x0 + w.width || j >= w.y0 + w.height) continue;
                const float seen = depth.at(i, j);
                const bool on_ground = ground.is(i, j, seen);
                if (ends_on_ground ? on_ground && std::abs(seen - last) <= kAlike * last && !at_edge(there, seen)
                                   : !on_ground && seen > passed && !at_edge(there, kEdgeRatio * seen))
                    return there;
            }
        return std::nullopt;
    }
    /// Whether an object at about depth z is upon pixel + d or beside it.
    bool touches(Shift d, double z) const {
        const int xi = x + whole(d.x + 0.5f), yi = y + whole(d.y + 0.5f);
        for (int j = yi - 1; j <= yi + 1; ++j)
            for (int i = xi - 1; i <= xi + 1; ++i)
                if (const float there = depth.at(i, j); there >= kBehind * z && kBehind * there <= z)
                    if (!ground.is(i, j, there)) return true;
        return false;
    }
    /// Whether no object up to depth z is about the way from pixel + a to pixel + b. Looks at single pixels where these
    /// are few.
    bool clear(Shift a, Shift b, double z) const {
        constexpr int kFew = 64;
        const int x0 = x + whole(std::min(a.x, b.x)) - 1, y0 = y + whole(std::min(a.y, b.y)) - 1;
        const int x1 = x + whole(std::max(a.x, b.x)) + 2, y1 = y + whole(std::max(a.y, b.y)) + 2;
        if (ground.clear(x0, y0, x1, y1, z)) return true;
        if (static_cast<std::int64_t>(x1 - x0 + 1) * (y1 - y0 + 1) > kFew) return false;
        for (int j = y0; j <= y1; ++j)
            for (int i = x0; i <= x1; ++i)
                if (const float there = depth.at(i, j); there <= z && !ground.is(i, j, there)) return false;
        return true;
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
template <class AnyRay>
Shift bisect(const AnyRay& ray, double z, Shift d, double behind, Shift e) {
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
        const float facet = std::min(ray.stop(d), range.farthest);
        if (facet <= z) return d;
        const Shift upon = ray.at(facet);
        if (same_pixel(upon, d) && std::min(ray.stop(upon), range.farthest) == facet) return upon;
        double next = facet;
        Shift e = upon;
        if (const double way = motion(upon, d); way > kMarchStep) {
            // even in inverse depth: the displacement of an object changes most where it is near
            next = 1 / (1 / z + (1 / facet - 1 / z) * (kMarchStep / way));
            e = ray.at(next);
        }
        if (ray.blocked(e, next)) {
            // a facet met exactly at its own depth, or something that the ray ran into on its way there
            return ray.stop(e) == static_cast<float>(next) ? e : bisect(ray, z, d, next, e);
        }
        z = next;
        d = e;
    }
    return d;
}

/// A point of a ray.
struct Point {
    double z;
    Shift d;
};

/// Follows a ray that has passed behind an object to where it is in the open again, or to its end.
Point follow_hidden(const SkimmingRay& ray, Point p) {
    for (int step = 0; step < kMostMarchSteps && p.z < ray.last && ray.under(p.d).stop <= p.z; ++step) {
        double next = ray.last;
        Shift e = ray.at(next);
        for (int i = 0; i < kMostHalvings && motion(e, p.d) > kMarchStep; ++i) {
            next = 2 / (1 / p.z + 1 / next);
            e = ray.at(next);
        }
        p = {next, e};
    }
    return p;
}

/// The march of a ray that skims the ground: leaps that no object is about, at most kMarchStep where one is. Edges
/// matter where the ray ends only: on its way up from the ground it may pass close by, or behind.
Shift skim(const SkimmingRay& ray, double nearest) {
    constexpr double kLeastLeap = 1e-9, kLongerLeap = 4;
    double z = std::min(nearest, ray.last);
    Shift d = ray.at(z);
    double leap = 1;                // of the way to where the ray would stop, in inverse depth
    std::optional<Shift> in_sight;  // last, before the ray passed behind something
    for (int step = 0; step < kMostMarchSteps; ++step) {
        const SkimmingRay::Facet facet = ray.under(d);
        if (facet.stop <= z) break;
        const Shift upon = ray.at(facet.stop);
        if (same_pixel(upon, d)) return ray.settled(upon);
        leap = std::min(1.0, kLongerLeap * leap);
        const auto reached = [&] { return leap < 1 ? 1 / (1 / z + (1 / facet.stop - 1 / z) * leap) : facet.stop; };
        double next = reached();
        Shift e = leap < 1 ? ray.at(next) : upon;
        while (motion(e, d) > kMarchStep && leap > kLeastLeap && !ray.clear(d, e, next)) {
            leap *= 0.5;
            next = reached();
            e = ray.at(next);
        }
        if (const SkimmingRay::Facet met = ray.under(e); met.stop <= next) {
            if (met.stop == next) return ray.settled(e);
            const Shift last_open = bisect(ray, z, d, next, e);
            // what lies before the ray by then, and not beside what it was over, is an object that it passes behind
            if (met.stop >= z || met.seen >= facet.limit) return ray.settled(last_open);
            if (met.stop >= kBehind * z && ray.touches(ray.at(met.stop), met.stop)) return last_open;  // its foot
            if (!in_sight) in_sight = ray.stood_back(last_open, e, d);
            const Shift way{e.x - d.x, e.y - d.y};
            const auto [open, there] = follow_hidden(ray, {next, e});
            if (ray.under(there).stop <= open) {
                if (ray.under(there).stop == open) return ray.settled(there);
                return ray.beside(there, way, next).value_or(*in_sight);
            }
            next = open;
            e = there;
        }
        z = next;
        d = e;
    }
    return in_sight ? *in_sight : ray.settled(d);
}

/// kFixedPointSteps or fewer times D <- what is under s(D).
Shift fixed_point(const SkimmingRay& ray, int steps) {
    double z = ray.under({}).stop;
    Shift d = ray.at(z);
    for (int i = 0; i < steps; ++i) {
        const double next = ray.under(d).stop;
        if (next == z) break;
        z = next;
        d = ray.at(z);
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
    return {std::min(a.nearest, b.nearest), std::max(a.farthest, b.farthest), std::min(a.front, b.front)};
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
    fronts_.resize(metres_.size());
    tbb::parallel_for(0, block_rows_, [&](int block) {
        Range* row = blocks_.data() + static_cast<std::size_t>(block) * static_cast<std::size_t>(block_columns_);
        for (int y = block * kBlock; y < std::min(window.height, (block + 1) * kBlock); ++y) {
            find_fronts(y);
            const auto line = static_cast<std::size_t>(y) * static_cast<std::size_t>(window.width);
            const float *z = metres_.data() + line, *front = fronts_.data() + line;
            for (int x = 0; x < window.width; ++x) row[x / kBlock] = unite(row[x / kBlock], {z[x], z[x], front[x]});
        }
    });
}

void DepthPlane::find_fronts(int y) {
    for (int x = 0; x < window_.width; ++x) {
        const int px = window_.x0 + x, py = window_.y0 + y;
        const float z = at(px, py), limit = kEdgeRatio * z;
        float front = std::numeric_limits<float>::infinity();
        for (int j = -1; j <= 1; ++j)
            for (int i = -1; i <= 1; ++i) {
                const float there = at(px + i, py + j);
                if (there >= limit) continue;
                const float slope = std::max(0.0f, 1 / z - 1 / at(px - i, py - j));
                if (kEdgeRatio / there > 1 / z + slope) front = std::min(front, there);
            }
        fronts_[index(px, py)] = front;
    }
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

MirageGround::MirageGround(const DepthPlane& depth, const PixelWindow& tile, int reach, std::span<const Mirage> mirages)
    : mirages_(mirages), window_(depth.window()) {
    constexpr int kBlock = DepthPlane::kBlock;
    const int x0 = std::max(tile.x0 - reach, window_.x0), y0 = std::max(tile.y0 - reach, window_.y0);
    const int x1 = std::min(tile.x0 + tile.width + reach, window_.x0 + window_.width) - 1;
    const int y1 = std::min(tile.y0 + tile.height + reach, window_.y0 + window_.height) - 1;
    column0_ = floor_block(x0 - window_.x0);
    row0_ = floor_block(y0 - window_.y0);
    columns_ = floor_block(x1 - window_.x0) - column0_ + 1;
    rows_ = floor_block(y1 - window_.y0) - row0_ + 1;
    nearest_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_),
                    std::numeric_limits<float>::max());
    const int bottom = std::min(window_.y0 + window_.height, window_.y0 + (row0_ + rows_) * kBlock);
    const int right = std::min(window_.x0 + window_.width, window_.x0 + (column0_ + columns_) * kBlock);
    for (int y = window_.y0 + row0_ * kBlock; y < bottom; ++y) {
        float* row = nearest_.data() + static_cast<std::ptrdiff_t>((y - window_.y0) / kBlock - row0_) * columns_;
        for (int x = window_.x0 + column0_ * kBlock; x < right; ++x) {
            float& nearest = row[(x - window_.x0) / kBlock - column0_];
            if (const float z = depth.at(x, y); z < nearest && !is(x, y, z)) nearest = z;
        }
    }
}

bool MirageGround::clear(int x0, int y0, int x1, int y1, double z) const {
    const auto column = [this](int x) { return std::clamp(floor_block(x - window_.x0) - column0_, 0, columns_ - 1); };
    const auto row = [this](int y) { return std::clamp(floor_block(y - window_.y0) - row0_, 0, rows_ - 1); };
    for (int j = row(y0); j <= row(y1); ++j)
        for (int i = column(x0); i <= column(x1); ++i)
            if (nearest_[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) +
                         static_cast<std::size_t>(i)] <= z)
                return false;
    return true;
}

TileMeeting::TileMeeting(const DepthPlane& depth, const PixelWindow& tile, DepthMeeting how, int reach,
                         std::span<const Mirage> mirages)
    : depth_(depth), tile_(tile), how_(how) {
    if (!mirages.empty()) ground_ = MirageGround(depth, tile, how == DepthMeeting::March ? reach : 0, mirages);
    if (how != DepthMeeting::March) return;
    ranges_ = depth.around(tile, reach);
    range_columns_ =
        floor_block(tile.x0 + tile.width - 1 - depth.window().x0) - floor_block(tile.x0 - depth.window().x0) + 1;
}

Shift TileMeeting::over_ground(GridRows& grids, int x, int y, const DepthPlane::Range& range) const {
    const double end = grids.end(x);
    const SkimmingRay ray{
        {grids, depth_, x, y, range.front}, ground_, std::min<double>(end, range.farthest), end <= range.farthest};
    switch (how_) {
        case DepthMeeting::March:
            return ray.above_ground(skim(ray, range.nearest));
        case DepthMeeting::FixedPoint:
            return fixed_point(ray, kFixedPointSteps);
        case DepthMeeting::Own:
            return fixed_point(ray, 0);
    }
    return {};
}

void TileMeeting::row(GridRows& grids, int y, float* uv) const {
    const PixelWindow& window = depth_.window();
    const int first_column = floor_block(tile_.x0 - window.x0);
    const auto first =
        static_cast<std::size_t>((floor_block(y - window.y0) - floor_block(tile_.y0 - window.y0)) * range_columns_);
    for (int i = 0; i < tile_.width; ++i) {
        const int x = tile_.x0 + i;
        const Range range = how_ == DepthMeeting::March
                                ? ranges_[first + static_cast<std::size_t>(floor_block(x - window.x0) - first_column)]
                                : Range{depth_.nearest(), depth_.farthest()};
        const Ray ray{grids, depth_, x, y, range.front};
        Shift d;
        if (grids.mirage_moves(ray.x)) {
            d = over_ground(grids, ray.x, y, range);
        } else {
            switch (how_) {
                case DepthMeeting::March:
                    d = march(ray, range);
                    if (ground_.any() && std::isfinite(depth_.front(x + whole(d.x), y + whole(d.y))))
                        d = SkimmingRay{ray, ground_, range.farthest, false}.above_ground(d);
                    break;
                case DepthMeeting::FixedPoint:
                    d = fixed_point(ray);
                    break;
                case DepthMeeting::Own:
                    d = ray.at(depth_.at(ray.x, y));
                    break;
            }
        }
        uv[2 * i] = d.x;
        uv[2 * i + 1] = d.y;
    }
}

Shift meet_smooth_surface(GridRows& grids, const DepthPlane& depth, bool perspective, int x, int y, Shift met) {
    constexpr int kMostSteps = 32;
    constexpr float kSettled = 1e-5F;  // [px]
    const auto value = [&](int i, int j) { return perspective ? 1 / depth.at(i, j) : depth.at(i, j); };
    Shift d = met;
    for (int step = 0; step < kMostSteps && motion(d, met) <= 1; ++step) {
        const int i = x + whole(d.x), j = y + whole(d.y);
        const auto [low, high] =
            std::minmax({depth.at(i, j), depth.at(i + 1, j), depth.at(i, j + 1), depth.at(i + 1, j + 1)});
        if (low < kEdgeRatio * high) return met;
        const float fx = d.x - std::floor(d.x), fy = d.y - std::floor(d.y);
        const float q = (1 - fy) * ((1 - fx) * value(i, j) + fx * value(i + 1, j)) +
                        fy * ((1 - fx) * value(i, j + 1) + fx * value(i + 1, j + 1));
        const Shift next = grids.at(x, perspective ? 1 / q : q);
        if (motion(next, d) < kSettled) return next;
        d = next;
    }
    return met;
}

}  // namespace eikonal
