/// The perturbation integrals of noise/blobs/blob_kernel.h in single precision, dimensionless and free of branches. The
/// warp needs them at every pixel that a blob covers. With a = -w_j/σ <= c = (u - w_j)/σ,
///
///     i1 = ∫_a^c (c - s) e^{-s²} ds = I1/σ²        e = ∫_a^c e^{-s²} ds = (dI1/du)/σ
///     j2 = ∫_a^c (c - s) s e^{-s²} ds = J2/σ³      g = ∫_a^c s e^{-s²} ds = (dJ2/du)/σ²
///
/// A pixel at distance u moves by f_px x1⊥/u with x1⊥ = -2 n_j gaussian_f(|b|/σ) i1 b (physical convention,
/// PHYSICS.md#blobs, PHYSICS.md#first-order). The functions use only + - * /, masks and integer operations in a fixed
/// order. Loops over them vectorise under EIKONAL_CLONES (noise/base/instruction_sets.h) without a change of bits.
/// Members that a caller does not read cost nothing.
///
///   function                  range                        error (tests/noise/blobs/blob_profile_test.cpp)
///   gaussian_f(x)             finite; 0 from |x| = 9.37    kGaussianFloatError relative, for |x| <= 9.3
///   blob_profile(a, c)        finite, a <= c               kBlobProfileError ∫|integrand| ds + 1e-30
///   blob_lateral_from_afar(c) finite                       kBlobProfileError relative + 1e-30, to i1(-∞, c)
///
/// The error of blob_profile is relative for i1 and e. It is relative for j2 and g too, unless a < 0 < c, where they
/// may pass through zero. a and c are limited to ±kBlobProfileRange, so all results are finite. For a <= -kBlobAfar and
/// c >= 0, blob_lateral_from_afar(c) equals i1(a, c) within the same error. From c = kBlobAfar on (a whole pass) c √π
/// does so too. a and c are taken as given: the caller answers for the rounding of δ = c - a in floats.
///
/// Cost of a pixel on a loaded 2.6 GHz server core, with AVX2 (with baseline x86-64): i1 4.9 (11) ns,
/// blob_lateral_from_afar 1.1 (2.3) ns, gaussian_f 0.5 (1.1) ns.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "noise/math/erf.h"

