/// A row of pixels of one mirage, with the air about it or without.
#pragma once

#include <limits>

#include "warp/displace/media/surface/mirage.h"
#include "warp/displace/media/surface/mirage_air.h"

namespace eikonal {

class MirageRow {
  public:
    /// mirage and air must outlive this. gain multiplies d. air: of that mirage and over this row; null if there is
    /// none, or the grids add to d by themselves.
    void start(const Mirage& mirage, int y, double gain = 1, const MirageAir* air = nullptr);
    /// Displacement of pixel column x for an object at axial depth z > 0; with air, by all that bends the ray.
    Shift at(int x, double z);
    /// Adds that of columns [x0, x0 + n) at one depth into interleaved (u, v).
    void add_constant_depth(int x0, int n, double z, float* uv);
    /// Whether pixel x moves at all; and where its ray meets the plane [m], infinite if never or if it does not move.
    bool moves(int x) { return ready(x); }
    double end(int x) { return ready(x) ? pixel_.end : std::numeric_limits<double>::infinity(); }
    /// Whether at(x, z) is all of the displacement.
    bool carries_air(int x) { return air_ != nullptr && ready(x); }

  private:
    bool ready(int x) {
        if (x != x_ || !known_) look(x);
        return moves_;
    }
    void look(int x);

    const Mirage* mirage_ = nullptr;
    const MirageAir* air_ = nullptr;
    int y_ = 0, x_ = 0;
    bool known_ = false, moves_ = false;
    float gain_ = 1;
    Mirage::PixelRay pixel_;
    Mirage::Axes axes_;
    MirageAir::Pixel bent_;
};

}  // namespace eikonal
