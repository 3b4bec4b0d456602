#include "warp/image/pixel_codec.h"

#if defined(__x86_64__) && !defined(__clang__)  // Clang 14 cannot ask for "f16c"
#include <immintrin.h>
#endif

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "noise/base/instruction_sets.h"

namespace eikonal {
namespace {

constexpr std::uint32_t kSign = 0x80000000u, kMagnitude = 0x7fffffffu, kInfinity = 0x7f800000u;
constexpr std::uint32_t kLargestHalfBits = 0x477fe000u;  // bits of kLargestHalf as a float

/// Half to float, exact. Moves exponent and mantissa into place and corrects the bias by a power of two.
inline float half_to_float(std::uint16_t stored) {
    const std::uint32_t magnitude = stored & 0x7fffu;
    const std::uint32_t finite = std::bit_cast<std::uint32_t>(std::bit_cast<float>(magnitude << 13) * 0x1p112f);
    const std::uint32_t value = magnitude >= 0x7c00u ? (magnitude << 13) | kInfinity : finite;
    return std::bit_cast<float>(value | (static_cast<std::uint32_t>(stored & 0x8000u) << 16));
}

inline float finite(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const std::uint32_t magnitude = bits & kMagnitude;
    const std::uint32_t limited = magnitude > kInfinity ? 0 : kLargestHalfBits;
    return std::bit_cast<float>((bits & kSign) | (magnitude >= kInfinity ? limited : magnitude));
}

/// Float to half, rounded to nearest even. Limits to the largest finite half. NaN becomes zero.
inline std::uint16_t float_to_half(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    std::uint32_t magnitude = bits & kMagnitude;
    magnitude = magnitude > kInfinity ? 0 : magnitude;
    magnitude = magnitude > kLargestHalfBits ? kLargestHalfBits : magnitude;
    const std::uint32_t normal = (magnitude - 0x38000000u + 0xfffu + ((magnitude >> 13) & 1u)) >> 13;
    // Below 2^-14, the addition to 0.5 rounds: the last place of 0.5 is the smallest half.
    const std::uint32_t tiny = std::bit_cast<std::uint32_t>(std::bit_cast<float>(magnitude) + 0.5f) - 0x3f000000u;
    const std::uint32_t half = magnitude < 0x38800000u ? tiny : normal;
    return static_cast<std::uint16_t>(half | ((bits >> 16) & 0x8000u));
}

template <class T>
T load(const std::byte* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

template <class Stored, class Convert>
void decode_each(const std::byte* stored, std::size_t stride, float* values, std::size_t lanes, std::size_t count,
                 Convert convert) {
    for (std::size_t i = 0; i < count; ++i) values[i * lanes] = convert(load<Stored>(stored + i * stride));
}

template <class Stored, class Convert>
void encode_each(const float* values, std::size_t lanes, std::byte* stored, std::size_t stride, std::size_t count,
                 Convert convert) {
    for (std::size_t i = 0; i < count; ++i) {
        const Stored value = convert(values[i * lanes]);
        std::memcpy(stored + i * stride, &value, sizeof value);
    }
}

/// The type for computing with codes: float up to 16 bits, where all codes are exact, and double beyond.
template <class T>
using Wide = std::conditional_t<(sizeof(T) > 2), double, float>;

template <class T>
float fraction(T code) {
    constexpr Wide<T> kMax = static_cast<Wide<T>>(std::numeric_limits<T>::max());
    return static_cast<float>(static_cast<Wide<T>>(code) / kMax);
}

template <class T>
T nearest(float value) {
    constexpr Wide<T> kMax = static_cast<Wide<T>>(std::numeric_limits<T>::max());
    constexpr Wide<T> kMin = std::is_signed_v<T> ? -kMax : 0;
    Wide<T> scaled = static_cast<Wide<T>>(value) * kMax;
    scaled = scaled > kMin ? scaled : kMin;
    scaled = scaled < kMax ? scaled : kMax;
    if (value != value) return T{0};
    if (scaled >= kMax) return std::numeric_limits<T>::max();
    constexpr Wide<T> kHalf = static_cast<Wide<T>>(0.5);
    return static_cast<T>(scaled < 0 ? scaled - kHalf : scaled + kHalf);
}

/// Calls `f` with a value of the stored type. std::byte stands for half.
template <class F>
void dispatch(OIIO::TypeDesc::BASETYPE type, F f) {
    switch (type) {
        case OIIO::TypeDesc::UINT8:
            return f(std::uint8_t{});
        case OIIO::TypeDesc::INT8:
            return f(std::int8_t{});
        case OIIO::TypeDesc::UINT16:
            return f(std::uint16_t{});
        case OIIO::TypeDesc::INT16:
            return f(std::int16_t{});
        case OIIO::TypeDesc::UINT32:
            return f(std::uint32_t{});
        case OIIO::TypeDesc::INT32:
            return f(std::int32_t{});
        case OIIO::TypeDesc::HALF:
            return f(std::byte{});
        case OIIO::TypeDesc::FLOAT:
            return f(float{});
        case OIIO::TypeDesc::DOUBLE:
            return f(double{});
        default:
            throw std::logic_error("pixel type without a codec");
    }
}

}  // namespace

void decode_values(OIIO::TypeDesc::BASETYPE type, const std::byte* stored, std::size_t stride, float* values,
                   std::size_t lanes, std::size_t count) {
    dispatch(type, [&](auto example) {
        using T = decltype(example);
        if constexpr (std::is_same_v<T, std::byte>)
            decode_each<std::uint16_t>(stored, stride, values, lanes, count, half_to_float);
        else if constexpr (std::is_floating_point_v<T>)
            decode_each<T>(stored, stride, values, lanes, count, [](T v) { return static_cast<float>(v); });
        else
            decode_each<T>(stored, stride, values, lanes, count, fraction<T>);
    });
}

void encode_values(OIIO::TypeDesc::BASETYPE type, const float* values, std::size_t lanes, std::byte* stored,
                   std::size_t stride, std::size_t count) {
    dispatch(type, [&](auto example) {
        using T = decltype(example);
        if constexpr (std::is_same_v<T, std::byte>)
            encode_each<std::uint16_t>(values, lanes, stored, stride, count, float_to_half);
        else if constexpr (std::is_floating_point_v<T>)
            encode_each<T>(values, lanes, stored, stride, count, [](float v) {
                return static_cast<T>(std::bit_cast<float>(
                    (std::bit_cast<std::uint32_t>(v) & kMagnitude) > kInfinity ? 0u : std::bit_cast<std::uint32_t>(v)));
            });
        else
            encode_each<T>(values, lanes, stored, stride, count, nearest<T>);
    });
}

EIKONAL_CLONES std::size_t decode_half_finite(const std::uint16_t* stored, float* values, std::size_t count) {
    std::uint32_t strange = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t magnitude = stored[i] & 0x7fffu;
        const std::uint32_t value = std::bit_cast<std::uint32_t>(std::bit_cast<float>(magnitude << 13) * 0x1p112f);
        const std::uint32_t special = magnitude > 0x7c00u ? 0u : kLargestHalfBits;
        const std::uint32_t sign = static_cast<std::uint32_t>(stored[i] & 0x8000u) << 16;
        values[i] = std::bit_cast<float>((magnitude >= 0x7c00u ? special : value) | sign);
        strange += magnitude >= 0x7c00u ? 1u : 0u;
    }
    return strange;
}

namespace {

#if defined(__x86_64__) && !defined(__clang__)
/// float_to_half by the processor's own conversion, which rounds in the same way. Returns how many values it converted.
__attribute__((target("avx,f16c"))) std::size_t encode_half_f16c(const float* values, std::uint16_t* stored,
                                                                 std::size_t count) {
    const __m256 largest = _mm256_set1_ps(65504.0f), sign = _mm256_set1_ps(-0.0f);
    std::size_t i = 0;
    for (; i + 8 <= count; i += 8) {
        const __m256 value = _mm256_loadu_ps(values + i);
        const __m256 number = _mm256_and_ps(value, _mm256_cmp_ps(value, value, _CMP_ORD_Q));  // NaN becomes 0
        const __m256 magnitude = _mm256_min_ps(_mm256_andnot_ps(sign, number), largest);
        const __m256 clamped = _mm256_or_ps(magnitude, _mm256_and_ps(sign, value));
        _mm_storeu_si128(reinterpret_cast<__m128i*>(stored + i), _mm256_cvtps_ph(clamped, _MM_FROUND_TO_NEAREST_INT));
    }
    return i;
}
#endif

}  // namespace

void encode_half(const float* values, std::uint16_t* stored, std::size_t count) {
    std::size_t done = 0;
#if defined(__x86_64__) && !defined(__clang__)
    static const bool has_f16c = __builtin_cpu_supports("avx") && __builtin_cpu_supports("f16c");
    if (has_f16c) done = encode_half_f16c(values, stored, count);
#endif
    for (; done < count; ++done) stored[done] = float_to_half(values[done]);
}

EIKONAL_CLONES std::size_t make_finite(float* values, std::size_t count) {
    std::uint32_t strange = 0;
    for (std::size_t i = 0; i < count; ++i) {
        strange += (std::bit_cast<std::uint32_t>(values[i]) & kMagnitude) >= kInfinity ? 1u : 0u;
        values[i] = finite(values[i]);
    }
    return strange;
}

}  // namespace eikonal
