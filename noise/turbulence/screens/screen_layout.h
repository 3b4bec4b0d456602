/// Where the thin screens of a long path stand, and what lattices they carry (PHYSICS.md#thin-screens, *added*).
///
/// Slabs. The path 0 … far along the axis is cut into slabs, one screen each. A slab is L0 thick near the camera, since
/// thinner slabs would not be independent. Farther on it is the part kSlabGrowth of its far end's distance, where that
/// is more than L0. So an object anywhere on the path has enough screens before it, and a picture with depth has no
/// gaps.
///
/// A slab's bend is spread evenly over it. At depth z the lever of the bend is
///     0 before the slab,   (z - near)²/(2δ) inside,   z - w_m behind it                                *added*
/// It equals the lever (z - w_m) of the thin screen for every object behind the slab. It and its first derivative are
/// continuous in z. Error of the variance of the displacement angle at D, against ∫(1 - w/D)² dw = D/3, for any path
/// (tests/noise/turbulence/screen_layout_test.cpp):
///     D/L0         1        1.5      2        3         >= 4
///     error       -25 %    -10 %    -6.3 %   -3 %      -kSlabError at most (-3.2 % where far is a million L0)
/// If far < 2 L0, a single slab is left. (A path through one eddy is not a path through independent slabs anyway.)
///
/// Cell. The largest of three: l0/kCellsPerInnerScale, a quarter of the aperture's footprint, and one pixel at that
/// distance, which is all that one point for each pixel can show. Each screen is finer by its own factor, up to 15 %.
/// What lies beyond the lattice's Nyquist is lost, and the spline adds its own error. Of the gradient of a point
/// aperture, with a large L0:
///     cell                       l0/2     l0/3     l0/4
///     variance lost              2.5 %    0.3 %    0.02 %
///     rms error of the spline    8.9 %    5.1 %    2.5 %
///
/// Period. The view's width at that distance, but kFewestCells to kLargestSide cells a side. (The paper's spectrum is
/// held by one lattice, of at least 4 L0.) An evolving screen of 384² takes some 2.5 ms of a core a frame, and a view
/// over kilometres would need billions of cells. A wider view sees the fine pattern repeat, at another angular period
/// on each screen. Coarser lattices under the fine one (screen_bands) hold every lower wavenumber down to π/(4 L0), so
/// no variance is lost to the period.
///
/// Loop. T is, unless given, ten seconds or eight decorrelation times of the largest eddies, whichever is longer, up to
/// kLongestLoop, in whole frames. α = 0 is frozen.
#pragma once

#include <cstdint>
#include <vector>

#include "noise/medium/shot_frame.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "noise/turbulence/screens/screen_band.h"

namespace eikonal {

/// Thickness of a slab as a part of its far end's distance, where that exceeds L0. It is more where kMostScreens would
/// not suffice.
inline constexpr double kSlabGrowth = 0.35;
inline constexpr int kMostScreens = 24;
inline constexpr double kSlabError = 0.021;
inline constexpr int kLargestSide = 384;
inline constexpr int kFewestCells = 64;
inline constexpr double kCellsPerInnerScale = 3;
inline constexpr double kLongestLoop = 600;
/// Each coarser lattice has this many times the period of the finer one. It holds the modes within the finer one's cell
/// at k = 0. Since the number is odd, the lattices divide the k plane exactly.
inline constexpr int kCoarsening = 9;
/// Samples a side of the coarser lattices. Their shortest wave has eight samples.
inline constexpr int kCoarseSide = 32;

/// One thin screen. Its lateral coordinates have their origin on the axis.
struct ScreenGeometry {
    double w = 0;           ///< axial distance of its plane from the shot's origin [m]
    double thickness = 0;   ///< δ [m]; the slab reaches from w - δ/2 to w + δ/2
    int nx = 0, ny = 0;     ///< fine lattice
    int nt = 1;             ///< time samples a loop
    double Lx = 0, Ly = 0;  ///< period of the fine lattice [m]
    double T = 0;           ///< loop [s]
    double aperture = 0;    ///< diameter of the beam's footprint at w [m]: A (1 - w/D), or A for parallel rays
};

/// The lever [m] at depth z of a bend that is spread evenly over the slab near … far, and its derivative.
struct SlabLever {
    double length, slope;
};
inline SlabLever slab_lever(double near, double far, double z) {
    if (z <= near) return {0, 0};
    if (z >= far) return {z - 0.5 * (near + far), 1};
    const double part = (z - near) / (far - near);
    return {0.5 * part * (z - near), part};
}

/// Screens for a medium and a view, nearest first. spec.lattice and spec.period override the rules above. lattice[2] is
/// the number of screens, and [0], [1], [3] are nx, ny, nt. period [0], [1], [3] are Lx, Ly, T. UserError if they are
/// out of range, or if slabs would be thinner than L0.
std::vector<ScreenGeometry> layout_screens(const TurbulenceSpec& spec, const ShotView& view);

/// The lattices of one screen, finest first. The first holds all of the paper's spectrum, whose lowest wavenumber
/// counts cycles in the fine period along x.
std::vector<BandGeometry> screen_bands(const TurbulenceSpec& spec, const ScreenGeometry& screen);

/// Bytes for the field and one instant of it while it is made. Saturates at 2^64 - 1.
std::uint64_t screens_bytes(const TurbulenceSpec& spec, const std::vector<ScreenGeometry>& screens);

/// UserError if the screens need more than memory_limit [bytes].
void check_screens(const TurbulenceSpec& spec, const std::vector<ScreenGeometry>& screens, std::uint64_t memory_limit);

}  // namespace eikonal
