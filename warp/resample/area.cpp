#include "warp/resample/area.h"

#include <algorithm>
#include <cmath>

#include "noise/base/instruction_sets.h"
#include "warp/resample/separable.h"

namespace eikonal::resampling {
namespace {

#define EIKONAL_INLINE inline __attribute__((always_inline))

/// Displacements of a row, with one more pixel on either side.
struct Row {
    float u[span_length + 2], v[span_length + 2];
};

/// The row continues linearly beyond the map's window.
EIKONAL_INLINE void read_row(const MapView& d, int n, int x, int y, float scale, Row& row) {
    const float* p = d.data + y * d.stride + std::ptrdiff_t{2} * x;
    const int first = x > 0 ? -1 : 0, last = x + n < d.window.width ? n : n - 1;
    for (int i = first; i <= last; ++i) {
        float u = p[2 * i] * scale, v = p[2 * i + 1] * scale;
        sanitise(u, v);
        row.u[i + 1] = u;
        row.v[i + 1] = v;
    }
    const bool single = first == 0 && last == 0;
    if (first == 0) {
        row.u[0] = single ? row.u[1] : 2 * row.u[1] - row.u[2];
        row.v[0] = single ? row.v[1] : 2 * row.v[1] - row.v[2];
    }
    if (last == n - 1) {
        row.u[n + 1] = single ? row.u[n] : 2 * row.u[n] - row.u[n - 1];
        row.v[n + 1] = single ? row.v[n] : 2 * row.v[n] - row.v[n - 1];
    }
}

EIKONAL_INLINE void extrapolate(const Row& near, const Row& far, int n, Row& row) {
    for (int i = 0; i < n + 2; ++i) {
        row.u[i] = 2 * near.u[i] - far.u[i];
        row.v[i] = 2 * near.v[i] - far.v[i];
    }
}

/// Monotonised-central slope from the values before, at and after a pixel, within +-1e3 pixels a pixel.
EIKONAL_INLINE float slope(float before, float at, float after) {
    const float b = at - before, a = after - at;
    const float limit = 2 * std::min(std::abs(b), std::abs(a)), central = 0.5f * (after - before);
    const float bound = (b > 0) == (a > 0) ? std::min(limit, 1e3f) : 0.0f;
    return std::max(-bound, std::min(central, bound));
}

/// The coverage of cells by a polygon, summed over its edges. acc holds, for each cell of a row, the change of coverage
/// from the cell to its left.
constexpr int max_cells = 26;  // max_stretch sqrt(2) + 2 and one for the change after the last cell, rounded up
struct Coverage {
    float change[max_cells][max_cells];
};
static_assert(max_cells >= max_stretch * 1.4143f + 3);

/// Adds a piece of an edge within one row. It runs from xa to xb (xa <= xb) and spans the signed height h. In each cell
/// c that it crosses, the area to the right of the piece is added to acc of c. What is missing to full coverage is
/// added to acc of c + 1, since all later cells are covered fully.
void add_segment(float* change, float xa, float xb, float h) {
    const int first = static_cast<int>(xa), last = static_cast<int>(xb);
    if (first == last) {
        const float left = h * (0.5f * (xa + xb) - static_cast<float>(first));
        change[first] += h - left;
        change[first + 1] += left;
        return;
    }
    const float per_x = h / (xb - xa);
    for (int c = first; c <= last; ++c) {
        const float begin = std::max(xa, static_cast<float>(c)), end = std::min(xb, static_cast<float>(c + 1));
        const float part = per_x * (end - begin), left = part * (0.5f * (begin + end) - static_cast<float>(c));
        change[c] += part - left;
        change[c + 1] += left;
    }
}

/// Adds an edge. Downward edges count positive.
void add_edge(Coverage& coverage, float x0, float y0, float x1, float y1) {
    if (y0 == y1) return;
    const float sign = y0 < y1 ? 1.0f : -1.0f;
    if (y0 > y1) {
        std::swap(x0, x1);
        std::swap(y0, y1);
    }
    const float slope = (x1 - x0) / (y1 - y0);
    const float lowest = std::min(x0, x1), highest = std::max(x0, x1);
    float x = x0, y = y0;
    for (int row = static_cast<int>(y0); y < y1; ++row) {
        const float next_y = std::min(y1, static_cast<float>(row + 1));
        const float next_x = next_y == y1 ? x1 : std::max(lowest, std::min(x0 + slope * (next_y - y0), highest));
        add_segment(coverage.change[row], std::min(x, next_x), std::max(x, next_x), sign * (next_y - y));
        x = next_x;
        y = next_y;
    }
}

template <int channels>
Pixel sample_footprint(const Source& source, const Span& span, int i, float xx, float xy, float yy) {
    // Vertices: centre +- a +- b with a, b the halved columns of M, counted from the corner of the lowest cell.
    const float ax = 0.5f * xx, ay = 0.5f * xy, bx = ay, by = 0.5f * yy;
    const float extent_x = std::abs(ax) + std::abs(bx), extent_y = std::abs(ay) + std::abs(by);
    const float left = std::floor(0.5f + span.tx[i] - extent_x), top = std::floor(0.5f + span.ty[i] - extent_y);
    const float x = std::max(extent_x, 0.5f + span.tx[i] - left), y = std::max(extent_y, 0.5f + span.ty[i] - top);
    const int columns = static_cast<int>(x + extent_x) + 1, rows = static_cast<int>(y + extent_y) + 1;

    Coverage coverage;
    for (int r = 0; r < rows; ++r) std::fill_n(coverage.change[r], columns + 1, 0.0f);
    const float vx[4] = {x - ax - bx, x + ax - bx, x + ax + bx, x - ax + bx};
    const float vy[4] = {y - ay - by, y + ay - by, y + ay + by, y - ay + by};
    for (int k = 0; k < 4; ++k) {
        const int next = (k + 1) & 3;
        add_edge(coverage, std::max(0.0f, vx[next]), std::max(0.0f, vy[next]), std::max(0.0f, vx[k]),
                 std::max(0.0f, vy[k]));
    }

    int column[max_cells];
    const std::int64_t sx = std::int64_t{span.x[i]} + static_cast<int>(left);
    const std::int64_t sy = std::int64_t{span.y[i]} + static_cast<int>(top);
    for (int c = 0; c < columns; ++c) column[c] = resolve(sx + c, source.width, source.edge);
    const float per_area =
        1 / (xx * yy - xy * xy);  // the weights sum to 1 up to rounding, and the rest is added at the end
    Pixel sum{};
    float weights = 0;
    for (int r = 0; r < rows; ++r) {
        const int row = resolve(sy + r, source.height, source.edge);
        float covered = 0;
        for (int c = 0; c < columns; ++c) {
            covered += coverage.change[r][c];
            if (covered <= 0) continue;
            const float weight = covered * per_area;
            weights += weight;
            if (row >= 0 && column[c] >= 0) sum += load<channels>(source.at(column[c], row)) * weight;
        }
    }
    return sum / weights;
}

template <int channels>
void sample_span(const Source& source, const Span& span, const Footprints& m, int x, int y, Pixel* out) {
    for (int i = 0; i < span.n; ++i) {
        const bool rigid = m.xx[i] == 1 && m.xy[i] == 0 && m.yy[i] == 1;
        const bool unmoved = span.x[i] == x + i && span.y[i] == y && span.tx[i] == 0 && span.ty[i] == 0;
        out[i] = rigid || unmoved ? sample_bilinear(source, span, i)
                                  : sample_footprint<channels>(source, span, i, m.xx[i], m.xy[i], m.yy[i]);
    }
}

}  // namespace

EIKONAL_CLONES void measure(const MapView& d, int n, int x, int y, float scale, Footprints& footprints) {
    Row above, at, below;
    read_row(d, n, x, y, scale, at);
    const bool has_above = y > 0, has_below = y + 1 < d.window.height;
    if (has_above) read_row(d, n, x, y - 1, scale, above);
    if (has_below) read_row(d, n, x, y + 1, scale, below);
    if (!has_above) extrapolate(at, has_below ? below : at, n, above);
    if (!has_below) extrapolate(at, has_above ? above : at, n, below);

    for (int i = 0; i < n; ++i) {
        const float ux = 1 + slope(at.u[i], at.u[i + 1], at.u[i + 2]);
        const float vx = slope(at.v[i], at.v[i + 1], at.v[i + 2]);
        const float uy = slope(above.u[i + 1], at.u[i + 1], below.u[i + 1]);
        const float vy = 1 + slope(above.v[i + 1], at.v[i + 1], below.v[i + 1]);
        // J J^T = [a b; b c] with eigenvalues mean +- half. f(J J^T) = f(low) I + rise (J J^T - low I).
        const float a = ux * ux + uy * uy, b = ux * vx + uy * vy, c = vx * vx + vy * vy;
        const float mean = 0.5f * (a + c), difference = 0.5f * (a - c);
        const float half = std::sqrt(difference * difference + b * b);
        const float low = std::max(mean - half, 0.0f), high = mean + half;
        const float f_low = std::max(1.0f, std::min(std::sqrt(low), max_stretch));
        const float f_high = std::max(1.0f, std::min(std::sqrt(high), max_stretch));
        const float rise = half > 0 ? (f_high - f_low) / (high - low) : 0.0f;
        const bool rigid = high <= 1 + 1e-6f;
        footprints.xx[i] = rigid ? 1.0f : f_low + rise * (a - low);
        footprints.xy[i] = rigid ? 0.0f : rise * b;
        footprints.yy[i] = rigid ? 1.0f : f_low + rise * (c - low);
    }
}

void sample_area(const Source& source, const Span& span, const Footprints& footprints, int x, int y, Pixel* out) {
    switch (source.channels) {
        case 1:
            return sample_span<1>(source, span, footprints, x, y, out);
        case 2:
            return sample_span<2>(source, span, footprints, x, y, out);
        case 3:
            return sample_span<3>(source, span, footprints, x, y, out);
        default:
            return sample_span<4>(source, span, footprints, x, y, out);
    }
}

}  // namespace eikonal::resampling
