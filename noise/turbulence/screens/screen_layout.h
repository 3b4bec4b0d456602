/// Where the thin screens of a long path stand and what lattices they carry (PHYSICS.md#thin-screens, *added*).
///
/// The path 0 … far along the axis is cut into slabs, one screen each: L0 thick near the camera (thinner ones would not
/// be independent), and growing with distance once that is less than the part kSlabGrowth of their far end. So an
/// object anywhere on the path has enough screens before it, and a picture with depth no gaps. A slab's bend is spread
/// evenly over it, as if its air were alike from end to end: at depth z it has the lever
///     0 before the slab,   (z - near)²/(2δ) inside,   z - w_m behind it,                              *added*
/// which is the thin screen's own (z - w_m) wherever the object lies behind the slab, and C1 in z. Variance of the
/// displacement angle at D against ∫(1 - w/D)² dw = D/3, for any path (tests/screens_test.cpp):
///     D/L0         1        1.5      2        3         >= 4
///     error       -25 %    -10 %    -6.3 %   -3 %      -kSlabError at most (-3.2 % where far is a million L0)
/// (a path of one eddy is no path through independent slabs anyway). If far < 2 L0 a single slab is left.
///
/// Cell: the largest of l0/kCellsPerInnerScale, a quarter of the aperture's footprint, and one pixel there, which is
/// the most that a point per pixel can show; up to 15 % finer, by another factor on each screen. What lies beyond the
/// lattice's Nyquist is lost, and the spline adds its own error; of a point aperture's gradient, with large L0:
///     cell                       l0/2     l0/3     l0/4
///     variance lost              2.5 %    0.3 %    0.02 %
///     rms error of the spline    8.9 %    5.1 %    2.5 %
///
/// Period: the view's width there, but kFewestCells to kLargestSide cells a side (the paper's spectrum, all of it in
/// one lattice: at least 4 L0): an evolving screen of 384² takes some 2.5 ms of a core a frame and a view over
/// kilometres would need billions of cells. A wider view sees the fine pattern repeat, at another angular period on
/// each screen. Coarser lattices under the fine one (screen_bands) hold every lower wavenumber down to π/(4 L0), so
/// that no variance is lost to the period.
///
/// The loop T, unless given, is ten seconds or eight decorrelation times of the largest eddies, whichever is longer, up
/// to kLongestLoop, in whole frames. α = 0: frozen.
#pragma once

#include <cstdint>
#include <vector>

#include "noise/medium/media.h"
#include "noise/medium/shot_frame.h"
#include "noise/turbulence/screens/screen_band.h"

namespace eikonal {

/// Thickness of a slab as a part of its far end's distance, where that exceeds L0; more where kMostScreens must do.
inline constexpr double kSlabGrowth = 0.35;
inline constexpr int kMostScreens = 24;
inline constexpr double kSlabError = 0.021;
inline constexpr int kLargestSide = 384;
inline constexpr int kFewestCells = 64;
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
    double thickness = 0;   ///< δ [m]; the slab reaches from w - δ/2 to w + δ/2
    int nx = 0, ny = 0;     ///< fine lattice
    int nt = 1;             ///< time samples a loop
    double Lx = 0, Ly = 0;  ///< period of the fine lattice [m]
    double T = 0;           ///< loop [s]
    double aperture = 0;    ///< diameter of the beam's footprint here [m]: A (1 - w/D), or A for parallel rays
};

/// Lever [m] of a bend spread evenly over the slab near … far, at depth z, and its derivative.
struct SlabLever {
    double length, slope;
};
inline SlabLever slab_lever(double near, double far, double z) {
    if (z <= near) return {0, 0};
    if (z >= far) return {z - 0.5 * (near + far), 1};
    const double part = (z - near) / (far - near);
    return {0.5 * part * (z - near), part};
}

/// Screens for a medium and a view, nearest first. spec.lattice and spec.period override: lattice[2] is the number of
/// screens, [0], [1], [3] are nx, ny, nt; period [0], [1], [3] Lx, Ly, T. UserError when they are out of range or slabs
/// would be thinner than L0.
std::vector<ScreenGeometry> layout_screens(const TurbulenceSpec& spec, const ShotView& view);

/// The lattices of one screen, finest first. The paper's spectrum has a lowest wavenumber (in cycles per fine x period)
/// and is all in the first.
std::vector<BandGeometry> screen_bands(const TurbulenceSpec& spec, const ScreenGeometry& screen);

/// Bytes for the field and one snapshot of it while it is made; saturates at 2^64 - 1.
std::uint64_t screens_bytes(const TurbulenceSpec& spec, const std::vector<ScreenGeometry>& screens);

/// UserError when they need more than memory_limit [bytes]; allocates nothing to speak of.
void check_screens(const TurbulenceSpec& spec, const std::vector<ScreenGeometry>& screens, std::uint64_t memory_limit);

}  // namespace eikonal
