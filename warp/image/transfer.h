/// Coded values to linear light and back. This is the only definition of the transfer curves of pictures and movies.
///
/// Codes are floats on 0…1: an integer code divided by its largest. Linear light is 1 at reference white. The formula
/// also holds above one, and it is odd about zero. Super-whites and undershoots of filters therefore survive.
///
///   Linear    identity
///   SRGB      IEC 61966-2-1
///   BT709     inverse of the camera curve of BT.709/BT.601/BT.2020, so that footage is resampled in the light the
///             camera saw
///   Gamma22   power 2.2
///   PQ        SMPTE ST 2084; linear 1 is 203 cd/m² (BT.2408); codes are limited to 1
///   HLG       BT.2100, scene light; linear 1 is code 0.75 (BT.2408); codes are limited to 2
///   KodakLog  Cineon/DPX printing density: black 95, white 685 of 1023, gamma 0.6; not odd: code 0 is slightly
///             negative light; codes are limited to 2
///
/// There are two forms. The free functions evaluate the formula (noise/math/portable_math.h) and round once.
/// TransferCurve tabulates it. Its error is within kCurveError, relative to the larger of the value and 1e-3. To
/// linear, it is exact for every 8- and 16-bit code. Code -> linear -> code, rounded to nearest, is the identity for
/// all of them. Both forms give the same bits on every processor. NaN gives NaN from the formula and zero from the
/// tables.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <mutex>
#include <span>
#include <string_view>
#include <vector>

namespace eikonal {

enum class Transfer { Linear, SRGB, BT709, Gamma22, PQ, HLG, KodakLog };

inline constexpr double kCurveError = 4e-5;

float to_linear(Transfer transfer, float code);
float from_linear(Transfer transfer, float linear);

/// The lower-case name in messages.
std::string_view name_of(Transfer transfer);

/// A curve as tables over floating-point numbers. Nodes are evenly spaced within each power of two. Values between them
/// are interpolated linearly.
class TransferCurve {
  public:
    /// The only instance of a curve, made at first use.
    static const TransferCurve& of(Transfer transfer);

    bool linear() const { return transfer_ == Transfer::Linear; }

    float to_linear(float code) const {
        return tabulated_ ? to_.at(code) : linear() ? code : eikonal::to_linear(transfer_, code);
    }
    float from_linear(float value) const {
        return tabulated_ ? from_.at(value) : linear() ? value : eikonal::from_linear(transfer_, value);
    }
    /// In place, vectorised.
    void to_linear(std::span<float> values) const;
    void from_linear(std::span<float> values) const;

    /// Linear light of all 256 codes / 255.
    std::span<const float, 256> codes8() const { return codes8_; }
    /// Linear light of all 65536 codes / 65535. Made at first use.
    std::span<const float> codes16() const;

    /// One direction of the curve. It is odd about zero, constant beyond the last node, and zero for NaN. Free of
    /// branches.
    struct Table {
        std::int32_t low_bits = 0;   ///< bits of the first node above zero, a power of two
        std::int32_t high_bits = 0;  ///< bits of the last node
        int shift = 0;               ///< log2 of the distance between nodes in units of the last place
        std::vector<float> nodes;    ///< the value at zero, at the first node, …

        float at(float x) const {
            const Place place = find(low_bits, high_bits, shift, x);
            return blend(nodes.data(), place, x);
        }

        /// The nodes between which |x| lies, and the place between them.
        struct Place {
            std::int32_t index;
            float fraction;
        };
        static Place find(std::int32_t low_bits, std::int32_t high_bits, int shift, float x) {
            std::int32_t magnitude = std::bit_cast<std::int32_t>(x) & 0x7fffffff;
            magnitude = magnitude > 0x7f800000 ? 0 : magnitude;  // NaN
            magnitude = magnitude < high_bits ? magnitude : high_bits;
            const std::int32_t offset = magnitude - low_bits;
            const float spacing = std::bit_cast<float>((127 - shift) << 23);
            const float inside = static_cast<float>(offset & ((1 << shift) - 1)) * spacing;
            const float below = std::bit_cast<float>(magnitude) / std::bit_cast<float>(low_bits);
            return {offset < 0 ? 0 : (offset >> shift) + 1, offset < 0 ? below : inside};
        }
        static float blend(const float* nodes, Place place, float x) {
            const float a = nodes[place.index], b = nodes[place.index + 1];
            return std::bit_cast<float>(std::bit_cast<std::int32_t>(a + (b - a) * place.fraction) |
                                        (std::bit_cast<std::int32_t>(x) & std::numeric_limits<std::int32_t>::min()));
        }
    };

  private:
    explicit TransferCurve(Transfer transfer);
    template <Transfer T>
    static const TransferCurve& instance();

    Transfer transfer_;
    bool tabulated_ = false;  ///< false for Linear, and for KodakLog, which is not odd and uses the formula
    Table to_, from_;
    std::array<float, 256> codes8_{};
    mutable std::once_flag codes16_made_;
    mutable std::vector<float> codes16_;
};

}  // namespace eikonal
