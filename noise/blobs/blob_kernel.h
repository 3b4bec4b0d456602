/// First-order perturbation of a straight ray by one Gaussian blob, in closed form (PHYSICS.md#blobs, *corrected*).
///
/// Along x0(w) = q0 + w p0, |p0| = 1, 0 <= w <= u, past the blob n - n_ambient = n_j e^{-|x - x_j|²/σ²}, with
/// w_j = (x_j - q0)·p0, b = q0 + w_j p0 - x_j, a = -w_j/σ, c = (u - w_j)/σ and s = (w - w_j)/σ:
///
///     x1(u) = ∫₀^u (u - w) ∇n dw = -(2 n_j/σ²) e^{-|b|²/σ²} (I1 b + J2 p0)
///     I1 = σ² ∫_a^c (c - s) e^{-s²} ds        dI1/du = σ ∫_a^c e^{-s²} ds
///     J2 = σ³ ∫_a^c (c - s) s e^{-s²} ds      dJ2/du = σ² ∫_a^c s e^{-s²} ds
///
/// This is the physical convention, F = ∇n. The paper's F = ½∇n gives exactly half. Lengths are in metres.
///
/// Accuracy. Each integral, and each component of x1 and dx1 along b and along p0, has an error of at most
/// kBlobKernelError times the integral of the absolute integrand. I1 and dI1 never change sign. J2 and dJ2 do so only
/// if the closest point lies on the ray (a < 0 < c). In all other cases the error is the plain relative error. Where J2
/// or dJ2 pass through zero, no relative error exists, since the last bit of w_j moves the zero. Results below the
/// normal doubles are within 1e-300. Rounding the vectors' coordinates to doubles adds half a unit of the last place.
/// tests/noise/blobs/blob_kernel_test.cpp checks this against quadrature of the definition in 113-bit arithmetic, over
/// 12 decades of σ, u, |b|/σ and w_j/σ. There the error stays below a fiftieth of the bound.
/// The bound holds for the doubles that are given. `perturb` finds w_j and b from q0, p0 and x_j to 2e-19 |x_j - q0|,
/// which adds 4e-19 |x_j - q0| |b|/σ². Up to |x_j - q0| = 1e5 σ this is less than the bound. Beyond, it is a thousandth
/// of the error that the rounding of q0 or p0 to doubles has caused already.
///
/// Method. δ = u/σ. The tails area(x) and moment(x) are those of noise/math/erf.h. The table shows I1; blob_kernel.cpp
/// treats the other integrals likewise. Each form takes out the Gaussian of the point nearest to x_j, which then forms
/// one exponential with e^{-|b|²/σ²}:
///
///   region                           form of I1/σ²                                        loses
///   short   δ (|a| + |c|) <= 1/4     24 terms of a Taylor series about the nearest point  nothing
///   behind  0 <= a                   δ area(a) - moment(a) + e^{a²-c²} moment(c)          < 2 digits
///   beyond  c <= 0                   moment(-c) - e^{c²-a²} (moment(-a) + δ area(-a))     < 2 digits
///   inside  a < 0 < c                c E + (e^{-c²} - e^{-a²})/2,                         < 2 digits
///                                    E = √π - e^{-a²} area(-a) - e^{-c²} area(c)
///   whole   a < -8, 8 < c            c √π: the tails are below 1e-27                      nothing
///
/// Each form keeps the bound over the whole of its region. Exponents, lengths and factors are long double, which on
/// x86-64 is the 80-bit format. Its + - * / give the same bits on every processor. Exponents so keep their digits (e^-t
/// multiplies their relative error by t), and no intermediate result over- or underflows (range 1e±4932).
///
/// Results are finite for every finite input: whatever exceeds the doubles saturates at ±DBL_MAX. u <= 0 or sigma <= 0
/// give zero.
///
/// Cost of a call of `perturb` on a loaded server core: 0.18 µs (behind, beyond) to 0.25 µs (inside), and 0.06 µs where
/// the result vanishes or the whole blob is passed. noise/blobs/blob_profile.h serves pixels, in single precision.
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

/// The integrals along a ray, without the factor -(2 n_j/σ²) e^{-|b|²/σ²}.
struct BlobIntegrals {
    double I1;   ///< [m²] >= 0
    double J2;   ///< [m³]
    double dI1;  ///< dI1/du [m] >= 0
    double dJ2;  ///< dJ2/du [m²]
};

/// w_j: place of the ray's closest approach [m], of any sign. u: length of the ray [m].
BlobIntegrals blob_integrals(double sigma, double w_j, double u);

struct Perturbation {
    dvec3 x1;   ///< displacement of the ray's end [m]
    dvec3 dx1;  ///< dx1/du, change of its direction
};

/// Perturbation by one blob of the ray q0 + w p0 of length u [m], |p0| = 1 up to rounding. Those of all blobs add up.
Perturbation perturb(const Blob& blob, dvec3 q0, dvec3 p0, double u);

/// The same, given the closest approach at w_j. b leads from the blob's centre to the ray and is perpendicular to p0.
Perturbation perturb_at(double sigma, double n, dvec3 b, double w_j, dvec3 p0, double u);

}  // namespace eikonal
