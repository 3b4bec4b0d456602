/// Rows of stored pixel values to floats and back, without transfer curves. Every file format uses it.
///
/// Unsigned integers map 0…max to 0…1. Signed integers map -max…max to -1…1. Half, float and double stay as they are.
/// Encoding rounds to nearest (half: to even), limits to the type's range and stores NaN as zero. Both sides may be
/// interleaved: `stride` counts bytes on the stored side, and `lanes` counts floats on the float side.
#pragma once

#include <OpenImageIO/typedesc.h>

#include <cstddef>
#include <cstdint>

namespace eikonal {

/// Values of half pictures beyond this, including infinities, count as this.
inline constexpr float kLargestHalf = 65504.0f;

/// Stored values to floats. Infinity and NaN of float types are kept.
void decode_values(OIIO::TypeDesc::BASETYPE type, const std::byte* stored, std::size_t stride, float* values,
                   std::size_t lanes, std::size_t count);

/// Floats to stored values.
void encode_values(OIIO::TypeDesc::BASETYPE type, const float* values, std::size_t lanes, std::byte* stored,
                   std::size_t stride, std::size_t count);

/// Contiguous half to float. NaN becomes 0, and infinities become ±kLargestHalf. Returns how many of them there were.
std::size_t decode_half_finite(const std::uint16_t* stored, float* values, std::size_t count);

/// Contiguous float to half, as encode_values does it, but vectorised.
void encode_half(const float* values, std::uint16_t* stored, std::size_t count);

/// Makes values finite in place: NaN becomes 0, and infinities become ±kLargestHalf. Returns how many there were.
std::size_t make_finite(float* values, std::size_t count);

}  // namespace eikonal
