/// What the other media of a scene do to the rays that a mirage bends: shimmer and plumes over a hot road, which also
/// show in its mirror. *added*
///
/// Displacement grids hold what media do to straight rays, by pixel and depth. A ray that a surface bends is, at axial
/// depth w, where the straight ray of pixel p + d(p, w) is, d being the mirage's displacement. The force that the bent
/// ray meets there is given by the change with depth of X and S of the grids at *that* pixel.
///
/// A kick is a sudden change κ of a ray's slope. What it does farther on follows from how the bent ray depends on its
/// start: let A = ∂h/∂H and B = ∂h/∂w for the ray's height h (Mirage::response). A kick κ across the plane at depth w
/// has the effect of a start that is B(w)κ lower and A(w)κ steeper, because A B' − A' B = 1. At depth z, therefore,
///     x1⊥(z) = A(z) δH(z) + B(z) δw(z),   δH = −∫₀ᶻ B dκ,   δw = ∫₀ᶻ A dκ.
/// Without a surface A = 1 and B = z, and this is Eq. 7. Beyond a turning point A and B change their signs, so the
/// image shivers the other way round. Along the plane, only the place where the force is read differs from that of a
/// straight ray.
///
/// The anchor of a ray is where it turns or meets the plane. All kicks up to the anchor are taken together as another
/// start of the ray, which is bent from there exactly, so that the mirror's edge shimmers, too. Kicks beyond the anchor
/// act to first order in κ.
///
/// A and B are differences over a quarter of a pixel to either side. Every row of pixels has nodes of its own. Along
/// the row, nodes are as far apart as those of the grids, or closer where the plane is seen tilted.
/// Theory: PHYSICS.md#mirage-air.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "warp/displace/grid/lagrange.h"
#include "warp/displace/media/surface/mirage.h"

namespace eikonal {

struct DisplacementGrid;

/// The axial depths at which A, B and bends are known: so many an octave from the nearest depth to the farthest, and so
/// many at most.
inline constexpr int kResponsesAnOctave = 4, kMostResponses = 128;

/// One tile's rays of one mirage.
class MirageAir {
  public:
    MirageAir() = default;
    /// pixels: those that will be asked for. grids: filled and scaled, over the window `cover`, which contains
    /// `pixels`. Beyond `cover` the air of its border continues. mirage must outlive this. 0 < nearest <= farthest:
    /// axial depths [m].
    MirageAir(const std::vector<DisplacementGrid>& grids, const Mirage& mirage, const PixelWindow& pixels,
              const PixelWindow& cover, double nearest, double farthest);

    /// Whether row y has pixels that the mirage moves.
    bool touches(int y) const;
    /// Whether this is the air of that mirage.
    bool belongs_to(const Mirage& mirage) const { return mirage_ == &mirage; }

    /// What the air does to the ray of one pixel.
    struct Pixel {
        Launch launch;                           ///< for the kicks up to the anchor
        std::vector<std::array<float, 2>> bend;  ///< for those beyond: across and along the plane, at each depth [m]
    };
    /// For a row that the mirage touches().
    void pixel(int x, int y, Pixel& out) const;
    /// A pixel's bend across and along the plane at axial depth z [m].
    std::array<double, 2> bend(const Pixel& pixel, double z) const;

  private:
    struct GridKicks;
    struct Response;
    struct StartChanges;
    void find_response(const std::vector<GridKicks>& grids, int x, int y, Response& out) const;
    StartChanges start_changes(const std::vector<GridKicks>& grids, const Response& response, int x, int y) const;
    Launch bend_ray(const StartChanges& changes, const Response& response, std::span<std::array<float, 2>> bend) const;

    const Mirage* mirage_ = nullptr;
    PixelWindow cover_{};
    int spacing_ = 1, column0_ = 0, columns_ = 0, row0_ = 0;
    std::vector<int> rows_;         ///< index of each row's first node; -1 if the mirage moves none of its pixels
    std::vector<Launch> launches_;  ///< Pixel::launch of each node
    std::vector<std::array<float, 2>> bends_;  ///< Pixel::bend of each node: [node][depth]
    std::vector<double> depths_;               ///< ascending [m]
    std::vector<LagrangeWeights> weights_;     ///< at each pixel between two nodes
};

}  // namespace eikonal
