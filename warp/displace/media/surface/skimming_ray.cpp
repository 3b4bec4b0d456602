#include "warp/displace/media/surface/skimming_ray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace eikonal {
namespace {

/// Step of the search for a clear place, and of the finer one beside the ground [px].
constexpr float kBackStep = 0.5f, kGroundStep = 0.25f;

Shift moved(Shift d, float distance, Shift direction) {
    return {d.x + distance * direction.x, d.y + distance * direction.y};
}

}  // namespace

bool SkimmingRay::path_is_clear(Shift a, Shift b, double z) const {
    // Blocks are looked at first. Where there are few pixels, they are worth a closer look.
    constexpr int kFew = 64;
    const int x0 = x + floor_pixel(std::min(a.x, b.x)) - 1, y0 = y + floor_pixel(std::min(a.y, b.y)) - 1;
    const int x1 = x + floor_pixel(std::max(a.x, b.x)) + 2, y1 = y + floor_pixel(std::max(a.y, b.y)) + 2;
    if (ground.is_clear(x0, y0, x1, y1, z)) return true;
    if (static_cast<std::int64_t>(x1 - x0 + 1) * (y1 - y0 + 1) > kFew) return false;
    for (int j = y0; j <= y1; ++j)
        for (int i = x0; i <= x1; ++i)
            if (const float there = depth.at(i, j); there <= z && !ground.contains(i, j, there)) return false;
    return true;
}

bool SkimmingRay::object_at(Shift d, double z) const {
    const int xi = x + nearest_pixel(d.x), yi = y + nearest_pixel(d.y);
    for (int j = yi - 1; j <= yi + 1; ++j)
        for (int i = xi - 1; i <= xi + 1; ++i)
            if (const float there = depth.at(i, j); there >= kBehind * z && kBehind * there <= z)
                if (!ground.contains(i, j, there)) return true;
    return false;
}

/// Whether the picture around d shows some of an object nearer than `limit`. The samples there may, or their
/// neighbours, which share an antialiased rim with them.
bool SkimmingRay::near_object(Shift d, float limit) const {
    if (limit <= depth.nearest()) return false;
    const PixelsAround around(x, y, d);
    for (int j = around.y0 - 1; j <= around.y1 + 1; ++j)
        for (int i = around.x0 - 1; i <= around.x1 + 1; ++i)
            if (const float there = depth.at(i, j); there < limit && !ground.contains(i, j, there)) return true;
    return false;
}

Shift SkimmingRay::clear_of_edges(Shift d) const {
    const Facet facet = facet_at(d);
    if (!near_object(d, facet.edge_limit) || (facet.is_ground() && !ends_on_ground)) return d;
    const std::optional<Shift> clear = facet.is_ground() ? clear_around(d, facet) : clear_across_way(d, facet);
    return clear.value_or(Shift{static_cast<float>(nearest_pixel(d.x)), static_cast<float>(nearest_pixel(d.y))});
}

/// The nearest place in any of eight directions that is as deep as the facet at d and clear of objects before it.
std::optional<Shift> SkimmingRay::clear_around(Shift d, const Facet& facet) const {
    constexpr std::array<Shift, 8> kDirections{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
    for (float distance = kBackStep; distance <= kFarthestBack; distance += kBackStep)
        for (const Shift& direction : kDirections)
            if (const Shift there = moved(d, distance, direction);
                facet_at(there).as_deep_as(facet.depth) && !near_object(there, facet.edge_limit))
                return there;
    return std::nullopt;
}

/// The nearest place back along the way from the pixel to d that is clear of an outline across this way.
std::optional<Shift> SkimmingRay::clear_across_way(Shift d, const Facet& facet) const {
    constexpr float kRim = 1.5f;  // [px] width of an antialiased rim
    const float length = length_of(d);
    if (!(length > 1)) return std::nullopt;
    const Shift way{d.x / length, d.y / length};
    const auto is_object = [&](float distance) { return facet_at(moved(d, distance, way)).depth < facet.edge_limit; };
    for (const float side : {1.0f, -1.0f}) {
        if (!is_object(side * kRim) || is_object(-side * kRim)) continue;
        for (float back = kBackStep; back <= kRim; back += kBackStep)
            if (const Shift there = moved(d, -side * back, way);
                facet_at(there).as_deep_as(facet.depth) && !is_object(side * (kRim - back)))
                return there;
    }
    return std::nullopt;
}

Shift SkimmingRay::clear_of_outline(Shift d, Shift blocked, Shift before) const {
    const float bx = before.x - blocked.x, by = before.y - blocked.y, length = std::sqrt(bx * bx + by * by);
    const Facet facet = facet_at(d);
    for (float back = kBackStep; length > 0 && back <= kFarthestBack; back += kBackStep) {
        const Shift there{d.x + back / length * bx, d.y + back / length * by};
        if (facet_at(there).depth >= kEdgeRatio * facet.depth && !near_object(there, facet.edge_limit)) return there;
    }
    return clear_of_edges(d);
}

/// Whether the picture around d shows some ground that is nearer than `limit` and a mirror. Neighbours of samples
/// count, as in near_object().
bool SkimmingRay::shows_ground(Shift d, float limit) const {
    const PixelsAround around(x, y, d);
    for (int j = around.y0 - 1; j <= around.y1 + 1; ++j)
        for (int i = around.x0 - 1; i <= around.x1 + 1; ++i)
            if (const float there = depth.at(i, j);
                there < limit && ground.contains(i, j, there) && ground.is_mirror(i, j))
                return true;
    return false;
}

Shift SkimmingRay::clear_of_ground(Shift d) const {
    if (ends_on_ground) return d;
    const Facet facet = facet_at(d);
    const float limit = facet.is_ground() ? std::numeric_limits<float>::infinity() : facet.edge_limit;
    if (!shows_ground(d, limit)) return d;
    const float length = length_of(d);
    std::array<Shift, 8> directions{{{0, -1}, {0, 1}, {-1, 0}, {1, 0}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
    std::size_t count = directions.size();
    if (length > 0) {
        directions[0] = {d.x / length, d.y / length};
        directions[1] = {-directions[0].x, -directions[0].y};
        count = 2;
    }
    for (float distance = kGroundStep; distance <= kAboveGround; distance += kGroundStep)
        for (std::size_t k = 0; k < count; ++k) {
            const Shift there = moved(d, distance, directions[k]);
            if ((facet.is_ground() || facet_at(there).as_deep_as(facet.depth)) && !shows_ground(there, limit))
                return there;
        }
    return d;
}

std::optional<Shift> SkimmingRay::stand_in(Shift d_end, Shift way, double z_object) const {
    constexpr double kAlike = 0.05;  // largest relative difference of depth
    const float length = length_of(way);
    if (!(length > 0)) return std::nullopt;
    const Shift aside{-way.y / length, way.x / length};
    const PixelWindow& w = depth.window();
    for (int k = 1; k <= kFarthestAside; ++k)
        for (const int side : {-k, k}) {
            const Shift there = moved(d_end, static_cast<float>(side), aside);
            const int i = x + nearest_pixel(there.x), j = y + nearest_pixel(there.y);
            if (i < w.x0 || j < w.y0 || i >= w.x0 + w.width || j >= w.y0 + w.height) continue;
            const float z = depth.at(i, j);
            const bool on_ground = ground.contains(i, j, z);
            if (ends_on_ground ? on_ground && std::abs(z - end) <= kAlike * end && !near_object(there, z)
                               : !on_ground && z > z_object && !near_object(there, kEdgeRatio * z))
                return there;
        }
    return std::nullopt;
}

}  // namespace eikonal
