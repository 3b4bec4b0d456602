/// Displacement as a function of pixel *and* depth. Every model computes it, and every depth meeting reads it.
///
/// A model bends rays on a grid of nodes. The nodes are `spacing` pixels apart, and node (0, 0) is the display window's
/// pixel (0, 0). Along each node's ray the model records, at axial depths z_0 < z_1 < … (PHYSICS.md#first-order),
///     X(z) = f_px · x1⊥(z)  [px·m]   and its slope  S(z) = dX/dz  [px].
/// The displacement of an object at axial depth z is d = X(z)/z in a perspective view. In an orthographic view it is
/// d = X(z), where f_px is in pixels per metre and X in px. Image axes: x to the right, y downwards.
///
/// Between depths, X is the cubic Hermite interpolant of (X, S), which is exact for screens. Models that work with
/// tables choose linear interpolation, as the paper suggests. Beyond the last depth X continues along its last slope.
/// Before the first depth X rises from X(0) = 0: as z², as it does within an eddy, or as z where interpolation is
/// linear.
///
/// Between nodes, X and S are six-point Lagrange interpolants (lagrange.h). At a spacing of 1 none are needed.
///
/// If the nodes are finite, displacements are finite for every z > 0 that a float can hold.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <vector>

#include "warp/displace/grid/lagrange.h"
#include "warp/displace/grid/row_bender.h"
#include "warp/displace/grid/shift.h"
#include "warp/pixels/linear_image.h"

namespace eikonal {

/// a / b rounded down, b > 0: the cell of size b in which pixel a lies.
constexpr int floor_div(int a, int b) {
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}

enum class DepthInterpolation { Linear, Hermite };

/// Widest spacing of nodes [px].
inline constexpr int kWidestSpacing = 8;
/// Largest spacing of nodes, as a part of the finest cell of a field.
inline constexpr double kCellsPerNode = 0.55;
/// Rms error of the interpolation between nodes at that spacing, relative to the rms of the map. It is largest where a
/// pixel limits the cells of screens, whose field is not smooth at its own cell. Screens that resolve l0 with three
/// cells have an error of 0.6 %. (tests/warp/displace/displacement_test.cpp)
inline constexpr double kSpacingError = 0.011;
/// The largest power of two within both limits, for a field whose finest cell is `cell_px` pixels wide on the screen.
int node_spacing(double cell_px);

/// X.x, X.y, S.x, S.y of one node at one depth, in one SIMD register.
using Node = float __attribute__((vector_size(16)));

/// A place in the picture between the nodes of a grid, for DisplacementGrid::at().
struct GridPlace {
    std::array<std::size_t, kLagrangeNodes> columns{}, rows{};  ///< of the grid's nodes around it
    LagrangeWeights column_weights{}, row_weights{};
};

/// The nodes of a window of pixels. Layout [grid row][depth][grid column].
struct DisplacementGrid {
    int spacing = 1;            ///< pixels between nodes, >= 1
    int column0 = 0, row0 = 0;  ///< first node: node (i, j) is the centre of pixel (i · spacing, j · spacing)
    int columns = 0, rows = 0;
    bool perspective = true;
    DepthInterpolation interpolation = DepthInterpolation::Linear;
    std::vector<double> depths;  ///< axial depths [m], ascending, > 0
    std::vector<Node> nodes;
    std::vector<LagrangeWeights> weights;                        ///< at each pixel between two nodes: `spacing` of them
    std::vector<std::array<Node, kLagrangeNodes>> pair_weights;  ///< of two pixels at a time; none if spacing is odd

