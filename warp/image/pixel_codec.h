/// Rows of stored pixel values to floats and back, without transfer curves: what every file format shares.
///
/// Convention: unsigned integers map 0…max to 0…1, signed ones -max…max to -1…1, half, float and double as they are.
/// Encoding rounds to nearest (half: to even), limits to the type's range and stores NaN as zero. Strides: source and
/// target may be interleaved; `stride` is in bytes of the stored side, `lanes` in floats of the float side.
#pragma once

#include <OpenImageIO/typedesc.h>

#include <cstddef>
#include <cstdint>

namespace eikonal {

/// Values of half pictures beyond this (infinities too) are treated as this.
inline constexpr float kLargestHalf = 65504.0f;

/// Stored values to floats. Infinity and NaN of float types come through.
void decode_values(OIIO::TypeDesc::BASETYPE type, const std::byte* stored, std::size_t stride, float* values,
                   std::size_t lanes, std::size_t count);

/// Floats to stored values.
void encode_values(OIIO::TypeDesc::BASETYPE type, const float* values, std::size_t lanes, std::byte* stored,
                   std::size_t stride, std::size_t count);

/// Contiguous half to float; NaN becomes 0, infinities ±kLargestHalf. Returns how many of them there were. Vectorised.
std::size_t decode_half_finite(const std::uint16_t* stored, float* values, std::size_t count);

/// Contiguous float to half, as encode_values. Vectorised.
void encode_half(const float* values, std::uint16_t* stored, std::size_t count);

/// Makes values finite in place: NaN becomes 0, infinities ±kLargestHalf. Returns how many of them there were.
/// Vectorised.
std::size_t make_finite(float* values, std::size_t count);

}  // namespace eikonal
