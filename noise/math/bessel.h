/// The filter that averaging over a disc applies to a plane wave: jinc(x) = 2 J1(x)/x.
///
/// A disc of diameter A averages a wave of wavenumber k across it to jinc(kA/2) times the value at its centre.
/// Diffraction is neglected. *added* jinc uses portable arithmetic only (noise/math/portable_math.h). Its absolute
/// error is at most kJincError for every finite x (tests/noise/turbulence/path_tables_test.cpp). jinc(0) = 1 exactly.
/// Theory: PHYSICS.md#displacement-tables.
#pragma once

#include <cmath>

#include "noise/math/portable_math.h"

namespace eikonal {

inline constexpr double kJincError = 1e-12;

/// 2 J1(x)/x, by the power series below 12.5 and by Hankel's asymptotic expansion above. The expansion ends at its
/// smallest term.
inline double jinc(double x) {
    x = std::abs(x);
    if (x < 12.5) {
        // Σ (-q)^m / (m! (m+1)!), q = x²/4, summed innermost first
        const double q = 0.25 * x * x;
        double sum = 1;
        for (int m = 34; m >= 1; --m) sum = 1 - sum * q / static_cast<double>(m * (m + 1));
        return sum;
    }
    if (x > 1e12) return 0;  // |jinc| < 1.6 x^(-3/2)
    // J1(x) = √(2/πx) (P cos χ - Q sin χ), χ = x - 3π/4, with terms a_m = a_{m-1} (4 - (2m-1)²)/(8 m x)
    double p = 1, q = 0, term = 1;
    for (int m = 1; m <= 24; ++m) {
        const double odd = 2 * m - 1;
        term *= (4 - odd * odd) / (8 * m * x);
        if (std::abs(term) < 1e-17) break;
        const double signed_term = (m & 2) != 0 ? -term : term;
        ((m & 1) != 0 ? q : p) += signed_term;
    }
    double s, c;
    portable::sincos_turns(x / portable::kTwoPi, s, c);
    // cos χ = (s - c)/√2, sin χ = -(s + c)/√2
    return 2 / x * std::sqrt(1 / (portable::kPi * x)) * (p * (s - c) + q * (s + c));
}

}  // namespace eikonal
