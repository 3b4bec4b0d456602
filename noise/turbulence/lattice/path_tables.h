/// Exact displacement of parallel rays through a lattice field, for every path length u, as one product in Fourier
/// space (PHYSICS.md#displacement-tables, *added*). For rays x0(w) = start + w·sign·axis that start at coordinate z0 on
/// the axis:
///
///     Ψ̂(k⊥; u) = Σ_k∥ n̂(k) e^{i k∥ z0} h(sign k∥, u),      x̂1(k⊥; u) = i k⊥ Ψ̂(k⊥; u)
///
/// h is the kernel of path_kernel.h. n̂ leaves out the Nyquist modes of space, which bend no light (lattice.h).
/// Ψ = ∫₀^u (u - w) n dw [m²] is the potential of the lateral displacement. Ψ' = ∫₀^u n dw [m] is that of the bend. The
/// force is ∇n, which is the physical convention for n ≈ 1. The paper's factor ½, exaggeration and the division by u
/// belong to the caller. An aperture of diameter A averages over parallel rays and multiplies by jinc(k⊥A/2).
///
/// A falloff whose normal is perpendicular to the axis is constant along a ray. The caller then combines at the pixel
///     x1[∇(g n)] = g x1[∇n] + ∇g Ψ
/// and likewise with derivatives for the bend. `potential` and `potential_slope` serve this purpose. They exist only if
/// the medium has a falloff. A falloff along the axis has no table.
///
/// Accuracy against Eq. 7 integrated along the trigonometric sum: kPathTableError relative to the rms, at the nodes
/// and, with the padding that path_padding chooses, anywhere between (tests/noise/turbulence/path_tables_test.cpp).
/// Keep u within one period: beyond it the field repeats along the ray, and the displacement is overstated. The bits
/// are the same for any number of threads.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "noise/math/periodic_spline2.h"
#include "noise/turbulence/lattice/lattice.h"

namespace eikonal {

inline constexpr double kPathTableError = 1e-4;
inline constexpr int kLargestPathPadding = 8;

/// Parallel rays along a lattice axis.
struct PathRays {
    int axis = 2;         ///< 0, 1 or 2
    int sign = 1;         ///< +1 or -1: towards larger or smaller coordinates
    double z0 = 0;        ///< coordinate of their starting plane on the axis [m]
    double aperture = 0;  ///< diameter [m] >= 0

    /// The two other axes in ascending order, which are the axes of the tables.
    std::array<int, 2> lateral() const { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }
};

/// Ψ̂ at one u and its derivative, with the aperture: half-complex over the lateral axes, the second halved.
struct PathSpectrum {
    FftVector<complex32> potential;  ///< Ψ [m²]
    FftVector<complex32> slope;      ///< Ψ' [m]
};

/// One PathSpectrum for each u [m] >= 0. spectrum: LatticeField::bending_spectrum_at of the field at the instant.
std::vector<PathSpectrum> path_spectra(const LatticeField& field, const FftVector<complex32>& spectrum,
                                       const PathRays& rays, std::span<const double> u);

/// Lateral displacement, bend and potentials at path length u. Arguments of the splines are the start's coordinates
/// along the two lateral axes in lattice periods (coordinate / period), any finite value.
struct PathTable {
    double u = 0;
    std::array<PeriodicSpline2, 2> displacement;                ///< x1 [m] along the lateral axes
    std::array<PeriodicSpline2, 2> slope;                       ///< dx1/du
    std::optional<PeriodicSpline2> potential, potential_slope;  ///< Ψ [m²], Ψ' [m]. With falloff only.
};

/// Exact tables at time t for each u. padding: 0 takes that of path_padding.
std::vector<PathTable> path_tables(const LatticeField& field, double t, const PathRays& rays, std::span<const double> u,
                                   int padding = 0);

/// The paper's single slice: the force ∇⊥n on the plane at distance w along the rays.
struct SliceTable {
    std::array<PeriodicSpline2, 2> force;  ///< [1/m]
    std::optional<PeriodicSpline2> index;  ///< n - n_ambient. With falloff only.
};
SliceTable slice_table(const LatticeField& field, double t, const PathRays& rays, double w, int padding = 0);

/// Discrete expectation of the variance of the slice's force along the lateral axes [1/m²]. The paper's table
/// x1 = c u F takes its constant c from it, and so has the rms of LatticeField::displacement_variance at one u only.
std::array<double, 2> slice_variance(const LatticeField& field, const PathRays& rays);

/// The smallest padding among 1, 2, 3, 4, 6 and kLargestPathPadding for which the splines' expected error at the least
/// and at the greatest u > 0 is below half of `tolerance`, relative to the rms. If none suffices, kLargestPathPadding.
/// It is the same for every t, so a shot needs it once. The cost of a table grows as the square of the padding. A
/// picture does not need 1e-4 and should ask for less.
int path_padding(const LatticeField& field, const PathRays& rays, std::span<const double> u,
                 double tolerance = kPathTableError);

}  // namespace eikonal
