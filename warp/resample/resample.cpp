#include "warp/resample/resample.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <stdexcept>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "warp/resample/area.h"
#include "warp/resample/separable.h"

namespace eikonal {
namespace {

using namespace resampling;

/// Rows of one task. Neighbouring rows share source rows in the cache.
constexpr int task_rows = 16;

/// Floats in a cache line.
constexpr int line = 16;

/// Channels that share a displacement.
struct Group {
    float scale;
    std::array<bool, 4> has{};
};

struct Groups {
    std::array<Group, 4> group;
    int count = 0;
};

Groups group_channels(const std::array<float, 4>& scale, int channels) {
    Groups groups;
    for (int c = 0; c < channels; ++c) {
        int g = 0;
        while (g < groups.count && groups.group[g].scale != scale[c]) ++g;
        if (g == groups.count) groups.group[groups.count++] = {scale[c], {}};
        groups.group[g].has[c] = true;
    }
    return groups;
}

void check(const ImageView& in, const MapView& d, const MutableImageView& out) {
    const auto in_range = [](const Window& w) {
        return std::abs(std::int64_t{w.x0}) <= max_coordinate && std::abs(std::int64_t{w.y0}) <= max_coordinate &&
               w.width <= max_coordinate && w.height <= max_coordinate;
    };
    if (in.channels != out.channels || in.channels < 1 || in.channels > 4)
        throw std::invalid_argument("resample: input and output must both have 1 to 4 channels");
    if (d.window != out.window) throw std::invalid_argument("resample: the map's window must be the output's");
    if (in.window.width < 1 || in.window.height < 1) throw std::invalid_argument("resample: the input is empty");
    if (!in_range(in.window) || !in_range(out.window))
        throw std::invalid_argument("resample: a window lies beyond max_coordinate");
    if (!in.data || !d.data || !out.data) throw std::invalid_argument("resample: null pointer");
}

/// Output of this size [bytes] or more is written past the caches, where it would not stay anyway.
constexpr std::int64_t streaming_size = 1 << 23;

void store(const Pixel* pixels, int n, int channels, [[maybe_unused]] bool streaming, float* out) {
    if (channels == 4) {
#ifdef __SSE2__
        if (streaming && reinterpret_cast<std::uintptr_t>(out) % sizeof(Pixel) == 0) {
            for (int i = 0; i < n; ++i) _mm_stream_ps(out + 4 * i, pixels[i]);
            return;
        }
#endif
        std::memcpy(out, pixels, sizeof(Pixel) * static_cast<std::size_t>(n));
        return;
    }
    for (int i = 0; i < n; ++i)
        for (int c = 0; c < channels; ++c) out[i * channels + c] = pixels[i][c];
}

/// Orders streaming stores before anything that tells other threads that these rows are done.
void finish_stores() {
#ifdef __SSE2__
    _mm_sfence();
#endif
}

void store_group(const Pixel* pixels, int n, int channels, const std::array<bool, 4>& has, float* out) {
    for (int c = 0; c < channels; ++c)
        if (has[c])
            for (int i = 0; i < n; ++i) out[i * channels + c] = pixels[i][c];
}

}  // namespace

void resample(const ImageView& in, const MapView& d, const MutableImageView& out, const ResampleOptions& options) {
    if (out.window.width < 1 || out.window.height < 1) return;
    check(in, d, out);
    const Source source{in.data, in.stride, in.window.width, in.window.height, in.channels, options.edge};
    const Groups groups = group_channels(options.channel_scale, in.channels);
    const int left = out.window.x0 - in.window.x0, top = out.window.y0 - in.window.y0;

    const bool streaming =
        std::int64_t{out.window.width} * out.window.height * out.channels * std::int64_t{sizeof(float)} >=
        streaming_size;

    const auto do_span = [&](int x, int y, int n) {
        Span span;
        alignas(64) Pixel pixels[span_length];
        const float* displacement = d.data + y * d.stride + std::ptrdiff_t{2} * x;
        float* target = out.data + y * out.stride + std::ptrdiff_t{x} * out.channels;
        if (y + 1 < out.window.height)  // worth 3 % of the time
            for (int i = 0; i < 2 * n; i += line) __builtin_prefetch(displacement + d.stride + i, 0, 2);
        for (int g = 0; g < groups.count; ++g) {
            const Group& group = groups.group[g];
            prepare(displacement, n, left + x, top + y, group.scale, options.filter, source, span);
            if (options.filter == Filter::Area) {
                Footprints footprints;
                measure(d, n, x, y, group.scale, footprints);
                sample_area(source, span, footprints, left + x, top + y, pixels);
            } else {
                sample_separable(source, span, options.filter, pixels);
            }
            if (groups.count == 1)
                store(pixels, n, out.channels, streaming, target);
            else
                store_group(pixels, n, out.channels, group.has, target);
        }
    };
    tbb::parallel_for(tbb::blocked_range<int>(0, out.window.height, task_rows), [&](const auto& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y)
            for (int x = 0; x < out.window.width; x += span_length)
                do_span(x, y, std::min(span_length, out.window.width - x));
        finish_stores();
    });
}

std::optional<std::array<int, 2>> nearest_source(int x, int y, float dx, float dy, const Window& in_window, Edge edge) {
    sanitise(dx, dy);
    const int ix = split(dx), iy = split(dy);
    const int column = resolve(std::int64_t{x} + ix + (dx >= 0.5f) - in_window.x0, in_window.width, edge);
    const int row = resolve(std::int64_t{y} + iy + (dy >= 0.5f) - in_window.y0, in_window.height, edge);
    if (column < 0 || row < 0) return std::nullopt;
    return std::array{in_window.x0 + column, in_window.y0 + row};
}

}  // namespace eikonal
