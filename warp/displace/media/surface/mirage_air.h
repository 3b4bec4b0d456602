/// What the other media of a scene do to the rays that a mirage bends: shimmer and plumes over a hot road, seen in it
/// as in a mirror, too. *added*
///
/// Bands hold what media do to straight rays, by pixel and depth. A ray that a surface bends passes, at axial depth w,
/// where the straight ray of the pixel p + d(p, w) does, d the mirage's displacement: the force that it meets there is
/// how X and S of the grids change with depth at *that* pixel. What such a kick κ does further on is the response of
/// the bent ray to its start: with A = ∂h/∂H and B = ∂h/∂w of its height (mirage.h) a kick across the plane at depth w
/// is the same as a start that is −B(w)κ higher and A(w)κ steeper, since A B' − A' B = 1. Hence, at depth z,
///     x1⊥(z) = A(z) δH(z) + B(z) δw(z),   δH = −∫₀ᶻ B dκ,   δw = ∫₀ᶻ A dκ
/// (without a surface A = 1, B = z: Eq. 7). Beyond a turning point A and B change their signs, and the image shivers
/// the other way round. Along the plane nothing changes but the place.
///
/// Up to its anchor, where it turns or meets the plane, all that has happened to a ray is taken as another start, and
/// bent from there exactly: so the mirror's line itself shimmers. From there on to first order in κ.
///
/// The response is taken over a quarter of a pixel to either side; every row has its own nodes, as far apart as the
/// grids' along the row, unless the plane is seen tilted.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "warp/displace/media/surface/mirage.h"

namespace eikonal {

struct DisplacementGrid;

/// Axial depths at which a ray is known, so many an octave from the nearest object to the farthest; at most so many.
inline constexpr int kResponsesAnOctave = 4, kMostResponses = 128;

/// One tile's rays of one mirage.
class MirageAir {
  public:
    MirageAir() = default;
    /// grids: filled and scaled, over `cover`, which holds `pixels`; beyond it the air is that of its border. mirage
    /// must outlive this. 0 < nearest <= farthest [m].
    MirageAir(const std::vector<DisplacementGrid>& grids, const Mirage& mirage, const PixelWindow& pixels,
              const PixelWindow& cover, double nearest, double farthest);

    /// Whether row y has pixels that the mirage moves.
    bool touches(int y) const;
    /// Whether this is the air of that mirage.
    bool belongs_to(const Mirage& mirage) const { return mirage_ == &mirage; }

    /// One pixel: another start of its ray, and what follows.
    struct Pixel {
        Launch launch;
        std::vector<std::array<float, 2>> bend;  ///< across and along the plane at each depth [m]
    };
    void pixel(int x, int y, Pixel& out) const;
    /// Bend across and along the plane at axial depth z [m].
    std::array<double, 2> bend(const Pixel& pixel, double z) const;

  private:
    struct Sheet;
    struct Response;
    void respond(const std::vector<Sheet>& sheets, int x, int y, Response& out) const;
    Launch trace(const std::vector<Sheet>& sheets, const Response& response, int x, int y,
                 std::span<std::array<float, 2>> bend) const;

    const Mirage* mirage_ = nullptr;
    PixelWindow cover_{};
    int spacing_ = 1, column0_ = 0, columns_ = 0, row0_ = 0;
    std::vector<int> rows_;                    ///< index of each row's first node, or -1
    std::vector<Launch> launches_;             ///< of the nodes of rows that are touched
    std::vector<std::array<float, 2>> bends_;  ///< the same, at each depth
    std::vector<double> depths_;               ///< ascending
    std::vector<std::array<float, 6>> weights_;
};

}  // namespace eikonal
