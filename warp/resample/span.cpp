#include "warp/resample/span.h"

#include <algorithm>
#include <bit>

#include "noise/base/instruction_sets.h"

namespace eikonal::resampling {
namespace {

#define EIKONAL_INLINE inline __attribute__((always_inline))

EIKONAL_INLINE void split_all(const float* d, int origin, int* whole, float* fraction) {
    for (int i = 0; i < span_length; ++i) {
        float t = d[i];
        whole[i] = origin + split(t);
        fraction[i] = t;
    }
}

EIKONAL_INLINE void bilinear_weights(const float* t, float (*w)[span_length]) {
    for (int i = 0; i < span_length; ++i) {
        w[0][i] = 1 - t[i];
        w[1][i] = t[i];
    }
}

/// Catmull-Rom: the cubic convolution kernel with a = -1/2.
EIKONAL_INLINE void cubic_weights(const float* fraction, float (*w)[span_length]) {
    for (int i = 0; i < span_length; ++i) {
        const float t = fraction[i];
        w[0][i] = ((-0.5f * t + 1.0f) * t - 0.5f) * t;
        w[1][i] = (1.5f * t - 2.5f) * t * t + 1.0f;
        w[2][i] = ((-1.5f * t + 2.0f) * t + 0.5f) * t;
        w[3][i] = (0.5f * t - 0.5f) * t * t;
    }
}

/// The normalised Lanczos3 weights are smooth in t and mirror each other, w[5-k](t) = w[k](1-t). With s = t - 1/2,
/// w[k] = even(s^2) + s odd(s^2) and w[5-k] = even - s odd, where the polynomials of degree 4 interpolate at 64
/// Chebyshev nodes in s^2. Error: lanczos3_weight_error.
constexpr int lanczos_degree = 4;
constexpr float lanczos_even[3][lanczos_degree + 1] = {
    {0.0244565457f, -0.0881257355f, -0.0568575114f, 0.0780691206f, -0.0233906079f},
    {-0.135869518f, 0.57076174f, -0.114024758f, 0.0284151901f, -0.0354274027f},
    {0.611413002f, -0.482636005f, 0.17088227f, -0.106484309f, 0.0588180088f}};
constexpr float lanczos_odd[3][lanczos_degree + 1] = {
    {-0.0639243722f, 0.309988528f, -0.24173525f, 0.111283198f, -0.0520105846f},
    {0.181159258f, -0.841509581f, 0.525349677f, -0.263621569f, 0.128772765f},
    {-1.33667123f, 1.5452776f, -0.909499347f, 0.523222089f, -0.250885844f}};

EIKONAL_INLINE void lanczos3_weights(const float* t, float (*w)[span_length]) {
    for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < span_length; ++i) {
            const float s = t[i] - 0.5f, s2 = s * s;
            float even = lanczos_even[k][lanczos_degree], odd = lanczos_odd[k][lanczos_degree];
            for (int j = lanczos_degree - 1; j >= 0; --j) {
                even = even * s2 + lanczos_even[k][j];
                odd = odd * s2 + lanczos_odd[k][j];
            }
            w[k][i] = even + s * odd;
            w[5 - k][i] = even - s * odd;
        }
    }
}

}  // namespace

EIKONAL_CLONES void prepare(const float* d, int n, int x, int y, float scale, Filter filter, const Source& source,
                            Span& span) {
    // The loops have constant length, so a short span repeats its last displacement.
    alignas(64) float both[2 * span_length], u[span_length], v[span_length];
    const float* from = d;
    if (n < span_length) {
        for (int i = 0; i < 2 * span_length; ++i) both[i] = d[i < 2 * n ? i : 2 * n - 2 + i % 2];
        from = both;
    }
    // The bits of |d| are ordered as |d| is, and NaN is the largest.
    std::uint32_t largest = 0;
    for (int i = 0; i < 2 * span_length; ++i) {
        both[i] = from[i] * scale;
        const std::uint32_t magnitude = std::bit_cast<std::uint32_t>(both[i]) & 0x7fffffffu;
        largest = largest > magnitude ? largest : magnitude;
    }
    if (largest > std::bit_cast<std::uint32_t>(max_displacement))
        for (int i = 0; i < span_length; ++i) sanitise(both[2 * i], both[2 * i + 1]);
    for (int i = 0; i < span_length; ++i) {
        u[i] = both[2 * i];
        v[i] = both[2 * i + 1];
    }
    split_all(u, x, span.x, span.tx);
    split_all(v, y, span.y, span.ty);
    int left = source.width, right = -1, top = source.height, bottom = -1, aligned = 0;
    for (int i = 0; i < span_length; ++i) {
        const int sx = span.x[i] + i, sy = span.y[i];
        span.x[i] = sx;
        left = left < sx ? left : sx;
        right = right > sx ? right : sx;
        top = top < sy ? top : sy;
        bottom = bottom > sy ? bottom : sy;
        aligned |= (span.tx[i] == 0) | (span.ty[i] == 0);
    }
    const int taps = taps_of(filter), before = taps / 2 - 1, after = taps / 2;
    span.n = n;
    span.fractional = !aligned;
    span.interior = left >= before && right < source.width - after && top >= before && bottom < source.height - after;

    switch (taps) {
        case 2:
            bilinear_weights(span.tx, span.wx);
            bilinear_weights(span.ty, span.wy);
            break;
        case 4:
            cubic_weights(span.tx, span.wx);
            cubic_weights(span.ty, span.wy);
            break;
        default:
            lanczos3_weights(span.tx, span.wx);
            lanczos3_weights(span.ty, span.wy);
            break;
    }
}

}  // namespace eikonal::resampling
