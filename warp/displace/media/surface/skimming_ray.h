/// The ray of a pixel that a mirage moves, among the ground and the objects of a depth buffer.
///
/// The ray skims over the ground. Ground is in its way nowhere but where the ray meets the surface itself; objects are,
/// as they are for every ray. Places are given as displacements d from the ray's pixel, depths are axial [m].
///
/// The picture is filtered, and its pixels beside an edge show some of both sides. The functions clear_of_…() move the
/// place that is read from the picture a little, so that a sample there shows nothing that the ray does not see.
#pragma once

#include <optional>

#include "warp/displace/depth/meeting_ray.h"
#include "warp/displace/media/surface/mirage_ground.h"

namespace eikonal {

/// How far a place may be moved to be clear of an object's outline, and to be clear of the ground [px].
inline constexpr float kFarthestBack = 4, kAboveGround = 3;
/// How far beside a hidden place its stand-in may be [px].
inline constexpr int kFarthestAside = 256;
/// What is nearer than this part of a ray's depth lies before the ray, which does not run into it.
inline constexpr double kBehind = 0.95;

struct SkimmingRay : MeetingRay {
    const MirageGround& ground;
    double end;  ///< depth where the ray ends, on the ground or at the farthest object
    bool ends_on_ground;

    /// The pixel nearest to a place.
    struct Facet {
        float depth;       ///< in the depth buffer
        double stop;       ///< depth at which the ray stops there: `end` if the facet is ground
        float edge_limit;  ///< objects nearer than this stand out before it; before ground all nearer ones do
        bool is_ground() const { return edge_limit == depth; }
        /// Whether two facets, or a facet and a depth, may belong to one surface.
        bool as_deep_as(float z) const { return depth >= kEdgeRatio * z && kEdgeRatio * depth <= z; }
    };
    Facet facet_at(Shift d) const {
        const int i = x + nearest_pixel(d.x), j = y + nearest_pixel(d.y);
        const float z = depth.at(i, j);
        if (ground.contains(i, j, z)) return {z, end, z};
        return {z, std::min<double>(z, end), kEdgeRatio * z};
    }
    bool blocked(Shift d, double z) const { return facet_at(d).stop <= z; }

    /// Whether no object at depth z or nearer is near the way from pixel + a to pixel + b.
    bool path_is_clear(Shift a, Shift b, double z) const;
    /// Whether an object at about depth z is on the pixel at d, or on one of its neighbours.
    bool object_at(Shift d, double z) const;

    /// A place near d that is as deep and clear of anything much nearer; d if it is clear itself, and the centre of its
    /// pixel if there is no such place. Off the ground only outlines across the ray's way over the picture count,
    /// because what has outlines along that way moves with the ray. A ray that never comes down to the ground is not
    /// moved off the ground.
    Shift clear_of_edges(Shift d) const;
    /// The place that stands in for what is hidden behind an object, if d is the ray's last visible place, `blocked`
    /// lies behind the object, and `before` lies before d. It is moved back from the object's outline, by kFarthestBack
    /// at most, until no sample of a cubic filter shows any of the object or its antialiased rim.
    Shift clear_of_outline(Shift d, Shift blocked, Shift before) const;
    /// For a ray that does not end on the ground: the place nearest to d that is as deep and whose samples show no
    /// ground, at most kAboveGround away along the ray's way over the picture, to either side. A ray that has no such
    /// way looks all around. Only ground that is a mirror counts. The result is d if d is clear, or if there is no such
    /// place.
    Shift clear_of_ground(Shift d) const;
    /// What stands in for the place d_end, where the ray ends behind an object at depth z_object. Places along the
    /// surface are searched, at right angles to `way`, the direction of the ray over the picture, on either side. If
    /// the ray ends on the ground, the nearest ground that is as deep stands in; otherwise the nearest object that lies
    /// behind the hiding one does. Nothing if none is within kFarthestAside.
    std::optional<Shift> stand_in(Shift d_end, Shift way, double z_object) const;

  private:
    bool near_object(Shift d, float limit) const;
    std::optional<Shift> clear_around(Shift d, const Facet& facet) const;
    std::optional<Shift> clear_across_way(Shift d, const Facet& facet) const;
    bool shows_ground(Shift d, float limit) const;
};

}  // namespace eikonal
