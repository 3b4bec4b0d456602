/// Gaussian amplitudes for Fourier modes, a row of modes at a time, fast enough to hide behind the transform.
///
/// The generator hashes a counter twice with Wellons' 32-bit finaliser "triple32", each time after adding half of a
/// 64-bit key: two words a mode, so that a mode is a pure function of (key, counter). Then Box-Muller in single
/// precision: |value| <= kGaussianLimit. Same bits on every processor (noise/base/instruction_sets.h);
/// tests/lattice_test.cpp checks moments up to the fifth, and independence of a mode's parts, of neighbouring modes and
/// of neighbouring keys.
#pragma once

#include <cstdint>

namespace eikonal {

/// √(2·31 ln 2): the smallest uniform is 2^-31.
inline constexpr float kGaussianLimit = 6.5562F;

/// Complex Gaussians for `count` modes, times `scale`:
///     re[i] = scale[i] g, im[i] = scale[i] g',  g and g' independent standard Gaussians of (key, counter[i]).
/// key: well mixed, e.g. RandomStream::bits(row). The arrays must not overlap.
void gaussian_modes(std::uint64_t key, const std::uint32_t* counter, int count, const float* scale, float* re,
                    float* im);

}  // namespace eikonal
