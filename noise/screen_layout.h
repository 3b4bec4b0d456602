/// Where the thin screens of a long path stand and what lattices they carry (PHYSICS 6, *added*).
///
/// The path 0 … far along the axis is cut into M equal slabs of thickness δ >= L0, one screen in the middle of each.
/// The midpoint rule makes the variance of the displacement angle, ∫(1 - w/D)² dw, too small by the factor 1 - 1/(4M²):
/// 0.4 % for the kScreens = 8 taken where far >= 8 L0, 25 % for the single screen that is left when far < 2 L0 (δ < L0
/// only there, when M = 1).
///
/// Cell: the largest of l0/kCellsPerInnerScale, a quarter of the aperture's footprint, and one pixel there, which is
/// the most that a point per pixel can show; up to 15 % finer, by another factor on each screen. What lies beyond the
/// lattice's Nyquist is lost, and the spline adds its own error; of a point aperture's gradient, with large L0:
///     cell                       l0/2     l0/3     l0/4
///     variance lost              2.5 %    0.3 %    0.02 %
///     rms error of the spline    8.9 %    5.1 %    2.5 %
///
/// Period: 4 L0 or the view's width, whichever is larger, but at most kLargestSide cells a side: eight evolving
/// screens of 384² take some 20 ms of a core a frame and a view over kilometres would need billions of cells. A wider
/// view sees the fine pattern repeat, at another angular period on each screen. Coarser lattices under the fine one
/// (screen_bands) hold every lower wavenumber down to π/(4 L0), so that no variance is lost to the period.
///
/// The loop T, unless given, is ten seconds or eight decorrelation times of the largest eddies, whichever is longer, up
/// to kLongestLoop, in whole frames. α = 0: frozen.
#pragma once

#include <cstdint>
#include <vector>

#include "noise/media.h"
#include "noise/screen_band.h"

namespace eikonal {

inline constexpr int kScreens = 8;
inline constexpr int kLargestSide = 384;
inline constexpr double kCellsPerInnerScale = 3;
inline constexpr double kLongestLoop = 600;
/// Each coarser lattice has this many times (odd) the period of the finer, and holds the modes inside its DC cell: an
/// exact partition of the k plane.
inline constexpr int kCoarsening = 9;
/// Samples a side of the coarser lattices; eight for the shortest wave.
inline constexpr int kCoarseSide = 32;

/// One thin screen. Its lateral coordinates have their origin on the axis.
struct ScreenGeometry {
    double w = 0;           ///< axial distance of its plane from the shot's origin [m]
    double thickness = 0;   ///< δ [m]
    int nx = 0, ny = 0;     ///< fine lattice
    int nt = 1;             ///< time samples a loop
    double Lx = 0, Ly = 0;  ///< period of the fine lattice [m]
    double T = 0;           ///< loop [s]
    double aperture = 0;    ///< diameter of the beam's footprint here [m]: A (1 - w/D), or A for parallel rays
};

/// What the screens must serve.
struct ScreenView {
    bool perspective = true;
    double far = 100;                            ///< path length D along the axis [m] > 0
    double half_width = 0.3, half_height = 0.2;  ///< largest slope (perspective), or metres (orthographic)
    double pixel = 1e-3;                         ///< slope of a pixel 1/f_px (perspective), or metres a pixel > 0
    double aperture = 0;                         ///< A [m] >= 0
    double fps = 24;                             ///< > 0
};

/// Screens for a medium and a view, nearest first. spec.lattice and spec.period override: lattice[2] is the number of
/// screens, [0], [1], [3] are nx, ny, nt; period [0], [1], [3] Lx, Ly, T. UserError when they are out of range or slabs
/// would be thinner than L0.
std::vector<ScreenGeometry> layout_screens(const TurbulenceSpec& spec, const ScreenView& view);

/// The lattices of one screen, finest first. The paper's spectrum has a lowest wavenumber (in cycles per fine x period)
/// and is all in the first.
std::vector<BandGeometry> screen_bands(const TurbulenceSpec& spec, const ScreenGeometry& screen);

/// Bytes for the field and one snapshot of it while it is made; saturates at 2^64 - 1.
std::uint64_t screens_bytes(const TurbulenceSpec& spec, const std::vector<ScreenGeometry>& screens);

/// UserError when they need more than memory_limit [bytes]; allocates nothing to speak of.
void check_screens(const TurbulenceSpec& spec, const std::vector<ScreenGeometry>& screens, std::uint64_t memory_limit);

}  // namespace eikonal
