/// Displacement of parallel rays through a lattice field, exactly, as one product in Fourier space for every path
/// length u (PHYSICS.md#displacement-tables, *added*). For rays x0(w) = start + w·sign·axis, starting at coordinate z0
/// on the axis:
///
///     Ψ̂(k⊥; u) = Σ_k∥ n̂(k) e^{i k∥ z0} h(sign k∥, u),      x̂1(k⊥; u) = i k⊥ Ψ̂(k⊥; u)
///
/// with h of path_kernel.h and n̂ less its Nyquist modes of space, which bend no light (lattice.h); Ψ = ∫₀^u (u - w) n
/// dw [m²] is the potential of the lateral displacement, and Ψ' = ∫₀^u n dw that of the bend. The force is ∇n
/// ("physical" for n ≈ 1); the paper's ½, exaggeration and the division by u belong to the caller. An aperture of
/// diameter A averages over parallel rays: times jinc(k⊥A/2).
///
/// Falloff whose normal is perpendicular to the axis is constant along a ray, so the caller combines at the pixel
///     x1[∇(g n)] = g x1[∇n] + ∇g Ψ,     and with derivatives for the bend;
/// `potential` and `potential_slope` are there for that, if the medium has a falloff. A falloff along the axis has no
/// table.
///
/// Accuracy against Eq. 7 integrated along the trigonometric sum: kPathTableError relative to the rms, at lattice nodes
/// and, with the padding that path_padding chooses, anywhere between (tests/path_tables_test.cpp). Keep u within a
/// period: beyond it the field repeats along the ray and overstates. Same bits for any number of threads.
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

    /// The two other axes, ascending: those of the tables.
    std::array<int, 2> lateral() const { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }
};

/// Ψ̂ at one u and its derivative, half-complex over the lateral axes (the second halved), aperture applied.
struct PathSpectrum {
    FftVector<complex32> potential;  ///< Ψ [m²]
    FftVector<complex32> slope;      ///< Ψ' [m]
};

/// One for each u [m] >= 0. `spectrum`: that of the field at the instant, from
/// LatticeField::bending_spectrum_at.
std::vector<PathSpectrum> path_spectra(const LatticeField& field, const FftVector<complex32>& spectrum,
                                       const PathRays& rays, std::span<const double> u);

/// Lateral displacement, bend and potentials at path length u, as functions of the start's coordinates along the two
/// lateral axes in lattice periods (coordinate / period), any finite value.
struct PathTable {
    double u = 0;
    std::array<PeriodicSpline2, 2> displacement;                ///< x1 [m] along the lateral axes
    std::array<PeriodicSpline2, 2> slope;                       ///< dx1/du
    std::optional<PeriodicSpline2> potential, potential_slope;  ///< Ψ [m²], Ψ' [m]; with falloff only
};

/// Exact tables at time t for each u. padding: that of path_padding if 0.
std::vector<PathTable> path_tables(const LatticeField& field, double t, const PathRays& rays, std::span<const double> u,
                                   int padding = 0);

/// The paper's single slice: force ∇⊥n on the plane at distance w along the rays, and n there with falloff.
struct SliceTable {
    std::array<PeriodicSpline2, 2> force;  ///< [1/m]
    std::optional<PeriodicSpline2> index;  ///< n - n_ambient; with falloff only
};
SliceTable slice_table(const LatticeField& field, double t, const PathRays& rays, double w, int padding = 0);

/// Discrete expectation of the variance of the slice's force along the lateral axes [1/m²], for the paper's constant c:
/// its table x1 = c u F has the rms of LatticeField::displacement_variance at one u only.
std::array<double, 2> slice_variance(const LatticeField& field, const PathRays& rays);

/// Smallest padding (1, 2, 3, 4, 6 or kLargestPathPadding) for which the splines' expected error at the least and the
/// greatest u > 0 is below half of `tolerance`, relative to the rms, or the largest. The same for every t: find it once
/// a shot. Cost of a table grows as its square, so that a picture, which needs no 1e-4, is better off with less.
int path_padding(const LatticeField& field, const PathRays& rays, std::span<const double> u,
                 double tolerance = kPathTableError);

}  // namespace eikonal
