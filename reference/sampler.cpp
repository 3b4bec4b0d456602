#include "reference/sampler.h"

#include "noise/random.h"

namespace eikonal::reference {
namespace {

std::uint32_t reversed(std::uint32_t x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

/// Nested uniform scramble: each bit is flipped by a hash of the bits above it.
std::uint32_t scrambled(std::uint32_t x, std::uint32_t seed) {
    x = reversed(x);
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return reversed(x);
}

/// Second dimension of Sobol's sequence (primitive polynomial x + 1): each direction number is the one before xor
/// itself shifted by one.
std::uint32_t sobol_second(std::uint32_t index) {
    std::uint32_t result = 0;
    for (std::uint32_t direction = 0x80000000u; index != 0; index >>= 1, direction ^= direction >> 1)
        if (index & 1u) result ^= direction;
    return result;
}

}  // namespace

glm::dvec2 spread_point(std::uint32_t index, std::uint64_t stream) {
    const std::uint64_t a = mix64(stream + 0x9e3779b97f4a7c15ULL), b = mix64(a);
    const std::uint32_t i = scrambled(index, static_cast<std::uint32_t>(a));
    const std::uint32_t x = scrambled(reversed(i), static_cast<std::uint32_t>(a >> 32));
    const std::uint32_t y = scrambled(sobol_second(i), static_cast<std::uint32_t>(b));
    return {x * 0x1p-32, y * 0x1p-32};
}

}  // namespace eikonal::reference
