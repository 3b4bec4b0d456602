#include "warp/displace/depth/depth_meeting.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace eikonal {
namespace {

using Range = DepthPlane::Range;

Shift march(const MeetingRay& ray, const Range& range) {
    double z = range.nearest;
    Shift d = ray.at(z);
    if (range.nearest == range.farthest) return d;
    for (int step = 0; step < kMostMarchSteps; ++step) {
        const float facet = std::min(ray.stop(d), range.farthest);
        if (facet <= z) return d;
        const Shift at_facet = ray.at(facet);
        if (same_pixel(at_facet, d) && std::min(ray.stop(at_facet), range.farthest) == facet) return at_facet;
        double next = facet;
        Shift e = at_facet;
        if (const double way = distance_between(at_facet, d); way > kMarchStep) {
            // Steps are even in inverse depth, because displacement changes most where an object is near.
            next = 1 / (1 / z + (1 / facet - 1 / z) * (kMarchStep / way));
            e = ray.at(next);
        }
        if (ray.blocked(e, next)) {
            // Either the facet is met exactly at its own depth, or the ray ran into something on its way there.
            return ray.stop(e) == static_cast<float>(next) ? e : last_clear_point(ray, z, d, next, e);
        }
        z = next;
        d = e;
    }
    return d;
}

Shift fixed_point(const MeetingRay& ray) {
    float z = ray.depth.at(ray.x, ray.y);
    Shift d = ray.at(z);
    for (int i = 0; i < kFixedPointSteps; ++i) {
        const float next = ray.depth_at(d);
        if (next == z) break;
        z = next;
        d = ray.at(z);
    }
    return d;
}

}  // namespace

TileMeeting::TileMeeting(const DepthPlane& depth, const PixelWindow& tile, DepthMeeting how, int largest_shift,
                         std::unique_ptr<const BentMeeting> bent)
    : depth_(depth), tile_(tile), how_(how), bent_(std::move(bent)) {
    if (how != DepthMeeting::March) return;
    ranges_ = depth.around(tile, largest_shift);
    range_columns_ = depth.block_column(tile.x0 + tile.width - 1) - depth.block_column(tile.x0) + 1;
}

Shift TileMeeting::meet(const MeetingRay& ray, const Range& range) const {
    switch (how_) {
        case DepthMeeting::March: {
            const Shift d = march(ray, range);
            if (bent_ && std::isfinite(depth_.front(ray.x + floor_pixel(d.x), ray.y + floor_pixel(d.y))))
                return bent_->corrected_at_edge(ray, range, d);
            return d;
        }
        case DepthMeeting::FixedPoint:
            return fixed_point(ray);
        case DepthMeeting::Own:
            return ray.at(depth_.at(ray.x, ray.y));
    }
    return {};
}

void TileMeeting::row(GridRows& rows, int y, float* uv) const {
    const int first_column = depth_.block_column(tile_.x0);
    const auto first = static_cast<std::size_t>((depth_.block_row(y) - depth_.block_row(tile_.y0)) * range_columns_);
    for (int i = 0; i < tile_.width; ++i) {
        const int x = tile_.x0 + i;
        const Range range = how_ == DepthMeeting::March
                                ? ranges_[first + static_cast<std::size_t>(depth_.block_column(x) - first_column)]
                                : Range{depth_.nearest(), depth_.farthest()};
        const MeetingRay ray{rows, depth_, x, y, range.front};
        const Shift d = rows.bender_moves(x) ? bent_->meet(ray, range) : meet(ray, range);
        uv[2 * i] = d.x;
        uv[2 * i + 1] = d.y;
    }
}

Shift meet_smooth_surface(GridRows& rows, const DepthPlane& depth, bool perspective, int x, int y, Shift met) {
    constexpr int kMostSteps = 32;
    constexpr float kSettled = 1e-5F;  // [px]
    const auto value = [&](int i, int j) { return perspective ? 1 / depth.at(i, j) : depth.at(i, j); };
    Shift d = met;
    for (int step = 0; step < kMostSteps && distance_between(d, met) <= 1; ++step) {
        const int i = x + floor_pixel(d.x), j = y + floor_pixel(d.y);
        const auto [low, high] =
            std::minmax({depth.at(i, j), depth.at(i + 1, j), depth.at(i, j + 1), depth.at(i + 1, j + 1)});
        if (low < kEdgeRatio * high) return met;
        const float fx = d.x - std::floor(d.x), fy = d.y - std::floor(d.y);
        const float q = (1 - fy) * ((1 - fx) * value(i, j) + fx * value(i + 1, j)) +
                        fy * ((1 - fx) * value(i, j + 1) + fx * value(i + 1, j + 1));
        const Shift next = rows.at(x, perspective ? 1 / q : q);
        if (distance_between(next, d) < kSettled) return next;
        d = next;
    }
    return met;
}

}  // namespace eikonal
