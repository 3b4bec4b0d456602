/// Elementary functions that give the same bits on every x86-64 processor and C library.
///
/// The C library picks fused or unfused code by processor. Its sin, exp or pow may therefore differ in the last bit
/// between two render nodes. Whatever reaches a pixel goes through the functions below instead, or through the
/// single-precision ones that fourier_random.cpp and screen_band.cpp keep for batches of Gaussians. They use only
/// + - * / sqrt, conversions and integer operations in a fixed order, so they vectorise under EIKONAL_CLONES without a
/// change of bits. All are double precision. NaN gives NaN.
///
///   function             range                     maximal error (tests/noise/math/portable_math_test.cpp)
///   sincos_turns(x)      |x| <= 2^40 turns         kSincosError absolute; exact at multiples of 1/4
///   exp(x)               all; 0 below -745, inf above 709.78     kExpError relative (normal results)
///   log(x)               positive, normal or not   kLogError relative (absolute near x = 1 is as good)
///   pow(x, y)            x >= 0                    kExpError + |y ln x| kLogError relative
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace eikonal::portable {

inline constexpr double kSincosError = 4e-16;
inline constexpr double kExpError = 8e-16;
inline constexpr double kLogError = 6e-16;

inline constexpr double kPi = 3.141592653589793238462643383279502884;
inline constexpr double kTwoPi = 2 * kPi;

/// s = sin(2πx), c = cos(2πx). The argument is in turns, so its reduction is exact. Free of branches.
inline void sincos_turns(double x, double& s, double& c) {
    // Adding 1.5·2^52 rounds to the nearest multiple of 1/4. The low bits of the sum hold the quadrant.
    constexpr double kShifter = 6755399441055744.0;
    const double shifted = 4 * x + kShifter;
    const auto quadrant = std::bit_cast<std::uint64_t>(shifted);
    const double r = x - 0.25 * (shifted - kShifter);  // exact, |r| <= 1/8
    const double a = r * kTwoPi;                       // |a| <= π/4
    const double a2 = a * a;
    // Taylor series; the first dropped terms are below 1e-17 on |a| <= π/4.
    const double ps =
        a2 * (-1.0 / 6 +
              a2 * (1.0 / 120 +
                    a2 * (-1.0 / 5040 +
                          a2 * (1.0 / 362880 +
                                a2 * (-1.0 / 39916800 + a2 * (1.0 / 6227020800.0 + a2 * (-1.0 / 1307674368000.0)))))));
    const double sin_a = a + a * ps;
    const double cos_a =
        1.0 +
        a2 * (-0.5 + a2 * (1.0 / 24 + a2 * (-1.0 / 720 +
                                            a2 * (1.0 / 40320 + a2 * (-1.0 / 3628800 +
                                                                      a2 * (1.0 / 479001600.0 +
                                                                            a2 * (-1.0 / 87178291200.0 +
                                                                                  a2 * (1.0 / 20922789888000.0))))))));
    const bool swap = (quadrant & 1) != 0;
    const std::uint64_t sin_sign = (quadrant & 2) << 62;
    const std::uint64_t cos_sign = ((quadrant + 1) & 2) << 62;
    s = std::bit_cast<double>(std::bit_cast<std::uint64_t>(swap ? cos_a : sin_a) ^ sin_sign);
    c = std::bit_cast<double>(std::bit_cast<std::uint64_t>(swap ? sin_a : cos_a) ^ cos_sign);
}

/// sin and cos of radians. The reduction to turns costs |x| · 1e-16 of absolute accuracy.
inline void sincos(double x, double& s, double& c) {
    sincos_turns(x * (1 / kTwoPi), s, c);
}
inline double sin(double x) {
    double s, c;
    sincos(x, s, c);
    return s;
}
inline double cos(double x) {
    double s, c;
    sincos(x, s, c);
    return c;
}
inline double tan(double x) {
    double s, c;
    sincos(x, s, c);
    return s / c;
}

/// e^x. Free of branches, except for selects at the ends of the range.
inline double exp(double x) {
    constexpr double kLog2E = 1.4426950408889634074;
    constexpr double kLn2Hi = 6.93147180369123816490e-01, kLn2Lo = 1.90821492927058770002e-10;
    constexpr double kShifter = 6755399441055744.0;
    double y = x < -746.0 ? -746.0 : x;
    y = y > 710.0 ? 710.0 : y;
    const double shifted = y * kLog2E + kShifter;
    const double n = shifted - kShifter;
    const double r = (y - n * kLn2Hi) - n * kLn2Lo;  // |r| <= ln2/2
    double p = 1.0 / 87178291200.0;
    p = p * r + 1.0 / 6227020800.0;
    p = p * r + 1.0 / 479001600.0;
    p = p * r + 1.0 / 39916800.0;
    p = p * r + 1.0 / 3628800.0;
    p = p * r + 1.0 / 362880.0;
    p = p * r + 1.0 / 40320.0;
    p = p * r + 1.0 / 5040.0;
    p = p * r + 1.0 / 720.0;
    p = p * r + 1.0 / 120.0;
    p = p * r + 1.0 / 24.0;
    p = p * r + 1.0 / 6.0;
    p = p * r + 0.5;
    const double e = 1.0 + (r + r * r * p);
    // 2^n is split into two factors. Subnormal results and 2^1024 then need no special case.
    const auto k = static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(shifted) << 12) >> 12;  // n, sign-extended
    const std::int64_t half = k >> 1;
    const double a = std::bit_cast<double>(static_cast<std::uint64_t>(1023 + half) << 52);
    const double b = std::bit_cast<double>(static_cast<std::uint64_t>(1023 + (k - half)) << 52);
    const double result = e * a * b;
    return x > 709.782712893384 ? std::numeric_limits<double>::infinity() : (x != x ? x : result);
}

