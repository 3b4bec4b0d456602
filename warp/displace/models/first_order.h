/// Model `first-order`: Eq. 7 integrated along every node's own ray, through any field that can be sampled at a point.
///
///     x1(z) = L² ∫₀^z (z - w) F(P(w)) dw        (PHYSICS.md#first-order; w is axial depth, L the ray's metres a metre
///     of depth)
///
/// by two-point Gauss-Legendre rules on steps no longer than a cell of the field along the ray, so that no eddy is
/// skipped. An aperture is a bundle of parallel (orthographic) or converging (perspective; on the object at `focus`)
/// rays whose forces are averaged.
#pragma once

#include <algorithm>
#include <memory>
#include <variant>

#include "noise/turbulence/gradient_noise/gradient_noise.h"
#include "noise/turbulence/lattice/lattice_instant.h"
#include "warp/displace/grid/displacement_grid.h"
#include "warp/displace/grid/ray_frame.h"

namespace eikonal {

/// Rms error of a lattice's force that its spline is made finer for, relative to the rms (lattice_spline_error): twice
/// as fine as the lattice does even for power up to Nyquist. Lattices beyond 128³ keep to their own cells.
inline constexpr double kFirstOrderSplineError = 0.015;
/// Rms error against Eq. 7 along the lattice's trigonometric sum, relative to the rms, for any spectrum; hence the
/// difference from `spectral` on any lattice to 128³. (tests/displacement_test.cpp)
inline constexpr double kFirstOrderError = 0.03;

/// Steps of a ray at most: scenes and frames that need more within the picture are refused (layers.h). Nodes beyond its
/// edge, which only interpolation reads, are cut to so many a layer.
inline constexpr double kMostFirstOrderSteps = 20000;

/// A gradient-noise medium frozen at one time.
struct GradientNoiseInstant {
    const GradientNoiseField* field;
    double t;
    IndexSample sample(const dvec3& x) const { return field->sample(x, t); }
};

struct FirstOrderRays {
    std::variant<std::shared_ptr<const LatticeInstant>, GradientNoiseInstant> medium;
    double strength;                ///< multiplies ∇n: ray equation and exaggeration
    dvec3 cell;                     ///< of the field along x, y, z [m]
    double aperture;                ///< diameter [m]; 0: a point
    double focus;                   ///< axial depth on which a perspective aperture's rays converge [m]
    bool (*cancelled)() = nullptr;  ///< as DisplacerSettings

    /// Smallest cell, and cells a metre along a direction.
    double finest_cell() const { return std::min({cell.x, cell.y, cell.z}); }
    double cells_along(const dvec3& direction) const { return glm::length(direction / cell); }

    /// Adds X and S at every node and depth. FrameError once cancelled.
    void fill(DisplacementGrid& grid, const Camera& camera) const;
};

}  // namespace eikonal
