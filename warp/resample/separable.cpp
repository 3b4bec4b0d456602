#include "warp/resample/separable.h"

#include "noise/base/instruction_sets.h"

namespace eikonal::resampling {
namespace {

#define EIKONAL_INLINE inline __attribute__((always_inline))

Pixel load_any(const Source& source, int x, int y) {
    if (x < 0 || y < 0) return Pixel{};  // Edge::Black
    const float* p = source.at(x, y);
    switch (source.channels) {
        case 1:
            return load<1>(p);
        case 2:
            return load<2>(p);
        case 3:
            return load<3>(p);
        default:
            return load<4>(p);
    }
}

/// The sum of w[k] p[k] in the order of k. All paths must round alike: first along columns, then along the row.
template <int taps>
EIKONAL_INLINE Pixel weigh(const Pixel* p, const float (*w)[span_length], int i) {
    Pixel sum = p[0] * w[0][i];
    for (int k = 1; k < taps; ++k) sum += p[k] * w[k][i];
    return sum;
}

/// How far a filter may fall below its four nearest samples. 0 for Bilinear, which never does.
template <int taps>
constexpr float kUndershoot = taps == 4 ? cubic_undershoot : lanczos3_undershoot;

EIKONAL_INLINE Pixel smaller(Pixel a, Pixel b) {
    return a < b ? a : b;
}

/// Keeps the negative lobes of a highlight from drawing a black ring. NaN passes.
template <int taps>
EIKONAL_INLINE Pixel limit_undershoot(Pixel value, Pixel nearest) {
    const Pixel low = nearest - kUndershoot<taps>;
    return value < low ? low : value;
}

/// Filters any pixel. Samples outside follow the edge mode. An axis with an integer displacement is not filtered.
template <int taps>
Pixel sample_careful(const Source& source, const Span& span, int i) {
    constexpr int before = taps / 2 - 1;
    const bool still_x = span.tx[i] == 0, still_y = span.ty[i] == 0;
    const int nx = still_x ? 1 : taps, ny = still_y ? 1 : taps;
    const std::int64_t x = span.x[i] - (still_x ? 0 : before), y = span.y[i] - (still_y ? 0 : before);
    int row[taps];
    for (int j = 0; j < ny; ++j) row[j] = resolve(y + j, source.height, source.edge);
    Pixel columns[taps], samples[taps], nearest[taps];
    for (int k = 0; k < nx; ++k) {
        const int column = resolve(x + k, source.width, source.edge);
        for (int j = 0; j < ny; ++j) samples[j] = load_any(source, column, row[j]);
        columns[k] = still_y ? samples[0] : weigh<taps>(samples, span.wy, i);
        nearest[k] = still_y ? samples[0] : smaller(samples[before], samples[before + 1]);
    }
    if (still_x && still_y) return columns[0];
    const Pixel value = still_x ? columns[0] : weigh<taps>(columns, span.wx, i);
    if constexpr (taps == 2) return value;
    return limit_undershoot<taps>(value, still_x ? nearest[0] : smaller(nearest[before], nearest[before + 1]));
}

/// Two neighbouring pixels of four channels.
using Pair = float __attribute__((vector_size(32)));

/// Filters a pixel whose samples all lie inside and whose fractions are not zero.
template <int taps, int channels>
EIKONAL_INLINE Pixel sample_inside(const Source& source, const Span& span, int i) {
    constexpr int before = taps / 2 - 1;
    const float* corner = source.at(span.x[i] - before, span.y[i] - before, channels);
    Pixel columns[taps];
    if constexpr (channels == 4) {
#pragma GCC unroll 3
        for (int k = 0; k < taps; k += 2) {
            Pair sum, pair;
            std::memcpy(&pair, corner + 4 * k, sizeof pair);
            sum = pair * span.wy[0][i];
#pragma GCC unroll 6
            for (int j = 1; j < taps; ++j) {
                std::memcpy(&pair, corner + j * source.stride + 4 * k, sizeof pair);
                sum += pair * span.wy[j][i];
            }
            columns[k] = __builtin_shufflevector(sum, sum, 0, 1, 2, 3);
            columns[k + 1] = __builtin_shufflevector(sum, sum, 4, 5, 6, 7);
        }
    } else {
        for (int k = 0; k < taps; ++k) {
            Pixel samples[taps];
            for (int j = 0; j < taps; ++j) samples[j] = load<channels>(corner + j * source.stride + k * channels);
            columns[k] = weigh<taps>(samples, span.wy, i);
        }
    }
    const Pixel value = weigh<taps>(columns, span.wx, i);
    if constexpr (taps == 2) return value;
    const float* inner = source.at(span.x[i], span.y[i], channels);
    const Pixel nearest =
        smaller(smaller(load<channels>(inner), load<channels>(inner + source.stride)),
                smaller(load<channels>(inner + channels), load<channels>(inner + source.stride + channels)));
    return limit_undershoot<taps>(value, nearest);
}

template <int taps, int channels>
EIKONAL_INLINE void sample_span(const Source& source, const Span& span, Pixel* out) {
    if (span.interior && span.fractional) {
        for (int i = 0; i < span.n; ++i) out[i] = sample_inside<taps, channels>(source, span, i);
        return;
    }
    constexpr int before = taps / 2 - 1, after = taps / 2;
    for (int i = 0; i < span.n; ++i) {
        const int x = span.x[i], y = span.y[i];
        const bool inside = x >= before && x < source.width - after && y >= before && y < source.height - after;
        if (inside && span.tx[i] != 0 && span.ty[i] != 0)
            out[i] = sample_inside<taps, channels>(source, span, i);
        else
            out[i] = sample_careful<taps>(source, span, i);
    }
}

template <int taps>
EIKONAL_INLINE void sample_channels(const Source& source, const Span& span, Pixel* out) {
    switch (source.channels) {
        case 1:
            return sample_span<taps, 1>(source, span, out);
        case 2:
            return sample_span<taps, 2>(source, span, out);
        case 3:
            return sample_span<taps, 3>(source, span, out);
        default:
            return sample_span<taps, 4>(source, span, out);
    }
}

}  // namespace

EIKONAL_CLONES void sample_2(const Source& source, const Span& span, Pixel* out) {
    sample_channels<2>(source, span, out);
}
EIKONAL_CLONES void sample_4(const Source& source, const Span& span, Pixel* out) {
    sample_channels<4>(source, span, out);
}
EIKONAL_CLONES void sample_6(const Source& source, const Span& span, Pixel* out) {
    sample_channels<6>(source, span, out);
}

void sample_separable(const Source& source, const Span& span, Filter filter, Pixel* out) {
    switch (taps_of(filter)) {
        case 2:
            return sample_2(source, span, out);
        case 4:
            return sample_4(source, span, out);
        default:
            return sample_6(source, span, out);
    }
}

Pixel sample_bilinear(const Source& source, const Span& span, int i) {
    return sample_careful<2>(source, span, i);
}

}  // namespace eikonal::resampling
