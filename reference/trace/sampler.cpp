#include "reference/trace/sampler.h"

#include "noise/math/random.h"

namespace eikonal::reference {
namespace {

std::uint32_t reversed(std::uint32_t x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

/// Owen's nested uniform scramble of a number whose bits are reversed: each bit is flipped by a hash of those below it.
std::uint32_t mixed(std::uint32_t x, std::uint32_t seed) {
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

/// The second dimension of Sobol's sequence (primitive polynomial x + 1), with reversed bits. Direction number k is
/// (1 + S)^k applied to the first one, where S is a shift by one. So bit j is the sum of all index bits k whose
/// binomial (k over j) is odd. These are the k that have every bit of j.
std::uint32_t sobol_second(std::uint32_t index) {
    index ^= (index >> 1) & 0x55555555u;
    index ^= (index >> 2) & 0x33333333u;
    index ^= (index >> 4) & 0x0f0f0f0fu;
    index ^= (index >> 8) & 0x00ff00ffu;
    return index ^ (index >> 16);
}

}  // namespace

glm::dvec2 spread_point(std::uint32_t index, std::uint64_t stream) {
    const std::uint64_t a = mix64(stream + 0x9e3779b97f4a7c15ULL), b = mix64(a);
    const std::uint32_t i = reversed(mixed(reversed(index), static_cast<std::uint32_t>(a)));
    const std::uint32_t x = reversed(mixed(i, static_cast<std::uint32_t>(a >> 32)));
    const std::uint32_t y = reversed(mixed(sobol_second(i), static_cast<std::uint32_t>(b)));
    return {x * 0x1p-32, y * 0x1p-32};
}

}  // namespace eikonal::reference
