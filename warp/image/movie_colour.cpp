#include "warp/image/movie_colour.h"

#include <array>

namespace eikonal {

namespace {

/// Coefficients kr and kb of H.273's matrices.
std::array<double, 2> luma_weights(const MovieFormat& format) {
    constexpr std::array<double, 2> bt709{0.2126, 0.0722}, bt601{0.299, 0.114};
    switch (format.matrix) {
        case 1:
            return bt709;
        case 4:
            return {0.30, 0.11};
        case 5:
        case 6:
            return bt601;
        case 7:
            return {0.212, 0.087};
        case 9:
        case 10:
            return {0.2627, 0.0593};
        default:
            return format.width >= 1280 || format.height > 576 ? bt709 : bt601;
    }
}

std::vector<float> reduction_taps(int log2_ratio, int position, bool smooth, int& first) {
    if (log2_ratio == 0) {
        first = 0;
        return {1.0F};
    }
    if (log2_ratio == 2) {
        if (position != -1 || smooth) {
            first = 0;
            return {0.25F, 0.25F, 0.25F, 0.25F};
        }
        // The cosited inverse of ratio 2, applied twice.
        int inner = 0;
        const std::vector<float> half = reduction_taps(1, -1, false, inner);
        std::vector<float> taps(3 * (half.size() - 1) + 1, 0.0F);
        for (std::size_t i = 0; i < half.size(); ++i)
            for (std::size_t j = 0; j < half.size(); ++j) taps[2 * i + j] += half[i] * half[j];
        first = 3 * inner;
        return taps;
    }
    if (position == 0) {
        first = -1;
        return smooth ? std::vector<float>{0.125F, 0.375F, 0.375F, 0.125F}
                      : std::vector<float>{-0.25F, 0.75F, 0.75F, -0.25F};
    }
    const int centre = position < 0 ? 0 : 1;
    first = centre - (smooth ? 1 : 2);
    return smooth ? std::vector<float>{0.25F, 0.5F, 0.25F} : std::vector<float>{-0.125F, 0.25F, 0.75F, 0.25F, -0.125F};
}

}  // namespace

const TransferCurve& tone_curve(int transfer) {
    switch (transfer) {
        case 4:
        case 5:
        case 17:
            return TransferCurve::of(Transfer::Gamma22);
        case 8:
            return TransferCurve::of(Transfer::Linear);
        case 13:
            return TransferCurve::of(Transfer::SRGB);
        case 16:
            return TransferCurve::of(Transfer::PQ);
        case 18:
            return TransferCurve::of(Transfer::HLG);
        default:
            return TransferCurve::of(Transfer::BT709);
    }
}

CodeScale::CodeScale(const MovieFormat& format) {
    const bool limited =
        format.range == CodeRange::Limited || (format.range == CodeRange::Unspecified && !format.rgb && !format.gray);
    const auto unit = static_cast<float>(1 << (format.depth - 8));
    const auto largest = static_cast<float>((1 << format.depth) - 1);
    luma_offset = limited ? 16 * unit : 0;
    luma_scale = limited ? 219 * unit : largest;
    chroma_offset = 128 * unit;
    chroma_scale = limited ? 224 * unit : largest;
    alpha_scale = largest;
    const auto [r, b] = luma_weights(format);
    kr = static_cast<float>(r);
    kb = static_cast<float>(b);
    kg = static_cast<float>(1 - r - b);
}

ChromaFilter::ChromaFilter(int log2_ratio, int position, bool smooth) : log2_ratio_(log2_ratio), position_(position) {
    taps_ = reduction_taps(log2_ratio, position, smooth, first_);
}

ChromaFilter::Position ChromaFilter::enlarge(int x) const {
    if (log2_ratio_ == 0) return {x, 0.0F};
    // In units of half luma pixels, the sample lies at `offset` within its cell of 2 * ratio.
    const int ratio = 1 << log2_ratio_;
    const int offset = (position_ + 1) * (ratio - 1);
    const int steps = 2 * x - offset;
    const int index = steps >> (log2_ratio_ + 1);
    return {index, static_cast<float>(steps - index * 2 * ratio) / static_cast<float>(2 * ratio)};
}

ChromaFilter horizontal_filter(const MovieFormat& format, bool smooth) {
    const bool centred = format.siting == ChromaSiting::Center || format.siting == ChromaSiting::Top ||
                         format.siting == ChromaSiting::Bottom;
    return {format.log2_chroma_w, centred ? 0 : -1, smooth};
}

ChromaFilter vertical_filter(const MovieFormat& format, bool smooth) {
    int position = 0;
    if (format.siting == ChromaSiting::TopLeft || format.siting == ChromaSiting::Top) position = -1;
    if (format.siting == ChromaSiting::BottomLeft || format.siting == ChromaSiting::Bottom) position = 1;
    return {format.log2_chroma_h, position, smooth};
}

}  // namespace eikonal
