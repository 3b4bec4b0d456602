/// Displacement of a band of image rows as a function of screen position *and* depth: what every model computes and
/// every way of meeting the depth buffer reads.
///
/// A model bends rays on a grid of nodes, `spacing` pixels apart, anchored at the display window's pixel (0, 0), and
/// records along each ray at axial depths z_0 < z_1 < … (PHYSICS.md#first-order)
///     X(z) = f_px · x1⊥(z)  [px·m]   and its slope  S(z) = dX/dz  [px],
/// so that the displacement of an object at axial depth z is d = X(z)/z (perspective) or d = X(z) (orthographic, where
/// f_px is pixels per metre and X in px). In image axes: x right, y down.
///
/// Between depths X is the cubic Hermite interpolant of (X, S), exact for screens, or linear where the model says so
/// (tables: the paper's suggestion). Between grid nodes it is a six-point Lagrange interpolant, exact for fifth-order
/// polynomials; at a spacing of 1 there is nothing to interpolate.
///
/// Beyond the last depth X continues along its last slope; before the first it rises from X(0) = 0 as z², as it does
/// within an eddy, or evenly where interpolation is linear. Finite
/// for every z > 0 that a float can hold, as long as the nodes are.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <vector>

#include "warp/displace/grid/shift.h"
#include "warp/displace/media/surface/mirage_row.h"
#include "warp/pixels/linear_image.h"

namespace eikonal {

/// a / b rounded down, b > 0: the cell of size b in which pixel a lies.
constexpr int floor_div(int a, int b) {
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}

enum class DepthInterpolation { Linear, Hermite };

/// Widest spacing of nodes in pixels, and the largest part of a field's cell that they may span.
inline constexpr int kWidestSpacing = 8;
inline constexpr double kCellsPerNode = 0.55;
/// Rms error of interpolation between nodes that leaves, relative to the rms of the map: 0.6 % for screens that resolve
/// l0 with three cells, and most where a pixel limits them, whose field is not smooth at its own cell.
/// (tests/displacement_test.cpp)
inline constexpr double kSpacingError = 0.011;
/// Largest power of two that keeps to both, for a field whose finest cell is `cell_px` pixels wide on the screen.
int node_spacing(double cell_px);

/// Nodes i - kTapsBefore … of the interpolant around position i + f, 0 <= f < 1, and their weights: six-point Lagrange.
inline constexpr int kTapsBefore = 2, kNodeTaps = 6;
std::array<float, kNodeTaps> lagrange_weights(double f);

/// X.x, X.y, S.x, S.y of one node at one depth; a SIMD register.
using Node = float __attribute__((vector_size(16)));

/// Nodes for a grid of rows. Layout [grid row][depth][grid column].
struct DisplacementGrid {
    int spacing = 1;  ///< pixels between nodes, >= 1
    int column0 = 0,
        row0 = 0;  ///< first node, in units of `spacing`: node (i, j) is the centre of pixel (i, j)·spacing
    int columns = 0, rows = 0;
    bool perspective = true;
    DepthInterpolation interpolation = DepthInterpolation::Linear;
    std::vector<double> depths;  ///< axial depth of each layer [m], ascending, > 0
    std::vector<Node> nodes;
    std::vector<std::array<float, 6>> weights;      ///< of the interpolant, for each phase 0 … spacing - 1
    std::vector<std::array<Node, 6>> pair_weights;  ///< the same of two phases at a time; none if the spacing is odd

    /// Sets the grid that interpolation needs for these (absolute) pixels, and zeroes the nodes. depths must be set.
    void cover(const PixelWindow& pixels);
    /// Nodes that interpolation takes before the one at or before a pixel.
    int before() const { return spacing > 1 ? kTapsBefore : 0; }
    std::size_t index(int grid_row, std::size_t depth, int column = 0) const {
        return (static_cast<std::size_t>(grid_row) * depths.size() + depth) * static_cast<std::size_t>(columns) +
               static_cast<std::size_t>(column);
    }
    Node* row(int grid_row, std::size_t depth) { return nodes.data() + index(grid_row, depth); }
    /// Multiplies the displacement.
    void scale(float gain);
    /// Largest component of d over the grid's nodes and layers, and in the limit far beyond them [px].
    float largest_shift() const;
};

/// One image row of a grid, ready for look-ups at any column and depth.
class GridRow {
  public:
    /// y: absolute pixel row inside the window that `grid` covers; the grid must outlive this.
    void start(const DisplacementGrid& grid, int y);

