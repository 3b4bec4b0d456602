#include "noise/math/fourier_random.h"

#include <bit>
#include <cmath>

#include "noise/base/instruction_sets.h"

namespace eikonal {
namespace {

/// Wellons' triple32: a bijection of 32-bit words with an avalanche bias of 0.02 %.
inline std::uint32_t triple32(std::uint32_t x) {
    x = (x ^ (x >> 17)) * 0xed5ad4bbU;
    x = (x ^ (x >> 11)) * 0xac4c1b51U;
    x = (x ^ (x >> 15)) * 0x31848babU;
    return x ^ (x >> 14);
}

/// ln x for x in [2^-31, 1], to a few units in the last place.
inline float log_unit(float x) {
    const auto bits = std::bit_cast<std::int32_t>(x);
    const std::int32_t shifted = bits - 0x3f3504f3;  // m in [1/√2, √2)
    const auto e = static_cast<float>(shifted >> 23);
    const float m = std::bit_cast<float>((shifted & 0x007fffff) + 0x3f3504f3);
    const float s = (m - 1) / (m + 1);
    const float z = s * s;
    const float series = 2 + z * (2.0F / 3 + z * (2.0F / 5 + z * (2.0F / 7 + z * (2.0F / 9))));
    return s * series + e * 0.693147181F;
}

}  // namespace

EIKONAL_CLONES
void gaussian_modes(std::uint64_t key, const std::uint32_t* __restrict counter, int count,
                    const float* __restrict scale, float* __restrict re, float* __restrict im) {
    const auto low = static_cast<std::uint32_t>(key);
    const auto high = static_cast<std::uint32_t>(key >> 32);
    for (int i = 0; i < count; ++i) {
        const std::uint32_t r0 = triple32(counter[i] * 0x9e3779b9U + low);
        const std::uint32_t r1 = triple32(r0 + high);
        // u is in (0, 1]. The angle a is in [-π/2, π/2); a random sign of its cosine makes it cover the circle.
        const float u = (static_cast<float>(static_cast<std::int32_t>(r0 >> 1)) + 1.0F) * 0x1p-31F;
        const float radius = std::sqrt(-2 * log_unit(u)) * scale[i];
        const float a = static_cast<float>(static_cast<std::int32_t>(r1 << 1)) * (1.57079633F * 0x1p-31F);
        const float a2 = a * a;
        const float sine = a + a * (a2 * (-1.0F / 6 + a2 * (1.0F / 120 + a2 * (-1.0F / 5040 + a2 * (1.0F / 362880)))));
        const float cosine =
            1 + a2 * (-0.5F + a2 * (1.0F / 24 + a2 * (-1.0F / 720 + a2 * (1.0F / 40320 + a2 * (-1.0F / 3628800)))));
        re[i] = radius * std::bit_cast<float>(std::bit_cast<std::uint32_t>(cosine) ^ (r1 & 0x80000000U));
        im[i] = radius * sine;
    }
}

}  // namespace eikonal
