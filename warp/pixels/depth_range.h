/// Depths that mean something in the warp and in the files it reads: the nearest, the infinite, the default background.
#pragma once

namespace eikonal {

/// Axial depth that nearer pixels count as [m].
inline constexpr float kNearestDepth = 1e-6f;
/// Depth from which on a pixel shows background [m].
inline constexpr float kInfiniteDepth = 1e9f;
/// Axial depth of the background where nothing states it [m].
inline constexpr double kDefaultFar = 1000;

}  // namespace eikonal
