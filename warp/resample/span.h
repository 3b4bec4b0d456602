/// A span: up to 64 neighbouring output pixels of one row. It holds their source positions, split into integer and
/// fraction, and the weights of a separable filter at those fractions. Private to the resampler.
///
/// The span is the unit of work. It is small enough for the first cache. It is long enough to vectorise over, and to
/// decide once whether any sample lies outside the source.
#pragma once

#include "warp/resample/pixel.h"

namespace eikonal::resampling {

inline constexpr int span_length = 64;
inline constexpr int max_taps = 6;

/// The samples of a filter along one axis. They stand at -(taps/2 - 1) ... taps/2 from the integer position. (Area:
/// where the map is rigid.)
constexpr int taps_of(Filter filter) {
    return filter == Filter::Cubic ? 4 : filter == Filter::Lanczos3 ? 6 : 2;
}

/// A structure of arrays. Elements from n on are undefined.
struct alignas(64) Span {
    int n;
    bool interior;                           ///< every sample of every pixel lies inside the source
    bool fractional;                         ///< no pixel has an integer displacement in x or y
    int x[span_length], y[span_length];      ///< integer part of the position, from the source's corner
    float tx[span_length], ty[span_length];  ///< fraction, 0 <= t < 1
    float wx[max_taps][span_length];         ///< weights of the samples, left to right
    float wy[max_taps][span_length];         ///< top to bottom
};

/// Sets a displacement to zero if a component is not finite, else clamps it to +-max_displacement. It and `split` are
/// free of branches, so that loops over a span vectorise.
inline void sanitise(float& u, float& v) {
    const bool finite = (u - u) + (v - v) == 0;  // inf - inf is NaN
    const float a = finite ? u : 0, b = finite ? v : 0;
    const float a_low = a < -max_displacement ? -max_displacement : a;
    const float b_low = b < -max_displacement ? -max_displacement : b;
    u = a_low > max_displacement ? max_displacement : a_low;
    v = b_low > max_displacement ? max_displacement : b_low;
}

/// Returns the integer part of a sanitised displacement and replaces d by its fraction. Exact, unless d is negative and
/// so small that 1 - |d| rounds to 1. Such a d counts as an integer.
inline int split(float& d) {
    const int toward_zero = static_cast<int>(d);
    const int below = toward_zero - (static_cast<float>(toward_zero) > d ? 1 : 0);
    const float t = d - static_cast<float>(below);
    d = t < 1 ? t : 0.0f;
    return below + (t < 1 ? 0 : 1);
}

/// Fills the span for n pixels from (x, y) on, which count from the source's corner. Their displacements are d times
/// `scale`, as (u, v).
void prepare(const float* d, int n, int x, int y, float scale, Filter filter, const Source& source, Span& span);

}  // namespace eikonal::resampling
