/// Limits of every number that a scene or an option states. Within them the squares and quotients of two numbers do not
/// overflow a double.
#pragma once

namespace eikonal {

inline constexpr double kLargestValue = 1e12;       ///< largest magnitude
inline constexpr double kSmallestPositive = 1e-12;  ///< smallest value of a number that must be > 0

}  // namespace eikonal
