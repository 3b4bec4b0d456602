/// Six-point Lagrange interpolation on evenly spaced nodes: the interpolant between the nodes of a displacement grid.
///
/// A position is i + f in units of the spacing, i the whole part and 0 <= f <= 1. The interpolant takes the nodes
/// i - kNodesBefore, …, i - kNodesBefore + kLagrangeNodes - 1. It is exact for polynomials of fifth order.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace eikonal {

inline constexpr int kNodesBefore = 2, kLagrangeNodes = 6;

using LagrangeWeights = std::array<float, kLagrangeNodes>;

/// Weights of the six nodes at the fraction f.
LagrangeWeights lagrange_weights(double f);

/// Weights at the fractions 0, 1/spacing, …, (spacing - 1)/spacing; spacing >= 1.
std::vector<LagrangeWeights> lagrange_phases(int spacing);

/// Weights at the multiple of 1/256 that is nearest to f. They are tabulated: for places that are anywhere between the
/// nodes.
const LagrangeWeights& tabulated_lagrange_weights(double f);

/// Σ w[i] · value(i) over the six nodes, added in the order of i. Weights and values are numbers or vectors.
template <class Weight, class Value>
[[gnu::always_inline]] inline auto weighted_sum(const std::array<Weight, kLagrangeNodes>& w, const Value& value) {
    return w[0] * value(0) + w[1] * value(1) + w[2] * value(2) + w[3] * value(3) + w[4] * value(4) + w[5] * value(5);
}

}  // namespace eikonal