/// Natural logarithm. -inf at 0, NaN below.
inline double log(double x) {
    constexpr double kLn2Hi = 6.93147180369123816490e-01, kLn2Lo = 1.90821492927058770002e-10;
    const bool tiny = x < std::numeric_limits<double>::min();
    const double scaled = tiny ? x * 18014398509481984.0 : x;  // 2^54
    const auto bits = std::bit_cast<std::uint64_t>(scaled);
    // m in [1/√2, √2), x = m 2^e
    const std::uint64_t shifted = bits - 0x3fe6a09e667f3bcdULL;
    const auto e = static_cast<double>((static_cast<std::int64_t>(shifted) >> 52) - (tiny ? 54 : 0));
    const double m = std::bit_cast<double>((shifted & 0x000fffffffffffffULL) + 0x3fe6a09e667f3bcdULL);
    // log m = 2 atanh(s), s = (m-1)/(m+1), |s| <= 0.1716. Written as f - (f²/2 - s(f²/2 + R)), it keeps f exact.
    const double f = m - 1;
    const double s = f / (2 + f);
    const double z = s * s;
    double r = 2.0 / 21;
    r = r * z + 2.0 / 19;
    r = r * z + 2.0 / 17;
    r = r * z + 2.0 / 15;
    r = r * z + 2.0 / 13;
    r = r * z + 2.0 / 11;
    r = r * z + 2.0 / 9;
    r = r * z + 2.0 / 7;
    r = r * z + 2.0 / 5;
    r = r * z + 2.0 / 3;
    r = r * z;
    const double hf2 = 0.5 * f * f;
    const double result = e * kLn2Hi - ((hf2 - (s * (hf2 + r) + e * kLn2Lo)) - f);
    if (x > 0 && x < std::numeric_limits<double>::infinity()) return result;
    return x == 0 ? -std::numeric_limits<double>::infinity() : (x > 0 ? x : std::numeric_limits<double>::quiet_NaN());
}

/// x^y for x >= 0. pow(0, y) is 0 for y > 0, 1 for y = 0 and inf for y < 0.
inline double pow(double x, double y) {
    if (y == 0) return 1;
    return exp(y * log(x));
}

}  // namespace eikonal::portable
