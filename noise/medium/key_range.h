/// The values that a number of a scene may have. They are finite and within the limits of noise/medium/number_limits.h,
/// or within narrower ones.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "noise/medium/number_limits.h"

namespace eikonal {

/// The values allowed for a number, both ends included.
struct Range {
    double lo = -kLargestValue, hi = kLargestValue;

    bool contains(double v) const { return v >= lo && v <= hi; }
    /// The words of a message about a value outside: "must be > 0", "must be >= 0 and <= 1", …
    std::string text(double v) const;
};

inline Range any() {
    return {};
}
inline Range at_least(double lo) {
    return {lo, kLargestValue};
}
inline Range positive() {
    return {kSmallestPositive, kLargestValue};
}
inline Range between(double lo, double hi) {
    return {lo, hi};
}
/// Any whole number that a scene file can state, from 0 to 2^63 - 1.
inline Range any_seed() {
    return {0, 0x1p63};
}

/// Ranges of the numbers of an array. The last one holds for all numbers that follow. Never empty.
using Ranges = std::vector<Range>;

/// The range of number i.
const Range& range_of(const Ranges& ranges, std::size_t i);

}  // namespace eikonal
