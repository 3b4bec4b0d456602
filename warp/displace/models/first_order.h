/// Model `first-order`: integrates Eq. 7 along the straight ray of every node, through any field that can be sampled at
/// a point.
///
///     x1(z) = L² ∫₀^z (z - w) F(P(w)) dw        PHYSICS.md#first-order
///
/// w is the axial depth, and L is the length of the ray per metre of depth. The integral is computed by the two-point
/// Gauss-Legendre rule on steps no longer than a cell of the field along the ray, so that no eddy is skipped.
///
/// An aperture is a bundle of rays whose forces are averaged. The rays are parallel in an orthographic view; in
/// perspective they converge at the depth `focus`.
#pragma once

#include <algorithm>
#include <cmath>
#include <stop_token>
#include <vector>

#include "warp/displace/grid/aperture.h"
#include "warp/displace/grid/displacement_grid.h"
#include "warp/displace/grid/model.h"
#include "warp/displace/grid/ray_frame.h"

namespace eikonal {

/// Allowed rms error of a lattice's force, relative to its rms (lattice_spline_error). The spline is refined until its
/// error is below. A spline twice as fine as the lattice meets this even with power up to Nyquist. Lattices beyond 128³
/// keep their own cells.
inline constexpr double kFirstOrderSplineError = 0.015;
/// Rms error against Eq. 7 along the lattice's trigonometric sum, relative to the rms, for any spectrum. It is also the
/// difference from `spectral` on any lattice up to 128³. (tests/warp/displace/displacement_test.cpp)
inline constexpr double kFirstOrderError = 0.03;

/// Largest number of steps of a ray. Scenes and frames that need more within the picture are refused (ray_steps.h).
/// Nodes beyond the picture's edge serve only the interpolation; their rays take at most so many steps between depths.
inline constexpr double kMostFirstOrderSteps = 20000;

struct FirstOrderRays {
    double strength;            ///< multiplies ∇n: ray equation and exaggeration
    dvec3 cell;                 ///< cell of the field along x, y, z [m]
    double aperture;            ///< diameter [m]; 0: a point
    double focus;               ///< axial depth on which a perspective aperture's rays converge [m]
    std::stop_token stop = {};  ///< as DisplacerSettings

    /// The smallest side of a cell [m]. Below: the number of cells per metre along a direction.
    double finest_cell() const { return std::min({cell.x, cell.y, cell.z}); }
    double cells_along(const dvec3& direction) const { return glm::length(direction / cell); }

    /// A grid without nodes. Its depths are evenly spaced in their logarithm. They are one or two steps apart unless
    /// that makes too many.
    DisplacementGrid grid(const Camera& camera, double nearest, double farthest) const;

    /// Adds X and S at every node and depth. field.sample(x) returns an IndexSample. FrameError once a stop is
    /// requested.
    template <class Field>
    void fill(DisplacementGrid& grid, const Camera& camera, const Field& field) const;

  private:
    template <class Field>
    void fill_node(DisplacementGrid& grid, const Camera& camera, const Field& field, const std::vector<dvec2>& disc,
                   int row, int column) const;
};

template <class Field>
void FirstOrderRays::fill_node(DisplacementGrid& grid, const Camera& camera, const Field& field,
                               const std::vector<dvec2>& disc, int row, int column) const {
    const StraightRay ray =
        straight_ray(camera, (grid.column0 + column) * grid.spacing + 0.5, (grid.row0 + row) * grid.spacing + 0.5);
    const auto force = [&](double w) {
        const dvec3 p = ray.at(w);
        if (disc.size() == 1) return field.sample(p).gradient;
        const double radius = 0.5 * aperture * (grid.perspective ? std::max(0.0, 1 - w / focus) : 1.0);
        dvec3 sum{0, 0, 0};
        for (const dvec2& q : disc) sum += field.sample(p + radius * (q.x * camera.right + q.y * camera.up)).gradient;
        return sum / static_cast<double>(disc.size());
    };
    constexpr double kGauss = 0.21132486540518711775;  // (1 - 1/√3)/2
    dvec3 x{0, 0, 0}, slope{0, 0, 0};                  // ∫∫F by axial depth, and its derivative
    double z = 0;
    const double cells = cells_along(ray.direction);  // cells per metre of depth
    const double scale = strength * ray.length * ray.length;
    for (std::size_t k = 0; k < grid.depths.size(); ++k) {
        const double target = grid.depths[k];
        const double steps = std::clamp(std::ceil((target - z) * cells), 1.0, kMostFirstOrderSteps);
        const double h = (target - z) / steps;
        for (double i = 0; i < steps; ++i) {
            const double w = z + i * h;
            const dvec3 f1 = force(w + kGauss * h), f2 = force(w + (1 - kGauss) * h);
            x += h * slope + (0.5 * h * h) * ((1 - kGauss) * f1 + kGauss * f2);
            slope += (0.5 * h) * (f1 + f2);
        }
        z = target;
        const dvec2 shift = image_shift(camera, ray, scale * x), rate = image_shift(camera, ray, scale * slope);
        grid.row(row, k)[column] += Node{static_cast<float>(shift.x), static_cast<float>(shift.y),
                                         static_cast<float>(rate.x), static_cast<float>(rate.y)};
    }
}

template <class Field>
void FirstOrderRays::fill(DisplacementGrid& grid, const Camera& camera, const Field& field) const {
    const std::vector<dvec2> disc = aperture_points(aperture, finest_cell());
    for (int r = 0; r < grid.rows; ++r)
        for (int c = 0; c < grid.columns; ++c) {
            check_stop(stop);
            fill_node(grid, camera, field, disc, r, c);
        }
}

}  // namespace eikonal
