/// The ground of mirages in a depth buffer: which pixels show the surfaces themselves, and which show objects that
/// stand up from them.
///
/// A ray that a mirage moves skims over ground whose facets lie metres apart, and these would block it. Such a ray must
/// therefore look past pixels of ground (Mirage::on_ground) and end on the surface itself.
#pragma once

#include <span>
#include <vector>

#include "warp/displace/depth/depth_plane.h"
#include "warp/displace/media/surface/mirage.h"

namespace eikonal {

class MirageGround {
  public:
    /// radius: how far beyond the tile is_clear() will be asked for [px]. depth and mirages must outlive this.
    MirageGround(const DepthPlane& depth, const PixelWindow& tile, int radius, std::span<const Mirage> mirages);

    /// Whether depth z at pixel (x, y) is ground.
    bool contains(int x, int y, double z) const {
        for (const Mirage& mirage : mirages_)
            if (mirage.on_ground(x, y, z)) return true;
        return false;
    }
    /// Whether a mirage bends the ray of pixel (x, y) up before the ray reaches the ground, so that the pixel shows
    /// other things.
    bool is_mirror(int x, int y) const;
    /// Whether the blocks of the depth plane that have pixels from (x0, y0) to (x1, y1) are free of objects at depth z
    /// or nearer.
    bool is_clear(int x0, int y0, int x1, int y1, double z) const;

  private:
    const DepthPlane& depth_;
    std::span<const Mirage> mirages_;
    int column0_, row0_, columns_, rows_;  ///< the blocks around the tile
    std::vector<float> nearest_object_;    ///< depth of the nearest object in each of them [m]
};

}  // namespace eikonal
