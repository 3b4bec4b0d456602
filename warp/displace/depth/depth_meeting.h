/// Where a bent ray meets the depth buffer (PHYSICS.md#depth), one tile of pixels at a time.
///
/// Three ways, dearest first:
///  - March: follow the screen path s(z) = pixel + d(z) from near to far until the depth buffer there is nearer than z.
///    The ray stops *before* it would pass in front of something nearer, so a background never drags a foreground
///    along: what lies hidden behind an edge is not in the plate, and the last visible point before the edge stands in.
///  - FixedPoint: iterate D <- depth(s(D)) from the pixel's own depth, kFixedPointSteps times.
///  - Own: D = the pixel's own depth.
///
/// Depth is read at the pixel nearest to s, never filtered: a depth between foreground and background exists nowhere.
/// Seen so, every pixel is a facet at its own depth. The picture, though, is filtered, and an antialiased pixel beside
/// an edge holds some of the foreground, whatever its depth says: a pixel is *fronted* by a neighbour that stands out
/// before it, and a ray stops at the depth of that foreground, too, where a fronted pixel is among the four around s.
/// So no sample of a cubic filter reads foreground for background, and edge pixels move as one with what they are the
/// edge of. The march goes from facet to facet: in one leap to the depth of
/// the one under the ray if the path stays upon it, else no farther than kMarchStep pixels; a point where it is blocked
/// between is bisected to kMarchError.
///
/// A ray that a mirage moves skims over ground whose facets lie metres apart, and would be blocked by them. The plane
/// itself stands in for the pixels upon it (mirage.h): they are in no such ray's way, the ray ends where it meets the
/// plane, and it leaps over them as far as no object is about. For FixedPoint and Own, too, the depth of such a pixel
/// is where the ray ends, or the farthest one if it passes over the ground for good. Other rays meet ground as ever.
/// Such a ray may pass behind an object, where the plate does not show it, and comes out again or ends on what is
/// hidden: the ground beside it that is as deep stands in, or what lies behind the object where it does not end on
/// ground, as far as kFarthestAside. Where there is none, it is the last visible point before the object's outline, and
/// stands back from its antialiased rim, by kFarthestBack at most. One that passes over the ground for good stands
/// clear of the horizon and of an object's foot, whose pixels mix in some, by kAboveGround at most; so does a pixel
/// beside them that no mirage moves, since what it mixes in is not there any more.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "warp/displace/grid/displacement_grid.h"

namespace eikonal {

enum class DepthMeeting { March, FixedPoint, Own };

inline constexpr int kFixedPointSteps = 8;
/// [px]
inline constexpr float kMarchStep = 0.5f, kMarchError = 0.001f;
/// [px]
inline constexpr float kFarthestBack = 4, kAboveGround = 3;
inline constexpr int kFarthestAside = 256;
/// A path that needs more steps than this, beyond any plausible warp, ends where they do.
inline constexpr int kMostMarchSteps = 1024;
/// A pixel fronts its neighbour if it is nearer than this part of the neighbour's depth, and of where the plane through
/// the neighbour and the pixel on its other side would be (inverse depths of a plane are linear in perspective).
inline constexpr float kEdgeRatio = 0.8f;

/// Axial depth of every pixel of a window, in metres, positive and finite; with block extrema for the march.
class DepthPlane {
  public:
    /// Extrema of depth, and the nearest front.
    struct Range {
        float nearest, farthest;
        float front = std::numeric_limits<float>::infinity();
    };
    static constexpr int kBlock = 8;

    /// metres: window.area() > 0 values.
    DepthPlane(const PixelWindow& window, std::vector<float> metres);

    const PixelWindow& window() const { return window_; }
    /// Nearest pixel's depth; outside the window its nearest edge pixel's.
    float at(int x, int y) const { return metres_[index(x, y)]; }
    /// Depth of the nearest of the eight neighbours that fronts that pixel; infinite if none does.
    float front(int x, int y) const { return fronts_[index(x, y)]; }
    float nearest() const { return all_.nearest; }
    float farthest() const { return all_.farthest; }
    /// Extrema around each block of kBlock² pixels, counted from the window's origin, that holds a pixel of `tile`:
    /// over at least the pixels within `reach` of any in the block. Row-major.
    std::vector<Range> around(const PixelWindow& tile, int reach) const;

  private:
    std::size_t index(int x, int y) const {
        const int cx = std::clamp(x - window_.x0, 0, window_.width - 1);
        const int cy = std::clamp(y - window_.y0, 0, window_.height - 1);
        return static_cast<std::size_t>(cy) * static_cast<std::size_t>(window_.width) + static_cast<std::size_t>(cx);
    }
    void find_fronts(int y);

    PixelWindow window_;
    std::vector<float> metres_, fronts_;
    std::vector<Range> blocks_;
    int block_columns_ = 0, block_rows_ = 0;
    Range all_{};
};

/// What of a depth plane stands up from the surfaces of mirages, around a tile.
class MirageGround {
  public:
    MirageGround() = default;
    /// reach: how far around the tile clear() will be asked for [px].
    MirageGround(const DepthPlane& depth, const PixelWindow& tile, int reach, std::span<const Mirage> mirages);

    bool is(int x, int y, double z) const {
        for (const Mirage& mirage : mirages_)
            if (mirage.on_ground(x, y, z)) return true;
        return false;
    }
    bool any() const { return !mirages_.empty(); }
    /// Whether pixel (x, y) sees no ground: a mirage bends its ray up before.
    bool mirrors(int x, int y) const {
        Mirage::PixelRay pixel;
        for (const Mirage& mirage : mirages_)
            if (mirage.ray(x, y, pixel) && std::isinf(pixel.end)) return true;
        return false;
    }
    /// Whether no object nearer than z, or at z, is in the pixels from (x0, y0) to (x1, y1) or their blocks.
    bool clear(int x0, int y0, int x1, int y1, double z) const;

  private:
    std::span<const Mirage> mirages_;
    PixelWindow window_;                                   ///< of the depth plane
    int column0_ = 0, row0_ = 0, columns_ = 0, rows_ = 0;  ///< blocks kept
    std::vector<float> nearest_;                           ///< object in each block
};

/// The meeting of one tile's rays.
class TileMeeting {
  public:
    /// tile: within depth.window(); reach: bound of |d| in pixels upon it. mirages: those that row()'s grids have.
    /// depth and mirages must outlive this.
    TileMeeting(const DepthPlane& depth, const PixelWindow& tile, DepthMeeting how, int reach,
                std::span<const Mirage> mirages = {});
    /// Sets the displacement of the tile's row y, tile.width interleaved (u, v).
    void row(GridRows& grids, int y, float* uv) const;

  private:
    Shift over_ground(GridRows& grids, int x, int y, const DepthPlane::Range& range) const;

    const DepthPlane& depth_;
    PixelWindow tile_;
    DepthMeeting how_;
    std::vector<DepthPlane::Range> ranges_;  ///< March only
    int range_columns_ = 0;
    MirageGround ground_;
};

/// Where a ray that has met the facet under pixel + met meets the surface through the pixels' centres: inverse depth
/// (orthographic: depth) linear between them, exact for planes, as no facet is. For pixels whose rays no mirage moves;
/// `met` itself where an edge is about, or the two lie more than a pixel apart.
Shift meet_smooth_surface(GridRows& grids, const DepthPlane& depth, bool perspective, int x, int y, Shift met);

}  // namespace eikonal
