/// Counter-based random numbers: value i of a stream is a pure function of (stream, i). Any frame, thread or order
/// draws the same numbers. Every consumer has a named stream of its own, derived from the scene's seed.
///
/// The generator hashes (stream, counter) by two rounds of the 64-bit finaliser of Stafford's variant 13 ("splitmix").
/// Gaussians come from Box-Muller on 32-bit uniform numbers: |value| <= 6.66, and the uniform numbers have a resolution
/// of 2^-32. No function fails.
#pragma once

#include <cstdint>
#include <string_view>

#include "noise/math/portable_math.h"

namespace eikonal {

constexpr std::uint64_t mix64(std::uint64_t x) {
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9ULL;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebULL;
    x ^= x >> 31;
    return x;
}

/// A named stream of random numbers.
class RandomStream {
  public:
    /// name: the consumer, e.g. "lattice". No two consumers share a name. index: distinguishes streams of one consumer.
    constexpr RandomStream(std::uint64_t seed, std::string_view name, std::uint64_t index = 0) {
        std::uint64_t h = 0xcbf29ce484222325ULL;
        for (const char c : name) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
        key_ = mix64(mix64(seed + 0x9e3779b97f4a7c15ULL) ^ h ^ mix64(index * 0xd1342543de82ef95ULL + 1));
    }

    /// 64 random bits.
    constexpr std::uint64_t bits(std::uint64_t i) const {
        return mix64(mix64(i * 0x9e3779b97f4a7c15ULL + key_) ^ key_);
    }

    /// Uniform in [0, 1), 53 bits.
    constexpr double uniform(std::uint64_t i) const { return static_cast<double>(bits(i) >> 11) * 0x1p-53; }

    /// Draws two independent standard Gaussians.
    void gaussians(std::uint64_t i, double& a, double& b) const {
        const std::uint64_t r = bits(i);
        // u1 is in (0, 1], so that the logarithm is finite.
        const double u1 = (static_cast<double>(static_cast<std::uint32_t>(r)) + 1.0) * 0x1p-32;
        const double u2 = static_cast<double>(static_cast<std::uint32_t>(r >> 32)) * 0x1p-32;
        const double radius = std::sqrt(-2 * portable::log(u1));
        double s, c;
        portable::sincos_turns(u2, s, c);
        a = radius * c;
        b = radius * s;
    }

  private:
    std::uint64_t key_ = 0;
};

}  // namespace eikonal
