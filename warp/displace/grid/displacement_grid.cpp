#include "warp/displace/grid/displacement_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "noise/base/instruction_sets.h"

namespace eikonal {
namespace {

Node splat(float a) {
    return Node{a, a, a, a};
}

EIKONAL_CLONES void weighted_lines(const Node* in, std::size_t stride, std::size_t n, const LagrangeWeights& w,
                                   Node* out) {
    for (std::size_t i = 0; i < n; ++i) out[i] = weighted_sum(w, [&](std::size_t row) { return in[i + row * stride]; });
}

/// Interpolates along a line. first: the first of the six nodes.
template <class Weight>
[[gnu::always_inline]] inline Node interpolated(const std::array<Weight, kLagrangeNodes>& w, const Node* first) {
    return weighted_sum(w, [first](std::size_t i) { return first[i]; });
}

using DepthWeights = GridRow::DepthWeights;

DepthWeights depth_weights_at(const DisplacementGrid& grid, double z) {
    const auto& depths = grid.depths;
    const std::size_t last = depths.size() - 1;
    const double scale = grid.perspective ? 1 / z : 1.0;
    const auto scaled = [&](double v) { return static_cast<float>(v * scale); };
    if (z < depths.front() && grid.interpolation == DepthInterpolation::Hermite) {
        const double part = z / depths[0];  // X ∝ z²
        return {z, 0, 0, static_cast<float>(grid.perspective ? part / depths[0] : part * part), 0, 0, 0};
    }
    if (z <= depths.front())
        return {z, 0, 0, grid.perspective ? static_cast<float>(1 / depths[0]) : static_cast<float>(z / depths[0]),
                0, 0, 0};
    if (z >= depths[last]) return {z, last, last, scaled(1), scaled(z - depths[last]), 0, 0};
    const auto upper = static_cast<std::size_t>(std::upper_bound(depths.begin(), depths.end(), z) - depths.begin());
    const std::size_t lower = upper - 1;
    const double length = depths[upper] - depths[lower];
    const double t = (z - depths[lower]) / length;
    if (grid.interpolation == DepthInterpolation::Linear) return {z, lower, upper, scaled(1 - t), 0, scaled(t), 0};
    const double t2 = t * t, t3 = t2 * t;
    return {z,
            lower,
            upper,
            scaled(2 * t3 - 3 * t2 + 1),
            scaled((t3 - 2 * t2 + t) * length),
            scaled(-2 * t3 + 3 * t2),
            scaled((t3 - t2) * length)};
}

}  // namespace

int node_spacing(double cell_px) {
    const double widest = std::min(kCellsPerNode * cell_px, static_cast<double>(kWidestSpacing));
    int spacing = 1;
    while (2 * spacing <= widest) spacing *= 2;
    return spacing;
}

void DisplacementGrid::scale(float gain) {
    if (gain == 1) return;
    for (Node& node : nodes) node *= splat(gain);
}

void DisplacementGrid::cover(const PixelWindow& pixels) {
    const int taps = spacing > 1 ? kLagrangeNodes : 1;
    column0 = floor_div(pixels.x0, spacing) - nodes_before();
    row0 = floor_div(pixels.y0, spacing) - nodes_before();
    columns = floor_div(pixels.x0 + pixels.width - 1, spacing) - nodes_before() + taps - column0;
    rows = floor_div(pixels.y0 + pixels.height - 1, spacing) - nodes_before() + taps - row0;
    weights = lagrange_phases(spacing);
    pair_weights.clear();
    for (std::size_t p = 0; spacing % 2 == 0 && p < weights.size(); p += 2) {
        auto& pair = pair_weights.emplace_back();
        for (std::size_t tap = 0; tap < kLagrangeNodes; ++tap)
            pair[tap] = Node{weights[p][tap], weights[p][tap], weights[p + 1][tap], weights[p + 1][tap]};
    }
    nodes.assign(static_cast<std::size_t>(rows) * depths.size() * static_cast<std::size_t>(columns), Node{});
}

namespace {

/// Largest |X| and |S| of a line of nodes.
EIKONAL_CLONES void largest_of(const Node* nodes, int n, float* x, float* s) {
    Node most{};
    for (int i = 0; i < n; ++i) {
        const Node v = nodes[i], magnitude = v < 0 ? -v : v;
        most = magnitude > most ? magnitude : most;
    }
    *x = std::max(most[0], most[1]);
    *s = std::max(most[2], most[3]);
}

}  // namespace

float DisplacementGrid::largest_shift() const {
    float largest = 0;
    for (int r = 0; r < rows; ++r)
        for (std::size_t k = 0; k < depths.size(); ++k) {
            float x, s;
            largest_of(nodes.data() + index(r, k), columns, &x, &s);
            largest = std::max(largest, x * static_cast<float>(perspective ? 1 / depths[k] : 1.0));
            if (perspective && k + 1 == depths.size()) largest = std::max(largest, s);
        }
    return largest;
}

GridPlace DisplacementGrid::place(double x, double y) const {
    GridPlace place;
    const double gx = x / spacing, gy = y / spacing;
    const int cx = static_cast<int>(std::floor(gx)), cy = static_cast<int>(std::floor(gy));
    for (int i = 0; i < kLagrangeNodes; ++i) {
        const int column = std::clamp(cx + i - kNodesBefore - column0, 0, columns - 1);
        const int row = std::clamp(cy + i - kNodesBefore - row0, 0, rows - 1);
        place.columns[static_cast<std::size_t>(i)] = static_cast<std::size_t>(column);
        place.rows[static_cast<std::size_t>(i)] = static_cast<std::size_t>(row);
    }
    place.column_weights = tabulated_lagrange_weights(gx - cx);
    place.row_weights = tabulated_lagrange_weights(gy - cy);
    return place;
}

Node DisplacementGrid::at(const GridPlace& place, std::size_t depth) const {
    return weighted_sum(place.row_weights, [&](std::size_t j) {
        const Node* line = nodes.data() + index(static_cast<int>(place.rows[j]), depth);
        return weighted_sum(place.column_weights, [&](std::size_t i) { return line[place.columns[i]]; });
    });
}

void GridRow::start(const DisplacementGrid& grid, int y) {
    grid_ = &grid;
    const int base = floor_div(y, grid.spacing);
    const int phase = y - base * grid.spacing;
    const int grid_row = base - grid.nodes_before() - grid.row0;
    const std::size_t line = grid.depths.size() * static_cast<std::size_t>(grid.columns);
    if (phase == 0) {
        source_ = grid.nodes.data() + grid.index(base - grid.row0, 0);
    } else {
        line_.resize(line);
        weighted_lines(grid.nodes.data() + grid.index(grid_row, 0), line, line,
                       grid.weights[static_cast<std::size_t>(phase)], line_.data());
        source_ = line_.data();
    }
    last_used_[0] = last_used_[1] = depth_weights_at(grid, grid.depths[0]);
    cached_.resize(grid.depths.size());
    cached_x_.assign(grid.depths.size(), std::numeric_limits<int>::min());
}

const DepthWeights& GridRow::depth_weights(double z) {
    if (last_used_[0].z != z) {
        if (last_used_[1].z != z) last_used_[1] = depth_weights_at(*grid_, z);
        std::swap(last_used_[0], last_used_[1]);
    }
    return last_used_[0];
}

Node GridRow::node(std::size_t depth, int x) {
    const Node* line = source_ + depth * static_cast<std::size_t>(grid_->columns) - grid_->column0;
    if (grid_->spacing == 1) return line[x];
    if (cached_x_[depth] == x) return cached_[depth];
    const int base = floor_div(x, grid_->spacing);
    const int phase = x - base * grid_->spacing;
    const Node* p = line + base - kNodesBefore;
    const Node v = interpolated(grid_->weights[static_cast<std::size_t>(phase)], p);
    cached_[depth] = v;
    cached_x_[depth] = x;
    return v;
}

Shift GridRow::at(int x, double z) {
    const DepthWeights& m = depth_weights(z);
    const Node a = node(m.lower, x);
    Shift d{m.x_lower * a[0] + m.s_lower * a[2], m.x_lower * a[1] + m.s_lower * a[3]};
    if (m.upper != m.lower) {
        const Node b = node(m.upper, x);
        d.x += m.x_upper * b[0] + m.s_upper * b[2];
        d.y += m.x_upper * b[1] + m.s_upper * b[3];
    }
    return d;
}

namespace {

EIKONAL_CLONES void mix_line(const Node* lower, const Node* upper, const DepthWeights& m, int n, Node* out) {
    const Node wl{m.x_lower, m.x_lower, m.s_lower, m.s_lower}, wu{m.x_upper, m.x_upper, m.s_upper, m.s_upper};
    for (int i = 0; i < n; ++i) {
        const Node v = wl * lower[i] + wu * upper[i];
        const float x = v[0] + v[2], y = v[1] + v[3];
        out[i] = Node{x, y, x, y};
    }
}

EIKONAL_CLONES void add_mixed(const Node* lower, const Node* upper, const DepthWeights& m, int n, float* uv) {
    const Node wl{m.x_lower, m.x_lower, m.s_lower, m.s_lower}, wu{m.x_upper, m.x_upper, m.s_upper, m.s_upper};
    for (int i = 0; i < n; ++i) {
        const Node v = wl * lower[i] + wu * upper[i];
        uv[2 * i] += v[0] + v[2];
        uv[2 * i + 1] += v[1] + v[3];
    }
}

/// Interpolates a line of nodes, each (u, v, u, v), and adds it to n pixels of interleaved (u, v). The first pixel lies
/// first_phase pixels after the node line[kNodesBefore]. Between two nodes an even spacing takes two pixels at a time.
EIKONAL_CLONES void expand_line(const Node* line, int first_phase, int spacing, const LagrangeWeights* weights,
                                const std::array<Node, kLagrangeNodes>* pairs, int n, float* uv) {
    int phase = first_phase;
    const Node* p = line;
    for (int i = 0; i < n;) {
        if (phase == 0 && pairs && i + spacing <= n) {
            for (int k = 0; k < spacing; k += 2) {
                const Node v = interpolated(pairs[k / 2], p);
                for (int c = 0; c < 4; ++c) uv[2 * (i + k) + c] += v[c];
            }
            i += spacing;
            ++p;
            continue;
        }
        const Node v = interpolated(weights[phase], p);
        uv[2 * i] += v[0];
        uv[2 * i + 1] += v[1];
        ++i;
        if (++phase == spacing) {
            phase = 0;
            ++p;
        }
    }
}

}  // namespace

void GridRow::add_constant_depth(int x0, int n, double z, float* uv) const {
    const DisplacementGrid& grid = *grid_;
    const DepthWeights m = depth_weights_at(grid, z);
    const auto columns = static_cast<std::size_t>(grid.columns);
    const Node *lower = source_ + m.lower * columns, *upper = source_ + m.upper * columns;
    const int base = floor_div(x0, grid.spacing), first = base - grid.nodes_before() - grid.column0;
    if (grid.spacing == 1) {
        add_mixed(lower + first, upper + first, m, n, uv);
        return;
    }
    std::vector<Node> line(columns);
    mix_line(lower, upper, m, grid.columns, line.data());
    expand_line(line.data() + first, x0 - base * grid.spacing, grid.spacing, grid.weights.data(),
                grid.pair_weights.empty() ? nullptr : grid.pair_weights.data(), n, uv);
}

void GridRows::start(const std::vector<DisplacementGrid>& grids, int y, std::span<RowBender* const> benders) {
    rows_.resize(grids.size());
    for (std::size_t i = 0; i < grids.size(); ++i) rows_[i].start(grids[i], y);
    benders_ = benders;
    may_contain_grids_ = false;
    for (RowBender* bender : benders_) {
        bender->start_row(y);
        may_contain_grids_ = may_contain_grids_ || bender->row_may_contain_grids();
    }
}

bool GridRows::bender_contains_grids(int x) {
    return std::any_of(benders_.begin(), benders_.end(), [x](RowBender* bender) { return bender->contains_grids(x); });
}

void GridRows::add_constant_depth(int x0, int n, double z, float* uv) {
    const auto add_each = [&](const auto& at) {
        for (int i = 0; i < n; ++i) {
            const Shift d = at(x0 + i);
            uv[2 * i] += d.x;
            uv[2 * i + 1] += d.y;
        }
    };
    if (may_contain_grids_) {
        add_each([&](int x) { return at(x, z); });
        return;
    }
    for (GridRow& row : rows_) row.add_constant_depth(x0, n, z, uv);
    for (RowBender* bender : benders_) add_each([&](int x) { return bender->at(x, z); });
}

}  // namespace eikonal
