/// The first-order displacement of one Fourier mode along a straight path, in closed form
/// (PHYSICS.md#displacement-tables, *added*):
///
///     h(k, u)  = ∫₀^u (u - w) e^{ikw} dw = (1 + iku - e^{iku})/k²      [m²]
///     h'(k, u) = dh/du = ∫₀^u e^{ikw} dw = (e^{iku} - 1)/(ik)          [m]
///
/// A mode's force F̂ e^{ik(z0 + w)} displaces the ray by F̂ e^{ik z0} h and bends it by F̂ e^{ik z0} h'.
/// k: wavenumber along the ray [rad/m], of either sign. u: path [m]. h(-k, u) is the conjugate of h(k, u).
/// Range: all finite k and u whose result fits a double. The relative error of the complex value is at most
/// kPathKernelError (tests/noise/turbulence/path_tables_test.cpp) for the product ku as rounded. Beyond |ku| ~ 1e3 the
/// rounding of ku is the larger error.
#pragma once

#include <cmath>
#include <complex>

#include "noise/math/portable_math.h"

namespace eikonal {

inline constexpr double kPathKernelError = 1e-14;

namespace detail {

/// sin and cos of θ/2 for any finite or infinite θ. An angle whose phase a double cannot hold counts as whole turns.
inline void half_angle(double theta, double& s, double& c) {
    double turns = theta / (2 * portable::kTwoPi);
    if (std::abs(turns) > 0x1p40) turns = std::isfinite(turns) ? turns - std::floor(turns) : 0;
    portable::sincos_turns(turns, s, c);
}

}  // namespace detail

inline std::complex<double> path_kernel(double k, double u) {
    const double theta = k * u;
    if (std::abs(theta) < 1) {
        // The series u² Σ_m (iθ)^m / (m + 2)!, split into real and imaginary parts.
        const double t2 = theta * theta;
        double re = 0, im = 0;
        for (int m = 16; m >= 0; m -= 2) {
            const double next_pair = static_cast<double>((m + 3) * (m + 4));
            const double next_pair_im = static_cast<double>((m + 4) * (m + 5));
            re = 1 - t2 * re / next_pair;
            im = 1 - t2 * im / next_pair_im;
        }
        return {0.5 * u * u * re, theta * u * u * im / 6};
    }
    double s, c;
    detail::half_angle(theta, s, c);
    // 1 - cos θ = 2 sin²(θ/2), sin θ = 2 sin(θ/2) cos(θ/2)
    return {2 * (s / k) * (s / k), (u - 2 * s * c / k) / k};
}

inline std::complex<double> path_kernel_derivative(double k, double u) {
    const double theta = k * u;
    if (std::abs(theta) < 1e-9) return {u, 0.5 * theta * u};
    double s, c;
    detail::half_angle(theta, s, c);
    const double chord = 2 * s / k;  // u sinc(θ/2)
    return {chord * c, chord * s};
}

}  // namespace eikonal
