#include "warp/image/transfer.h"

#include <algorithm>
#include <cmath>

#include "noise/base/instruction_sets.h"
#include "noise/math/portable_math.h"

namespace eikonal {
namespace {

using portable::exp;
using portable::log;
using portable::pow;

// BT.709 with the constants of BT.2020, for which the two branches meet.
constexpr double kAlpha709 = 1.09929682680944, kBeta709 = 0.018053968510807;
// ST 2084
constexpr double kM1 = 2610.0 / 16384, kM2 = 2523.0 / 32, kC1 = 3424.0 / 4096, kC2 = 2413.0 / 128, kC3 = 2392.0 / 128;
constexpr double kPqWhite = 203.0 / 10000;
// BT.2100 HLG
constexpr double kHlgA = 0.17883277, kHlgB = 1 - 4 * kHlgA, kHlgC = 0.55991072952956;
constexpr double kHlgWhite = 0.26496256042100724;  // scene light of code 0.75
// Cineon
constexpr double kLn10 = 2.302585092994045684;
constexpr double kLogStep = 0.002 / 0.6 * 1023, kLogBlack = 95.0 / 1023, kLogWhite = 685.0 / 1023;

double kodak_offset() {
    return exp(kLn10 * kLogStep * (kLogBlack - kLogWhite));
}

/// The curves for codes >= 0 (KodakLog: all).
double to_linear_positive(Transfer transfer, double v) {
    switch (transfer) {
        case Transfer::Linear:
            return v;
        case Transfer::SRGB:
            return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
        case Transfer::BT709:
            return v < 4.5 * kBeta709 ? v / 4.5 : pow((v + kAlpha709 - 1) / kAlpha709, 1 / 0.45);
        case Transfer::Gamma22:
            return pow(v, 2.2);
        case Transfer::PQ: {
            const double p = pow(std::min(v, 1.0), 1 / kM2);
            return pow(std::max(p - kC1, 0.0) / (kC2 - kC3 * p), 1 / kM1) / kPqWhite;
        }
        case Transfer::HLG:
            return (v <= 0.5 ? v * v / 3 : (exp((std::min(v, 2.0) - kHlgC) / kHlgA) + kHlgB) / 12) / kHlgWhite;
        case Transfer::KodakLog: {
            const double offset = kodak_offset();
            return (exp(kLn10 * kLogStep * (std::min(v, 2.0) - kLogWhite)) - offset) / (1 - offset);
        }
    }
    return v;
}

double from_linear_positive(Transfer transfer, double v) {
    switch (transfer) {
        case Transfer::Linear:
            return v;
        case Transfer::SRGB:
            return v <= 0.0031308 ? v * 12.92 : 1.055 * pow(v, 1 / 2.4) - 0.055;
        case Transfer::BT709:
            return v < kBeta709 ? 4.5 * v : kAlpha709 * pow(v, 0.45) - (kAlpha709 - 1);
        case Transfer::Gamma22:
            return pow(v, 1 / 2.2);
        case Transfer::PQ: {
            if (v == 0) return 0;  // the formula gives 7e-7, which would break the symmetry
            const double p = pow(v * kPqWhite, kM1);
            return pow((kC1 + kC2 * p) / (1 + kC3 * p), kM2);
        }
        case Transfer::HLG: {
            const double scene = v * kHlgWhite;
            return scene <= 1.0 / 12 ? std::sqrt(3 * scene) : kHlgA * log(12 * scene - kHlgB) + kHlgC;
        }
        case Transfer::KodakLog: {
            const double offset = kodak_offset();
            const double light = std::max(v * (1 - offset) + offset, 1e-9);
            return kLogWhite + log(light) / (kLn10 * kLogStep);
        }
    }
    return v;
}

template <class Function>
TransferCurve::Table tabulate(int low_exponent, int high_exponent, int nodes_log2, Function f) {
    TransferCurve::Table table;
    table.shift = 23 - nodes_log2;
    table.low_bits = (127 + low_exponent) << 23;
    table.high_bits = (127 + high_exponent) << 23;
    const int count = (table.high_bits - table.low_bits) >> table.shift;
    table.nodes.assign(1, 0.0f);
    for (int i = 0; i < count + 2; ++i)
        table.nodes.push_back(f(std::bit_cast<float>(table.low_bits + (i << table.shift))));
    return table;
}

}  // namespace

namespace detail {
/// Works in blocks, so that the arithmetic around the look-ups vectorises.
EIKONAL_CLONES void apply_table(const float* nodes, std::int32_t low_bits, std::int32_t high_bits, int shift,
                                float* values, std::size_t n) {
    constexpr std::size_t kBlock = 128;
    std::int32_t index[kBlock];
    float fraction[kBlock];
    for (std::size_t first = 0; first < n; first += kBlock) {
        const std::size_t count = std::min(kBlock, n - first);
        float* block = values + first;
        for (std::size_t i = 0; i < count; ++i) {
            const auto place = TransferCurve::Table::find(low_bits, high_bits, shift, block[i]);
            index[i] = place.index;
            fraction[i] = place.fraction;
        }
        for (std::size_t i = 0; i < count; ++i)
            block[i] = TransferCurve::Table::blend(nodes, {index[i], fraction[i]}, block[i]);
    }
}
}  // namespace detail

float to_linear(Transfer transfer, float code) {
    const bool odd = transfer != Transfer::KodakLog && code < 0;
    const double value = to_linear_positive(transfer, odd ? -static_cast<double>(code) : static_cast<double>(code));
    return static_cast<float>(odd ? -value : value);
}

float from_linear(Transfer transfer, float linear) {
    const bool odd = transfer != Transfer::KodakLog && linear < 0;
    const double value =
        from_linear_positive(transfer, odd ? -static_cast<double>(linear) : static_cast<double>(linear));
    return static_cast<float>(odd ? -value : value);
}

std::string_view name_of(Transfer transfer) {
    switch (transfer) {
        case Transfer::Linear:
            return "linear";
        case Transfer::SRGB:
            return "srgb";
        case Transfer::BT709:
            return "bt709";
        case Transfer::Gamma22:
            return "gamma2.2";
        case Transfer::PQ:
            return "pq";
        case Transfer::HLG:
            return "hlg";
        case Transfer::KodakLog:
            return "kodaklog";
    }
    return "linear";
}

TransferCurve::TransferCurve(Transfer transfer) : transfer_(transfer) {
    for (int code = 0; code < 256; ++code)
        codes8_[static_cast<std::size_t>(code)] = eikonal::to_linear(transfer, static_cast<float>(code) / 255.0f);
    if (transfer == Transfer::Linear || transfer == Transfer::KodakLog) return;
    tabulated_ = true;
    // Codes below 2^-12 lie on the straight part of every curve that is steep there, or below half a code's step.
    to_ = tabulate(-20, 16, 10, [&](float x) { return eikonal::to_linear(transfer, x); });
    // For light, PQ and the pure powers need many nodes near zero.
    from_ = tabulate(-48, 17, 8, [&](float x) { return eikonal::from_linear(transfer, x); });
}

template <Transfer T>
const TransferCurve& TransferCurve::instance() {
    static const TransferCurve curve(T);
    return curve;
}

const TransferCurve& TransferCurve::of(Transfer transfer) {
    switch (transfer) {
        case Transfer::Linear:
            return instance<Transfer::Linear>();
        case Transfer::SRGB:
            return instance<Transfer::SRGB>();
        case Transfer::BT709:
            return instance<Transfer::BT709>();
        case Transfer::Gamma22:
            return instance<Transfer::Gamma22>();
        case Transfer::PQ:
            return instance<Transfer::PQ>();
        case Transfer::HLG:
            return instance<Transfer::HLG>();
        case Transfer::KodakLog:
            return instance<Transfer::KodakLog>();
    }
    return instance<Transfer::Linear>();
}

std::span<const float> TransferCurve::codes16() const {
    std::call_once(codes16_made_, [this] {
        codes16_.resize(65536);
        for (std::size_t code = 0; code < codes16_.size(); ++code)
            codes16_[code] = eikonal::to_linear(transfer_, static_cast<float>(code) / 65535.0f);
    });
    return codes16_;
}

void TransferCurve::to_linear(std::span<float> values) const {
    if (tabulated_)
        detail::apply_table(to_.nodes.data(), to_.low_bits, to_.high_bits, to_.shift, values.data(), values.size());
    else if (!linear())
        for (float& v : values) v = eikonal::to_linear(transfer_, v);
}

void TransferCurve::from_linear(std::span<float> values) const {
    if (tabulated_)
        detail::apply_table(from_.nodes.data(), from_.low_bits, from_.high_bits, from_.shift, values.data(),
                            values.size());
    else if (!linear())
        for (float& v : values) v = eikonal::from_linear(transfer_, v);
}

}  // namespace eikonal
