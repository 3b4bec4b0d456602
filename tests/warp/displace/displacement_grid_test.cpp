// Displacement grids: interpolation between nodes and depths, and beyond the last.
#include "warp/displace/grid/displacement_grid.h"

#include <gtest/gtest.h>

#include <cmath>

namespace eikonal {
namespace {

/// A smooth X of pixel position and depth, and its slope in depth: cubic in z, of `degree` in x and y.
Node synthetic(double x, double y, double z, int degree) {
    const double u = x / 40, v = y / 40;
    const double a = std::pow(u, degree) - 0.7 * std::pow(v, degree) + u * v, b = 0.3 * u - v;
    return Node{static_cast<float>(a * z + 0.01 * z * z * z), static_cast<float>(b * z * z),
                static_cast<float>(a + 0.03 * z * z), static_cast<float>(2 * b * z)};
}

DisplacementGrid filled(const PixelWindow& window, int spacing, std::vector<double> depths, int degree,
                        bool perspective, DepthInterpolation interpolation) {
    DisplacementGrid grid;
    grid.spacing = spacing;
    grid.depths = std::move(depths);
    grid.perspective = perspective;
    grid.interpolation = interpolation;
    grid.cover(window);
    for (int r = 0; r < grid.rows; ++r)
        for (std::size_t k = 0; k < grid.depths.size(); ++k)
            for (int c = 0; c < grid.columns; ++c)
                grid.row(r, k)[c] =
                    synthetic((grid.column0 + c) * spacing, (grid.row0 + r) * spacing, grid.depths[k], degree);
    return grid;
}

TEST(DisplacementGrid, FifthOrderPolynomialsAndCubicsInDepthAreExact) {
    for (const PixelWindow& window : {PixelWindow{0, 0, 40, 20}, {-37, -13, 41, 9}, {5, -1, 1, 1}})
        for (const int spacing : {1, 2, 4, 8})
            for (const bool perspective : {true, false}) {
                const DisplacementGrid grid =
                    filled(window, spacing, {1, 2, 5}, 5, perspective, DepthInterpolation::Hermite);
                GridRow row;
                for (int y = window.y0; y < window.y0 + window.height; ++y) {
                    row.start(grid, y);
                    for (const double z : {1.0, 1.3, 2.0, 4.9, 5.0}) {
                        std::vector<float> line(2 * static_cast<std::size_t>(window.width), 0.25f);
                        row.add_constant_depth(window.x0, window.width, z, line.data());
                        for (int i = 0; i < window.width; ++i) {
                            const Node x = synthetic(window.x0 + i, y, z, 5);
                            const double scale = perspective ? 1 / z : 1.0;
                            const Shift d = row.at(window.x0 + i, z);
                            EXPECT_NEAR(d.x, scale * x[0], 2e-5) << spacing << ' ' << z;
                            EXPECT_NEAR(d.y, scale * x[1], 2e-5) << spacing << ' ' << z;
                            EXPECT_NEAR(line[2 * static_cast<std::size_t>(i)] - 0.25f, d.x, 2e-6);
                            EXPECT_NEAR(line[2 * static_cast<std::size_t>(i) + 1] - 0.25f, d.y, 2e-6);
                        }
                    }
                }
            }
}

TEST(DisplacementGrid, BeyondItsDepthsDisplacementStaysFinite) {
    for (const auto interpolation : {DepthInterpolation::Hermite, DepthInterpolation::Linear}) {
        const DisplacementGrid grid = filled({0, 0, 8, 8}, 2, {2, 6}, 1, true, interpolation);
        GridRow row;
        row.start(grid, 5);
        for (const double z : {1e-40, 1e-6, 1.0, 1e9, 3e38}) {
            const Shift d = row.at(3, z);
            EXPECT_TRUE(std::isfinite(d.x) && std::isfinite(d.y)) << z;
        }
        // before the first depth X ∝ z², or z; far beyond the last, d tends to the slope
        const float part = interpolation == DepthInterpolation::Hermite ? 0.25f : 1.0f;
        EXPECT_FLOAT_EQ(row.at(3, 0.5).x, part * row.at(3, 2.0).x);
        EXPECT_NEAR(row.at(3, 1e12).x, synthetic(3, 5, 6, 1)[2], 1e-5);
    }
}

TEST(DisplacementGrid, NodesAreAnchoredSoThatPiecesAgreeWithTheWhole) {
    const DisplacementGrid whole = filled({-20, -10, 64, 40}, 4, {3, 7}, 7, true, DepthInterpolation::Hermite);
    const DisplacementGrid piece = filled({-3, 5, 11, 7}, 4, {3, 7}, 7, true, DepthInterpolation::Hermite);
    GridRow a, b;
    for (int y = 5; y < 12; ++y) {
        a.start(whole, y);
        b.start(piece, y);
        for (int x = -3; x < 8; ++x) {
            EXPECT_EQ(a.at(x, 4.4).x, b.at(x, 4.4).x);
            EXPECT_EQ(a.at(x, 4.4).y, b.at(x, 4.4).y);
        }
    }
}

TEST(DisplacementGrid, PlacesAgreeWithRowsAtPixelsAndAreExactBetweenThem) {
    DisplacementGrid grid = filled({0, 0, 40, 20}, 4, {2, 5}, 5, false, DepthInterpolation::Hermite);
    GridRow row;
    row.start(grid, 9);
    EXPECT_NEAR(grid.at(grid.place(13, 9), 1)[0], row.at(13, 5).x, 2e-6);
    const Node expected = synthetic(13.375, 9.25, 5, 5);  // both are multiples of spacing/256
    const Node found = grid.at(grid.place(13.375, 9.25), 1);
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(found[c], expected[c], 2e-5);
    EXPECT_EQ(grid.at(grid.place(-1e6, 4), 0)[0], grid.row(3, 0)[0][0]) << "the border continues";
}

TEST(DisplacementGrid, LargestShiftBoundsNodesAndTheFarLimit) {
    DisplacementGrid grid;
    grid.depths = {2, 10};
    grid.cover({0, 0, 3, 3});
    grid.row(1, 0)[2] = Node{0, -8, 0, 0};
    EXPECT_FLOAT_EQ(grid.largest_shift(), 4);
    grid.row(2, 1)[0] = Node{30, 0, 5, 0};
    EXPECT_FLOAT_EQ(grid.largest_shift(), 5);
    grid.scale(2);
    EXPECT_FLOAT_EQ(grid.largest_shift(), 10);
}

TEST(DisplacementGrid, SpacingKeepsToTheFieldsCells) {
    EXPECT_EQ(node_spacing(0), 1);
    EXPECT_EQ(node_spacing(1.99 / kCellsPerNode), 1);
    EXPECT_EQ(node_spacing(2 / kCellsPerNode), 2);
    EXPECT_EQ(node_spacing(7.9 / kCellsPerNode), 4);
    EXPECT_EQ(node_spacing(1e300), kWidestSpacing);
}

}  // namespace
}  // namespace eikonal