    /// Displacement of pixel column x (absolute) for an object at axial depth z > 0.
    Shift at(int x, double z);
    /// The same for every column of [x0, x0 + n) at one depth, added into interleaved (u, v). The fast path.
    void add_constant_depth(int x0, int n, double z, float* uv) const;

    /// The two layers around a depth z, and the weights of their (X, S) in d.
    struct Mix {
        double z;
        std::size_t lower, upper;
        float x_lower, s_lower, x_upper, s_upper;
    };

  private:
    const Mix& mix(double z);
    Node node(std::size_t depth, int x);

    const DisplacementGrid* grid_ = nullptr;
    std::array<Mix, 2> recent_;  ///< depths repeat along a row
    std::vector<Node> line_;     ///< the row interpolated vertically: [depth][column]
    const Node* source_ = nullptr;
    std::vector<Node> cached_;
    std::vector<int> cached_x_;
};

/// The rows of several grids (one a medium, each with depths of its own) and mirages whose displacements add up.
class GridRows {
  public:
    /// y: absolute pixel row that the grids cover. grids, mirages and air must outlive this. gain multiplies the
    /// mirages' displacement; the grids' nodes have theirs. air: what the grids do to the rays of one of the mirages;
    /// without it they and the mirages add up.
    void start(const std::vector<DisplacementGrid>& grids, int y, std::span<const Mirage> mirages = {}, double gain = 1,
               const MirageAir* air = nullptr) {
        rows_.resize(grids.size());
        for (std::size_t i = 0; i < grids.size(); ++i) rows_[i].start(grids[i], y);
        mirages_.resize(mirages.size());
        has_air_ = false;
        end_ = 0;
        for (std::size_t i = 0; i < mirages.size(); ++i) {
            const bool bent = air != nullptr && air->belongs_to(mirages[i]) && air->touches(y);
            has_air_ = has_air_ || bent;
            mirages_[i].start(mirages[i], y, gain, bent ? air : nullptr);
        }
    }
    Shift at(int x, double z) {
        Shift sum;
        const auto add = [&sum](Shift d) {
            sum.x += d.x;
            sum.y += d.y;
        };
        if (!carried(x))
            for (GridRow& row : rows_) add(row.at(x, z));
        for (MirageRow& row : mirages_) add(row.at(x, z));
        return sum;
    }
    void add_constant_depth(int x0, int n, double z, float* uv) {
        if (has_air_) {
            for (int i = 0; i < n; ++i) {
                const Shift d = at(x0 + i, z);
                uv[2 * i] += d.x;
                uv[2 * i + 1] += d.y;
            }
            return;
        }
        for (GridRow& row : rows_) row.add_constant_depth(x0, n, z, uv);
        for (MirageRow& row : mirages_) row.add_constant_depth(x0, n, z, uv);
    }

    /// Whether a mirage moves pixel x; and the axial depth where its ray ends on a surface [m], infinite if on none.
    bool mirage_moves(int x) {
        bool moves = false;
        for (MirageRow& row : mirages_) moves = row.moves(x) || moves;
        return moves;
    }
    double end(int x) {
        if (end_ > 0) return end_;
        double end = std::numeric_limits<double>::infinity();
        for (MirageRow& row : mirages_) end = std::min(end, row.end(x));
        return end;
    }

    /// Says end() from now on: of one pixel whose ray is better known.
    void end_at(double z) { end_ = z; }

  private:
    bool carried(int x) {
        if (has_air_)
            for (MirageRow& row : mirages_)
                if (row.carries_air(x)) return true;
        return false;
    }

    std::vector<GridRow> rows_;
    std::vector<MirageRow> mirages_;
    bool has_air_ = false;
    double end_ = 0;  ///< if > 0: what end() says
};

}  // namespace eikonal
