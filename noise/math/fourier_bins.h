/// The wave that each bin of a discrete Fourier transform of n samples stands for.
#pragma once

#include "noise/math/portable_math.h"

namespace eikonal {

/// Signed index m of bin i of n: -n/2 < m <= n/2.
constexpr int signed_index(int i, int n) {
    return 2 * i <= n ? i : i - n;
}
/// Whether bin i of n is the Nyquist mode, which is its own conjugate partner.
constexpr bool is_nyquist(int i, int n) {
    return 2 * i == n;
}
/// The largest |m| of n bins below Nyquist. Only modes up to it bend light (noise/turbulence/lattice/lattice.h).
constexpr int largest_bending_mode(int n) {
    return (n - 1) / 2;
}
/// Wavenumber of bin i of n along an axis of the given period [m], in rad/m.
inline double bin_wavenumber(int i, int n, double period) {
    return portable::kTwoPi * signed_index(i, n) / period;
}

}  // namespace eikonal
