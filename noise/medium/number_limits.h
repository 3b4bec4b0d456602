/// Limits of every number that a scene or an option states, so that squares and quotients of two of them stay within
/// double.
#pragma once

namespace eikonal {

inline constexpr double kLargestValue = 1e12;       ///< in magnitude
inline constexpr double kSmallestPositive = 1e-12;  ///< of what must be > 0

}  // namespace eikonal
