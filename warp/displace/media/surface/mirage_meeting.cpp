#include "warp/displace/media/surface/mirage_meeting.h"

#include <algorithm>
#include <optional>

#include "warp/displace/media/surface/mirage_ground.h"
#include "warp/displace/media/surface/skimming_ray.h"

namespace eikonal {
namespace {

struct RayPoint {
    double z;
    Shift d;
};

/// Follows a ray that has passed behind an object until it is visible again, or to its end.
RayPoint follow_hidden(const SkimmingRay& ray, RayPoint p) {
    constexpr int kMostHalvings = 48;  // of a step, until it is no longer than kMarchStep
    for (int step = 0; step < kMostMarchSteps && p.z < ray.end && ray.facet_at(p.d).stop <= p.z; ++step) {
        RayPoint next{ray.end, ray.at(ray.end)};
        for (int i = 0; i < kMostHalvings && distance_between(next.d, p.d) > kMarchStep; ++i) {
            next.z = 2 / (1 / p.z + 1 / next.z);
            next.d = ray.at(next.z);
        }
        p = next;
    }
    return p;
}

/// The march of one ray over the ground. It leaps as long as no object is near, and takes steps of kMarchStep at most
/// where one is. Edges of objects matter only where the ray ends: on its way it may pass close to them, or behind.
class GroundMarch {
  public:
    GroundMarch(const SkimmingRay& ray, double nearest) : ray_(ray), now_{std::min(nearest, ray.end), {}} {
        now_.d = ray.at(now_.z);
    }

    Shift end() {
        for (int step = 0; step < kMostMarchSteps; ++step) {
            const SkimmingRay::Facet facet = ray_.facet_at(now_.d);
            if (facet.stop <= now_.z) break;
            const Shift at_stop = ray_.at(facet.stop);
            if (same_pixel(at_stop, now_.d)) return ray_.clear_of_edges(at_stop);
            RayPoint next = next_point(facet.stop, at_stop);
            if (ray_.facet_at(next.d).stop <= next.z)
                if (const std::optional<Shift> end = blocked(facet, next)) return *end;
            now_ = next;
        }
        return last_visible_ ? *last_visible_ : ray_.clear_of_edges(now_.d);
    }

  private:
    /// The end of the next step, towards where the ray would stop on the facet under it.
    RayPoint next_point(double stop, Shift at_stop) {
        constexpr double kLeastLeap = 1e-9, kLongerLeap = 4;
        const double z = now_.z;
        leap_ = std::min(1.0, kLongerLeap * leap_);
        const auto reached = [&] { return leap_ < 1 ? 1 / (1 / z + (1 / stop - 1 / z) * leap_) : stop; };
        RayPoint next{reached(), at_stop};
        if (leap_ < 1) next.d = ray_.at(next.z);
        while (distance_between(next.d, now_.d) > kMarchStep && leap_ > kLeastLeap &&
               !ray_.path_is_clear(now_.d, next.d, next.z)) {
            leap_ *= 0.5;
            next.z = reached();
            next.d = ray_.at(next.z);
        }
        return next;
    }

    /// What a ray sees that is blocked at `next`, coming from the facet `from`. Nothing if the ray has passed behind an
    /// object and goes on: `next` is then where it is visible again.
    std::optional<Shift> blocked(const SkimmingRay::Facet& from, RayPoint& next) {
        const SkimmingRay::Facet met = ray_.facet_at(next.d);
        if (met.stop == next.z) return ray_.clear_of_edges(next.d);
        const Shift last_clear = last_clear_point(ray_, now_.z, now_.d, next.z, next.d);
        // Only what lies before the ray by now, and stands out before the facet that the ray comes from, is an object
        // that the ray passes behind.
        if (met.stop >= now_.z || met.depth >= from.edge_limit) return ray_.clear_of_edges(last_clear);
        const bool at_foot = met.stop >= kBehind * now_.z && ray_.object_at(ray_.at(met.stop), met.stop);
        if (at_foot) return last_clear;
        if (!last_visible_) last_visible_ = ray_.clear_of_outline(last_clear, next.d, now_.d);
        const Shift way{next.d.x - now_.d.x, next.d.y - now_.d.y};
        const double z_behind = next.z;
        next = follow_hidden(ray_, next);
        const double stop = ray_.facet_at(next.d).stop;
        if (stop > next.z) return std::nullopt;
        if (stop == next.z) return ray_.clear_of_edges(next.d);
        return ray_.stand_in(next.d, way, z_behind).value_or(*last_visible_);
    }

    const SkimmingRay& ray_;
    RayPoint now_;
    double leap_ = 1;  ///< length of a step, as a part of the way to where the ray would stop, in inverse depth
    std::optional<Shift> last_visible_;  ///< stands in for what is hidden, once the ray has passed behind an object
};

/// D <- depth where the ray stops at s(D), `steps` times or until it is settled.
Shift fixed_point(const SkimmingRay& ray, int steps) {
    double z = ray.facet_at({}).stop;
    Shift d = ray.at(z);
    for (int i = 0; i < steps; ++i) {
        const double next = ray.facet_at(d).stop;
        if (next == z) break;
        z = next;
        d = ray.at(z);
    }
    return d;
}

class MirageMeeting final : public BentMeeting {
  public:
    MirageMeeting(const DepthPlane& depth, const PixelWindow& tile, DepthMeeting how, int largest_shift,
                  std::span<const Mirage> mirages)
        : how_(how), ground_(depth, tile, how == DepthMeeting::March ? largest_shift : 0, mirages) {}

    Shift meet(const MeetingRay& ray, const DepthPlane::Range& range) const override {
        const double end = ray.rows.ray_end(ray.x);
        const SkimmingRay skimming{ray, ground_, std::min<double>(end, range.farthest), end <= range.farthest};
        switch (how_) {
            case DepthMeeting::March:
                return skimming.clear_of_ground(GroundMarch(skimming, range.nearest).end());
            case DepthMeeting::FixedPoint:
                return fixed_point(skimming, kFixedPointSteps);
            case DepthMeeting::Own:
                return fixed_point(skimming, 0);
        }
        return {};
    }
    Shift corrected_at_edge(const MeetingRay& ray, const DepthPlane::Range& range, Shift d) const override {
        return SkimmingRay{ray, ground_, range.farthest, false}.clear_of_ground(d);
    }

  private:
    DepthMeeting how_;
    MirageGround ground_;
};

}  // namespace

std::unique_ptr<const BentMeeting> mirage_meeting(const DepthPlane& depth, const PixelWindow& tile, DepthMeeting how,
                                                  int largest_shift, std::span<const Mirage> mirages) {
    if (mirages.empty()) return nullptr;
    return std::make_unique<MirageMeeting>(depth, tile, how, largest_shift, mirages);
}

}  // namespace eikonal
