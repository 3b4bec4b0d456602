/// Bins of a discrete Fourier transform of n samples: which wave each one stands for.
#pragma once

namespace eikonal {

/// Signed index of Fourier bin i of n: -n/2 < m <= n/2.
constexpr int signed_index(int i, int n) {
    return 2 * i <= n ? i : i - n;
}
/// Whether bin i of n is the Nyquist mode, its own conjugate partner.
constexpr bool is_nyquist(int i, int n) {
    return 2 * i == n;
}
/// Largest |m| of n bins that is not Nyquist: modes beyond bend no light.
constexpr int largest_bending_mode(int n) {
    return (n - 1) / 2;
}
/// Wavenumber of Fourier bin i of n along an axis [rad/m].
double bin_wavenumber(int i, int n, double period);

}  // namespace eikonal
