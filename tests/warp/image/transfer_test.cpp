// Transfer curves and the half codec: every code survives, tables follow their formulas.
#include "warp/image/transfer.h"

#include <OpenImageIO/half.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "warp/image/pixel_codec.h"

namespace eikonal {
namespace {
using OIIO::TypeDesc;

TEST(Transfer, EveryCodeSurvivesLinearLight) {
    for (const Transfer transfer : {Transfer::Linear, Transfer::SRGB, Transfer::BT709, Transfer::Gamma22, Transfer::PQ,
                                    Transfer::HLG, Transfer::KodakLog}) {
        SCOPED_TRACE(name_of(transfer));
        const TransferCurve& curve = TransferCurve::of(transfer);
        const auto encoded = [&](float linear, TypeDesc::BASETYPE type) {
            std::uint16_t code = 0;
            const float value = curve.from_linear(linear);
            encode_values(type, &value, 1, reinterpret_cast<std::byte*>(&code), sizeof code, 1);
            return code;
        };
        for (std::size_t code = 0; code < 256; ++code) EXPECT_EQ(encoded(curve.codes8()[code], TypeDesc::UINT8), code);
        const auto codes16 = curve.codes16();
        for (std::size_t code = 0; code < 65536; ++code) ASSERT_EQ(encoded(codes16[code], TypeDesc::UINT16), code);
        for (std::size_t code = 1; code < 65536; ++code) ASSERT_GT(codes16[code], codes16[code - 1]);
    }
}

TEST(Transfer, TablesFollowTheFormulas) {
    for (const Transfer transfer : {Transfer::SRGB, Transfer::BT709, Transfer::Gamma22, Transfer::PQ, Transfer::HLG}) {
        SCOPED_TRACE(name_of(transfer));
        const TransferCurve& curve = TransferCurve::of(transfer);
        double worst_to = 0, worst_from = 0;
        std::vector<float> inputs;
        for (float x = 1e-6f; x < 1.2f; x *= 1.0013f) inputs.insert(inputs.end(), {x, -x});
        std::vector<float> to = inputs, from = inputs;
        curve.to_linear(to);
        curve.from_linear(from);
        for (std::size_t i = 0; i < inputs.size(); ++i) {
            const float x = inputs[i];
            const double linear = to_linear(transfer, x), code = from_linear(transfer, x);
            worst_to = std::max(worst_to, std::fabs(curve.to_linear(x) - linear) / std::max(std::fabs(linear), 1e-3));
            worst_from = std::max(worst_from, std::fabs(curve.from_linear(x) - code) / std::max(std::fabs(code), 1e-3));
            ASSERT_EQ(to[i], curve.to_linear(x));
            ASSERT_EQ(from[i], curve.from_linear(x));
        }
        EXPECT_LT(worst_to, kCurveError);
        EXPECT_LT(worst_from, kCurveError);
        RecordProperty(std::string(name_of(transfer)), std::to_string(worst_to) + " " + std::to_string(worst_from));
        EXPECT_EQ(curve.to_linear(std::numeric_limits<float>::quiet_NaN()), 0);
        EXPECT_TRUE(std::isfinite(curve.to_linear(std::numeric_limits<float>::infinity())));
    }
    EXPECT_NEAR(to_linear(Transfer::SRGB, 0.5f), 0.21404114, 1e-7);
    EXPECT_NEAR(from_linear(Transfer::BT709, 0.18f), 0.40900813, 1e-3);
    EXPECT_NEAR(to_linear(Transfer::PQ, 0.58068888f), 1, 1e-3) << "203 cd/m2";
    EXPECT_NEAR(to_linear(Transfer::HLG, 0.75f), 1, 1e-6);
    EXPECT_NEAR(to_linear(Transfer::KodakLog, 685.0f / 1023), 1, 1e-6);
    EXPECT_NEAR(to_linear(Transfer::KodakLog, 95.0f / 1023), 0, 1e-6);
}

TEST(PixelCodec, HalfIsOpenExrs) {
    for (unsigned bits = 0; bits < 65536; ++bits) {
        const auto stored = static_cast<std::uint16_t>(bits);
        const half reference = [&] {
            half h;
            h.setBits(stored);
            return h;
        }();
        float value = -1, finite = -1;
        decode_values(TypeDesc::HALF, reinterpret_cast<const std::byte*>(&stored), 2, &value, 1, 1);
        decode_half_finite(&stored, &finite, 1);
        if (reference.isNan()) {
            EXPECT_TRUE(std::isnan(value));
            EXPECT_EQ(finite, 0);
            continue;
        }
        ASSERT_EQ(value, static_cast<float>(reference));
        if (reference.isInfinity()) continue;
        ASSERT_EQ(finite, value);
        // This half, and points towards the next one, ties included.
        const auto next = static_cast<float>(std::nextafter(value, 1e9f));
        for (const float x : {value, next, value * 1.00024414f, value + 2.98023224e-8f}) {
            if (std::fabs(x) >= kLargestHalf) continue;
            std::uint16_t encoded = 0;
            encode_half(&x, &encoded, 1);
            ASSERT_EQ(encoded, half(x).bits()) << x;
        }
    }
    const float beyond[3] = {1e6f, -std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()};
    std::uint16_t encoded[3];
    encode_half(beyond, encoded, 3);
    EXPECT_EQ(encoded[0], 0x7bff);
    EXPECT_EQ(encoded[1], 0xfbff);
    EXPECT_EQ(encoded[2] & 0x7fff, 0);
}

}  // namespace
}  // namespace eikonal