    /// Makes room for the nodes that these (absolute) pixels need, and sets all nodes to zero. `depths` must be set.
    void cover(const PixelWindow& pixels);
    /// Number of nodes that a pixel needs before the last node at or before the pixel.
    int nodes_before() const { return spacing > 1 ? kNodesBefore : 0; }
    std::size_t index(int grid_row, std::size_t depth, int column = 0) const {
        return (static_cast<std::size_t>(grid_row) * depths.size() + depth) * static_cast<std::size_t>(columns) +
               static_cast<std::size_t>(column);
    }
    Node* row(int grid_row, std::size_t depth) { return nodes.data() + index(grid_row, depth); }
    /// Multiplies the displacement by a gain.
    void scale(float gain);
    /// Largest component of d over nodes, depths, and all that lies beyond the last depth [px].
    float largest_shift() const;

    /// The place of pixel position (x, y), which need not be whole and counts pixel centres: pixel i's centre is at i.
    /// Outside of the grid the nodes of its border continue.
    GridPlace place(double x, double y) const;
    /// X and S at a place, at depths[depth].
    Node at(const GridPlace& place, std::size_t depth) const;
};

/// One pixel row of a grid, ready to be looked up at any column and depth.
class GridRow {
  public:
    /// y: absolute pixel row of the window that `grid` covers. The grid must outlive this.
    void start(const DisplacementGrid& grid, int y);

    /// Displacement of pixel column x (absolute) for an object at axial depth z > 0.
    Shift at(int x, double z);
    /// Adds the displacements of the columns [x0, x0 + n), all at one depth, to interleaved (u, v). This is the fast
    /// path: it agrees with at() but for rounding.
    void add_constant_depth(int x0, int n, double z, float* uv) const;

    /// The two depths of the grid around a depth z, and the weights that their X and S have in d.
    struct DepthWeights {
        double z;
        std::size_t lower, upper;
        float x_lower, s_lower, x_upper, s_upper;
    };

  private:
    const DepthWeights& depth_weights(double z);
    Node node(std::size_t depth, int x);

    const DisplacementGrid* grid_ = nullptr;
    std::array<DepthWeights, 2> last_used_;  ///< depths repeat along a row
    std::vector<Node> line_;                 ///< the row, interpolated vertically: [depth][column]
    const Node* source_ = nullptr;           ///< line_, or the grid's own row of nodes
    std::vector<Node> cached_;               ///< last node() of each depth
    std::vector<int> cached_x_;              ///< its pixel column
};

/// One pixel row of everything that bends rays. It adds the displacements of the grids, each of which has its own
/// depths, and of the benders.
class GridRows {
  public:
    /// Goes to pixel row y (absolute), which the grids cover. Grids and benders must outlive this.
    void start(const std::vector<DisplacementGrid>& grids, int y, std::span<RowBender* const> benders = {});

    /// Displacement of pixel column x (absolute) for an object at axial depth z > 0.
    Shift at(int x, double z) {
        Shift sum;
        const auto add = [&sum](Shift d) {
            sum.x += d.x;
            sum.y += d.y;
        };
        if (!(may_contain_grids_ && bender_contains_grids(x)))
            for (GridRow& row : rows_) add(row.at(x, z));
        for (RowBender* bender : benders_) add(bender->at(x, z));
        return sum;
    }
    /// Adds the displacements of the columns [x0, x0 + n), all at one depth, to interleaved (u, v).
    void add_constant_depth(int x0, int n, double z, float* uv);

    /// Whether a bender moves pixel x.
    bool bender_moves(int x) {
        bool moves = false;
        for (RowBender* bender : benders_) moves = bender->moves(x) || moves;
        return moves;
    }
    /// Axial depth where the ray of pixel x ends on a surface [m]; infinite if it ends on none.
    double ray_end(int x) {
        double end = std::numeric_limits<double>::infinity();
        for (RowBender* bender : benders_) end = std::min(end, bender->ray_end(x));
        return end;
    }

  private:
    bool bender_contains_grids(int x);

    std::vector<GridRow> rows_;
    std::span<RowBender* const> benders_;
    bool may_contain_grids_ = false;  ///< any of the benders, in this row
};

}  // namespace eikonal
