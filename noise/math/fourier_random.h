/// Gaussian amplitudes for Fourier modes, one row of modes at a time.
///
/// A mode is a pure function of (key, counter). The generator hashes the counter twice with Wellons' 32-bit finaliser
/// "triple32", and adds one half of the 64-bit key before each round. This yields two words for each mode. Box-Muller
/// in single precision turns them into Gaussians, so |value| <= kGaussianLimit. The bits are the same on every
/// processor (noise/base/instruction_sets.h). No function fails. tests/noise/math/fourier_random_test.cpp checks the
/// moments up to the fifth, and the independence of a mode's two parts, of neighbouring modes and of neighbouring keys.
/// Theory: PHYSICS.md#lattice.
#pragma once

#include <cstdint>

namespace eikonal {

/// √(2·31 ln 2), since the smallest uniform number is 2^-31.
inline constexpr float kGaussianLimit = 6.5562F;

/// Complex Gaussians for `count` modes, times `scale`:
///     re[i] = scale[i] g, im[i] = scale[i] g',  g and g' independent standard Gaussians of (key, counter[i]).
/// key: random bits, e.g. RandomStream::bits(row). The arrays must not overlap.
void gaussian_modes(std::uint64_t key, const std::uint32_t* counter, int count, const float* scale, float* re,
                    float* im);

}  // namespace eikonal
