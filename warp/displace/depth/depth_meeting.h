/// Finds where bent rays meet the depth buffer (PHYSICS.md#depth), one tile of pixels at a time.
///
/// There are three methods, the most expensive first:
///  - March: the ray's path s(z) = pixel + d(z) over the picture is followed from near to far, until the depth buffer
///    at s is nearer than z. The ray stops *before* it would pass in front of something nearer. A background therefore
///    never drags a foreground along. The picture does not show what an edge hides; the last visible point before the
///    edge is shown instead.
///  - FixedPoint: D <- depth at s(D) is repeated kFixedPointSteps times, from the pixel's own depth on.
///  - Own: D is the pixel's own depth.
///
/// Depth is read at the pixel nearest to s (depth_plane.h). The march also stops at the depth of a foreground that
/// stands out before one of the four pixels around s. A cubic filter therefore never reads foreground for background,
/// and the pixels of an edge move together with their foreground.
///
/// The march goes from facet to facet. If the path stays on the facet under the ray, one step leads to the facet's
/// depth. Otherwise a step is at most kMarchStep pixels long. If the ray is blocked between two steps, the point is
/// found by bisection, to kMarchError.
///
/// Pixels that a RowBender moves, as mirages do, are left to a BentMeeting.
#pragma once

#include <memory>
#include <vector>

#include "warp/displace/depth/depth_plane.h"
#include "warp/displace/depth/meeting_ray.h"
#include "warp/displace/grid/displacement_grid.h"

namespace eikonal {

enum class DepthMeeting { March, FixedPoint, Own };

inline constexpr int kFixedPointSteps = 8;

/// Finds where the rays of pixels that a RowBender moves meet the depth buffer. Its implementation belongs to the
/// medium.
class BentMeeting {
  public:
    virtual ~BentMeeting() = default;

    /// Displacement of a pixel that a bender moves. range: of the depths that the ray may come across.
    virtual Shift meet(const MeetingRay& ray, const DepthPlane::Range& range) const = 0;
    /// Displacement of a pixel that no bender moves and whose march has ended at d, on a pixel beside an edge. It may
    /// differ from d where that pixel shows things that benders move.
    virtual Shift corrected_at_edge(const MeetingRay& ray, const DepthPlane::Range& range, Shift d) const = 0;

  protected:
    BentMeeting() = default;
    BentMeeting(const BentMeeting&) = default;
    BentMeeting& operator=(const BentMeeting&) = default;
};

/// Finds where the rays of one tile meet the depth buffer.
class TileMeeting {
  public:
    /// tile: within depth.window(). largest_shift: bound of |d| in the tile [px]. bent: needed if row() is called with
    /// rows that have benders. depth must outlive this.
    TileMeeting(const DepthPlane& depth, const PixelWindow& tile, DepthMeeting how, int largest_shift,
                std::unique_ptr<const BentMeeting> bent = nullptr);
    /// Sets the displacement of the tile's row y (absolute): tile.width pairs of interleaved (u, v). rows: started at
    /// y.
    void row(GridRows& rows, int y, float* uv) const;

  private:
    Shift meet(const MeetingRay& ray, const DepthPlane::Range& range) const;

    const DepthPlane& depth_;
    PixelWindow tile_;
    DepthMeeting how_;
    std::vector<DepthPlane::Range> ranges_;  ///< around each block of the tile; March only
    int range_columns_ = 0;
    std::unique_ptr<const BentMeeting> bent_;
};

/// Where a ray that has met the facet under pixel + met meets the surface through the pixels' centres. Between them,
/// inverse depth (orthographic: depth) is linear. This is exact for planes, as facets are not. It is meant for pixels
/// that no bender moves. The result is `met` itself where an edge is near, or where the two points lie more than a
/// pixel apart.
Shift meet_smooth_surface(GridRows& rows, const DepthPlane& depth, bool perspective, int x, int y, Shift met);

}  // namespace eikonal
