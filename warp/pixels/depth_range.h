/// The depths that the warp and the files it reads treat in a special way.
#pragma once

namespace eikonal {

/// The least axial depth [m]. Nearer pixels count as this.
inline constexpr float kNearestDepth = 1e-6f;
/// Pixels of this depth or more show background [m].
inline constexpr float kInfiniteDepth = 1e9f;
/// Axial depth of the background, unless something states it [m].
inline constexpr double kDefaultFar = 1000;

}  // namespace eikonal
