/// The first-order displacement of one Fourier mode along a straight path, in closed form
/// (PHYSICS.md#displacement-tables, *added*):
///
///     h(k, u)  = ∫₀^u (u - w) e^{ikw} dw = (1 + iku - e^{iku})/k²      [m²]
///     h'(k, u) = dh/du = ∫₀^u e^{ikw} dw = (e^{iku} - 1)/(ik)          [m]
///
/// so that a mode's force F̂ e^{ik(z0 + w)} displaces the ray by F̂ e^{ik z0} h and bends it by F̂ e^{ik z0} h'.
/// k [rad/m] along the ray and of either sign, u [m]; h(-k, u) is the conjugate of h(k, u). Valid for all finite k and
/// u whose result fits a double; relative error of the complex value at most kPathKernelError
/// (tests/path_tables_test.cpp), where ku itself is taken as rounded: beyond |ku| ~ 1e3 that rounding is the larger.
#pragma once

#include <cmath>
#include <complex>

#include "noise/math/portable_math.h"

namespace eikonal {

inline constexpr double kPathKernelError = 1e-14;

namespace detail {

/// sin and cos of θ/2 for any finite or infinite θ; an angle whose phase a double cannot hold counts as whole turns.
inline void half_angle(double theta, double& s, double& c) {
    double turns = theta / (2 * portable::kTwoPi);
    if (std::abs(turns) > 0x1p40) turns = std::isfinite(turns) ? turns - std::floor(turns) : 0;
    portable::sincos_turns(turns, s, c);
}

}  // namespace detail

inline std::complex<double> path_kernel(double k, double u) {
    const double theta = k * u;
    if (std::abs(theta) < 1) {
        // u² Σ_m (iθ)^m / (m + 2)!, split into real and imaginary parts
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
