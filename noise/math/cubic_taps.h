/// Weights of the cubic B-spline on a periodic lattice, as used by the periodic splines of this folder and by the
/// eddies of noise/blobs.
///
/// At offset t in [0, 1] of a cell, with s = 1 - t, the coefficients at -1, 0, 1 and 2 have the weights
///
///     weight     s³/6,   (4 + t²(3t - 6))/6,   (4 + s²(3s - 6))/6,   t³/6
///     slope     -s²/2,    t(3t - 4)/2,         -s(3s - 4)/2,         t²/2         first derivative [1/cell]
///     curvature  s,       3t - 2,               3s - 2,              t            second derivative [1/cell²]
///
/// The weights are exact but for rounding. No function fails. Scalar is float or double.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace eikonal {

using Float4 = float __attribute__((vector_size(16)));

/// The calling convention of this type differs between the versions that EIKONAL_CLONES compiles
/// (noise/base/instruction_sets.h). A function that takes or returns it by value must always be inlined.
using Double4 = double __attribute__((vector_size(32)));

template <class Scalar>
using Four = std::conditional_t<std::is_same_v<Scalar, float>, Float4, Double4>;

template <class Scalar>
[[gnu::always_inline]] inline Four<Scalar> cubic_slope(Scalar t) {
    const Scalar s = 1 - t;
    const Scalar half = Scalar(1) / 2;
    return Four<Scalar>{-half * s * s, half * t * (3 * t - 4), -half * s * (3 * s - 4), half * t * t};
}

template <class Scalar>
struct CubicTaps {
    Four<Scalar> weight, slope, curvature;

    explicit CubicTaps(Scalar t) : slope(cubic_slope(t)) {
        const Scalar s = 1 - t;
        const Scalar w0 = s * s * s, w1 = 4 + t * t * (3 * t - 6), w2 = 4 + s * s * (3 * s - 6), w3 = t * t * t;
        // A division and a product with 1/6 differ in the last bit. Both are kept, because pictures depend on each.
        if constexpr (std::is_same_v<Scalar, float>) {
            constexpr float sixth = 1.0F / 6;
            weight = Float4{w0 * sixth, w1 * sixth, w2 * sixth, w3 * sixth};
        } else {
            weight = Double4{w0, w1, w2, w3} / 6;
        }
        curvature = Four<Scalar>{s, 3 * t - 2, 3 * s - 2, t};
    }
};

/// The taps of PeriodicSpline2. They are CubicTaps<float>, but for the middle weights, which are factored as
/// (4 - 3t²(2 - t))/6 and (4 - 3s²(2 - s))/6. The two forms differ in the last bit. Both are kept, because pictures
/// depend on each.
struct FactoredCubicTaps {
    Float4 weight, slope;

    explicit FactoredCubicTaps(float t) : slope(cubic_slope(t)) {
        constexpr float sixth = 1.0F / 6;
        const float s = 1 - t, t2 = t * t, s2 = s * s;
        weight =
            Float4{sixth * (s2 * s), sixth * (4 - 3 * t2 * (2 - t)), sixth * (4 - 3 * s2 * (2 - s)), sixth * (t2 * t)};
    }
};

/// The taps at a point of a periodic lattice.
template <class Scalar>
struct PeriodicTaps {
    std::size_t first;  ///< of the four coefficients, in an array that begins with the coefficient of sample -1
    CubicTaps<Scalar> taps;
};

/// x: position [periods], any finite value. n: cells in a period, >= 1.
template <class Scalar>
[[gnu::always_inline]] inline PeriodicTaps<Scalar> periodic_taps(double x, int n) {
    const double cells = (x - std::floor(x)) * n;
    const int i = std::min(static_cast<int>(cells), n - 1);
    return {static_cast<std::size_t>(i), CubicTaps<Scalar>(static_cast<Scalar>(cells - i))};
}

/// Reads four stored coefficients.
[[gnu::always_inline]] inline Float4 load_float4(const float* p) {
    Float4 v;
    std::memcpy(&v, p, sizeof v);
    return v;
}
[[gnu::always_inline]] inline Double4 load_double4(const float* p) {
    return __builtin_convertvector(load_float4(p), Double4);
}

/// The sum of four numbers, in a fixed order.
[[gnu::always_inline]] inline float sum4(Float4 v) {
    return (v[0] + v[2]) + (v[1] + v[3]);
}
[[gnu::always_inline]] inline double sum4(Double4 v) {
    return (v[0] + v[2]) + (v[1] + v[3]);
}

/// The product of four coefficients and their weights, summed.
[[gnu::always_inline]] inline float dot4(Float4 a, Float4 b) {
    return sum4(a * b);
}
[[gnu::always_inline]] inline double dot4(Double4 a, Double4 b) {
    return sum4(a * b);
}

}  // namespace eikonal