namespace eikonal {

inline constexpr float kGaussianFloatError = 1.5e-7F;
inline constexpr float kBlobProfileError = 2e-6F;
inline constexpr float kBlobProfileRange = 1e15F;
inline constexpr float kBlobAfar = 4;

namespace detail {

inline constexpr float kSqrtPi = static_cast<float>(portable::kSqrtPi);
inline constexpr float kGaussianReach = 9.38F;  ///< where `gaussian` has become 0

// Selects use masks of bits. The compiler would join comparisons into branches, and loops with branches do not
// vectorise.
inline std::uint32_t bits(float x) {
    return std::bit_cast<std::uint32_t>(x);
}
inline float from_bits(std::uint32_t x) {
    return std::bit_cast<float>(x);
}
inline std::uint32_t mask(bool condition) {
    return -static_cast<std::uint32_t>(condition);
}
/// All ones for negative x and -0.
inline std::uint32_t negative_mask(float x) {
    return -(bits(x) >> 31);
}
inline float keep(std::uint32_t mask, float x) {
    return from_bits(bits(x) & mask);
}
inline float select(std::uint32_t mask, float x, float y) {
    return from_bits((bits(x) & mask) | (bits(y) & ~mask));
}

/// min(|x|, limit). The bits of positive floats are ordered as the floats are.
inline float magnitude(float x, float limit) {
    return from_bits(std::min(bits(x) & 0x7fffffffU, bits(limit)));
}
/// ±magnitude, with the sign bit of x.
inline float with_sign(float magnitude, float x) {
    return from_bits(bits(magnitude) ^ (bits(x) & 0x80000000U));
}

/// e^{-x² - correction} for 0 <= x <= kGaussianReach and |correction| << 1. It is 0 from x = 9.37 on, where it falls
/// below 2^-127. x² is split: its rounding would cause a relative error of x² 6e-8.
inline float gaussian(float x, float correction) {
    constexpr float kLog2E = 1.44269504F, kLn2Hi = 0.693359375F, kLn2Lo = -2.12194440e-4F;
    constexpr float kShifter = 12582912.0F;  // 1.5·2^23: the low bits of a sum hold the nearest integer
    const float high = from_bits(bits(x) & 0xfffff000U);
    const float z = high * high;  // exact
    const float low = (x - high) * (x + high) + correction;
    const float shifted = kShifter - z * kLog2E;
    const float k = shifted - kShifter;  // -127 … 0
    const float r = (-z - k * kLn2Hi) - (k * kLn2Lo + low);
    const float p = 0.499999989F + r * (0.166665082F + r * (0.0416669981F + r * (0.00837304614F + r * 0.00139053961F)));
    const float power = from_bits((bits(shifted) + 127U) << 23);  // 2^k, but 0 for k = -127
    return power * (1.0F + (r + r * r * p));
}

/// area and moment of noise/math/erf.h for 0 <= x <= 9.4: minimax polynomials in (x - 3)/(x + 3) of degree 8 and 9,
/// fitted to 8e-8 and 2e-8.
struct TailsFloat {
    float area, moment;
};

template <std::size_t N>
float horner(const std::array<float, N>& coefficients, float t) {
    float sum = coefficients[N - 1];
    for (std::size_t k = N - 1; k-- > 0;) sum = sum * t + coefficients[k];
    return sum;
}

inline TailsFloat tails(float x) {
    constexpr std::array<float, 9> kArea = {0.951813892F,    -0.782888635F,  0.523072138F,
                                            -0.275125426F,   0.105987702F,   -0.0238917404F,
                                            -0.00139260665F, 0.00282955217F, 0.000123199458F};
    constexpr std::array<float, 10> kMoment = {0.867350912F,     -1.30596418F,   1.19732917F,   -0.762146652F,
                                               0.324291765F,     -0.0680967991F, -0.013364165F, 0.0126296703F,
                                               -0.000622782086F, -0.0014372348F};
    const float inverse = 1.0F / (x + 3.0F);
    const float t = (x - 3.0F) * inverse;
    return {horner(kArea, t) * inverse, horner(kMoment, t) * inverse * inverse};
}

}  // namespace detail

/// e^{-x²}
inline float gaussian_f(float x) {
    return detail::gaussian(detail::magnitude(x, detail::kGaussianReach), 0.0F);
}

/// i1(-∞, c), for a blob well ahead of the camera.
inline float blob_lateral_from_afar(float c) {
    const float size = detail::magnitude(c, kBlobProfileRange), near = detail::magnitude(c, detail::kGaussianReach);
    return detail::keep(~detail::negative_mask(c), size * detail::kSqrtPi) +
           detail::gaussian(near, 0.0F) * detail::tails(near).moment;
}

/// The four integrals above.
struct BlobProfile {
    float i1, j2, e, g;
};

[[gnu::always_inline]] inline BlobProfile blob_profile(float a_given, float c_given) {
    using namespace detail;
    const float size_a = magnitude(a_given, kBlobProfileRange), size_c = magnitude(c_given, kBlobProfileRange);
    const float a = with_sign(size_a, a_given), c = with_sign(size_c, c_given);
    const float delta = c - a;
    // The closed form cancels for short rays. They use a series about the middle m; others use tails as in
    // blob_kernel.cpp.
    const std::uint32_t is_short = mask(delta * (size_a + size_c) < 1.5F);
    const std::uint32_t inside = negative_mask(a) & ~negative_mask(c);

    // m is a sum of two floats, since e^{-m²} amplifies its rounding.
    const float sum = a + c;
    const float from_c = sum - a;
    const float m = 0.5F * sum, m_low = 0.5F * ((a - (sum - from_c)) + (c - from_c));
    const float near_a = magnitude(a, kGaussianReach), near_c = magnitude(c, kGaussianReach);
    // e^{-m²} for the series, or e^{-a²} for the tails.
    const float first =
        gaussian(select(is_short, magnitude(m, kGaussianReach), near_a), keep(is_short, 2.0F * m * m_low));
    const float ec = gaussian(near_c, 0.0F);

    const auto [area_a, moment_a] = tails(near_a);
    const auto [area_c, moment_c] = tails(near_c);
    const float tail_a = with_sign(first * area_a, a), tail_c = with_sign(ec * area_c, -c);
    const float e = keep(inside, kSqrtPi) + (tail_a + tail_c);
    const float i1 = keep(inside, c * kSqrtPi) + ((ec * moment_c - first * moment_a) + delta * tail_a);
    const float j2 = 0.5F * (delta * first - e);
    const float g = 0.5F * (first - ec);

    // e^{-s²} = e^{-m²} Σ f_k x^k with s = m + hx, |x| <= 1, and f_{k+1} = -(α f_k + 2β f_{k-1})/(k + 1), |α| <= ¾,
    // β <= 3/8. M_i = ∫ x^i Σ f_k x^k dx.
    const float h = keep(is_short, 0.5F * delta), alpha = keep(is_short, m * delta), beta2 = 2.0F * h * h;
    float f_previous = 0.0F, f = 1.0F, M0 = 0.0F, M1 = 0.0F, M2 = 0.0F;
    for (int k = 0; k < 14; k += 2) {
        M0 += f * (2.0F / static_cast<float>(k + 1));
        M2 += f * (2.0F / static_cast<float>(k + 3));
        f_previous = -(alpha * f + beta2 * f_previous) * (1.0F / static_cast<float>(k + 1));
        M1 += f_previous * (2.0F / static_cast<float>(k + 3));
        f = -(alpha * f_previous + beta2 * f) * (1.0F / static_cast<float>(k + 2));
    }
    const float scale = h * first;
    const float short_i1 = h * scale * (M0 - M1);
    const float short_j2 = h * scale * (m * (M0 - M1) + h * (M1 - M2));
    const float short_g = scale * (m * M0 + h * M1);
    return {select(is_short, short_i1, i1), select(is_short, short_j2, j2), select(is_short, scale * M0, e),
            select(is_short, short_g, g)};
}

}  // namespace eikonal
