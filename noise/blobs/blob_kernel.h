/// First-order perturbation of a straight ray by one Gaussian blob, in closed form (PHYSICS.md#blobs, *corrected*).
///
/// Along x0(w) = q0 + w p0, |p0| = 1, 0 <= w <= u, past the blob n - n_ambient = n_j e^{-|x - x_j|²/σ²}, with
/// w_j = (x_j - q0)·p0, b = q0 + w_j p0 - x_j, a = -w_j/σ, c = (u - w_j)/σ and s = (w - w_j)/σ:
///
///     x1(u) = ∫₀^u (u - w) ∇n dw = -(2 n_j/σ²) e^{-|b|²/σ²} (I1 b + J2 p0)
///     I1 = σ² ∫_a^c (c - s) e^{-s²} ds        dI1/du = σ ∫_a^c e^{-s²} ds
///     J2 = σ³ ∫_a^c (c - s) s e^{-s²} ds      dJ2/du = σ² ∫_a^c s e^{-s²} ds
///
/// That is the physical convention, F = ∇n; the paper's F = ½∇n gives exactly half. Lengths in metres.
///
/// Accuracy: each integral, and each of x1's and dx1's components along b and along p0, is within kBlobKernelError of
/// its integral of the absolute integrand. I1 and dI1 never change sign, J2 and dJ2 only if the closest point lies on
/// the ray (a < 0 < c): elsewhere this is the plain relative error. Where J2 or dJ2 pass through zero no relative error
/// exists, since the last bit of w_j moves the zero. Results below the normal doubles are within 1e-300. Rounding the
/// vectors' coordinates to doubles adds half a unit of the last place of each.
/// tests/blob_kernel_test.cpp holds this against quadrature of the definition in 113-bit arithmetic, over 12 decades of
/// σ, u, |b|/σ and w_j/σ, where the error stays below a fiftieth of the bound.
/// Errors are those at the given doubles. `perturb` finds w_j and b from q0, p0 and x_j to 2e-19 |x_j - q0|, which adds
/// 4e-19 |x_j - q0| |b|/σ²: less than the bound up to |x_j - q0| = 1e5 σ, and beyond it a thousandth of what rounding
/// q0 or p0 to doubles has cost already.
///
/// How (δ = u/σ; tails area(x), moment(x) of noise/math/erf.h; I1 as the example, the others likewise in
/// blob_kernel.cpp). The Gaussian of the point nearest to x_j is taken out of each form, so that it and e^{-|b|²/σ²}
/// are one exponential:
///
///   region                           form of I1/σ²                                        loses
///   short   δ (|a| + |c|) <= 1/4     24 terms of a Taylor series about the nearest point  nothing
///   behind  0 <= a                   δ area(a) - moment(a) + e^{a²-c²} moment(c)          < 2 digits
///   beyond  c <= 0                   moment(-c) - e^{c²-a²} (moment(-a) + δ area(-a))     < 2 digits
///   inside  a < 0 < c                c E + (e^{-c²} - e^{-a²})/2,                         < 2 digits
///                                    E = √π - e^{-a²} area(-a) - e^{-c²} area(c)
///   whole   a < -8, 8 < c            c √π: the tails are below 1e-27                      nothing
///
/// Each form has the bound's error, over the whole of its region. Exponents, lengths and factors are long double, on
/// x86-64 the 80-bit format, + - * / of which give the same bits on every processor: so exponents keep their digits
/// (e^-t multiplies their relative error by t) and nothing over- or underflows on the way (range 1e±4932).
///
/// Finite for every finite input: what exceeds the doubles saturates at ±DBL_MAX. u <= 0 or sigma <= 0 give zero.
///
/// Cost: 0.18 (behind, beyond) to 0.25 µs (across) a call of `perturb`, 0.06 µs where all vanishes or all is passed, on
/// a loaded server core. For pixels see the single-precision noise/blobs/blob_profile.h.
#pragma once

#include <glm/vec3.hpp>

namespace eikonal {

using glm::dvec3;

inline constexpr double kBlobKernelError = 1e-12;

/// One blob as rays see it: n - n_ambient = n exp(-|x - center|²/sigma²).
struct Blob {
    dvec3 center;  ///< x_j [m]
    double sigma;  ///< σ [m] > 0
    double n;      ///< n_j; negative for hot air
};

/// The integrals of a ray without the factor -(2 n_j/σ²) e^{-|b|²/σ²}.
struct BlobIntegrals {
    double I1;   ///< [m²] >= 0
    double J2;   ///< [m³]
    double dI1;  ///< dI1/du [m] >= 0
    double dJ2;  ///< dJ2/du [m²]
};

/// w_j: of the ray's closest approach, any sign; u: length of the ray.
BlobIntegrals blob_integrals(double sigma, double w_j, double u);

struct Perturbation {
    dvec3 x1;   ///< displacement of the ray's end [m]
    dvec3 dx1;  ///< dx1/du, change of its direction
};

/// Perturbation of the ray q0 + w p0, |p0| = 1 up to rounding, of length u. Add those of all blobs.
Perturbation perturb(const Blob& blob, dvec3 q0, dvec3 p0, double u);

/// The same from the closest approach: b, perpendicular to p0, leads from the blob's centre to the ray at w_j.
Perturbation perturb_at(double sigma, double n, dvec3 b, double w_j, dvec3 p0, double u);

}  // namespace eikonal
