#include "noise/blobs/blob_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "noise/math/erf.h"
#include "noise/math/portable_math.h"

namespace eikonal {
namespace {

using Wide = long double;
using Wide3 = glm::vec<3, Wide>;
static_assert(std::numeric_limits<Wide>::digits == 64 && std::numeric_limits<Wide>::max_exponent == 16384,
              "80-bit long double, as on x86-64");

/// e^-t is a normal Wide for t < 11355. Beyond the limit here, the product with any doubles n_j, b, u and 1/σ (each
/// within 1e±324) is too small for a double.
constexpr Wide kNegligibleExponent = 1.1e4L;

/// e^-t for t >= 0, to about kExpError.
Wide exp_minus(Wide t) {
    if (t > kNegligibleExponent) return 0;
    constexpr Wide kLog2E = 1.442695040888963407359924681001892137L;
    constexpr Wide kLn2Hi = 0x1.62e42fefa38p-1L;  // 43 bits: its product with k is exact
    constexpr Wide kLn2Lo = 0x1.ef35793c7673007ep-45L;
    const int k = static_cast<int>(t * kLog2E + 0.5L);
    const Wide r = (t - k * kLn2Hi) - k * kLn2Lo;  // |r| <= ln2/2
    return std::ldexp(static_cast<Wide>(portable::exp(static_cast<double>(-r))), -k);
}

portable::GaussianTails tails(Wide x) {
    return portable::gaussian_tails(static_cast<double>(std::min(x, Wide{portable::kGaussianTailsLimit})));
}

/// The four integrals over [a, c] for σ = 1, divided by e^{-exponent}. The names are those of BlobIntegrals.
struct Profile {
    Wide i1, j2, e, g;  // dI1/du = σ e, dJ2/du = σ² g
    Wide exponent;
};

/// ∫₀¹ x^k e^{-px - qx²} dx for k = 0, 1, 2, by the Taylor series of the integrand, f_{k+1} = -(p f_k + 2q f_{k-1})/(k
/// + 1). For |p| and q <= ¼ the terms that are left out are below 1e-17.
std::array<double, 3> short_moments(double p, double q) {
    constexpr int kTerms = 24;
    constexpr auto kReciprocal = [] {
        std::array<double, kTerms + 3> r{};
        for (int k = 1; k < kTerms + 3; ++k) r[k] = 1.0 / k;
        return r;
    }();
    std::array<double, 3> m{};
    double f_previous = 0, f = 1;
    for (int k = 0; k < kTerms; ++k) {
        for (int i = 0; i < 3; ++i) m[i] += f * kReciprocal[k + 1 + i];
        const double f_next = -(p * f + 2 * q * f_previous) * kReciprocal[k + 1];
        f_previous = f;
        f = f_next;
    }
    return m;
}

/// Short rays. Either |s| grows from s = A, so that the ray moves away from x_j (from_start), or |s| falls to s = -A.
/// At most a little of the ray lies on the other side of x_j (A < 0). s = ±(A + δx), 0 <= x <= 1.
Profile short_ray(Wide A, Wide delta, bool from_start) {
    const auto p = static_cast<double>(2 * A * delta), q = static_cast<double>(delta * delta);
    const auto [m0, m1, m2] = short_moments(p, q);
    const Wide d2 = delta * delta;
    const Wide e = delta * m0, g = delta * (A * m0 + delta * m1);
    if (from_start) return {d2 * (m0 - m1), d2 * (A * (m0 - m1) + delta * (m1 - m2)), e, g, A * A};
    return {d2 * m1, -d2 * (A * m1 + delta * m2), e, -g, A * A};
}

Profile ray_past_blob_behind(Wide a, Wide c, Wide delta) {
    const auto [area_a, moment_a] = tails(a);
    const auto [area_c, moment_c] = tails(c);
    const Wide fall = exp_minus(delta * (a + c));  // e^{a² - c²}
    const Wide e = area_a - fall * area_c;
    return {delta * area_a - moment_a + fall * moment_c, (delta - e) / 2, e, (1 - fall) / 2, a * a};
}

Profile ray_towards_blob_beyond(Wide a, Wide c, Wide delta) {
    const auto [area_a, moment_a] = tails(-a);
    const auto [area_c, moment_c] = tails(-c);
    const Wide fall = exp_minus(-delta * (a + c));  // e^{c² - a²}
    return {moment_c - fall * (moment_a + delta * area_a), (fall * (area_a + delta) - area_c) / 2,
            area_c - fall * area_a, (fall - 1) / 2, c * c};
}

/// Tails farther out than this [σ] are negligible beside a whole pass, even if a ray of kLongPass σ multiplies them.
constexpr Wide kTail = 8, kLongPass = 1e8L;

Profile ray_across_blob(Wide a, Wide c, Wide delta) {
    if (a < -kTail && c > kTail && delta < kLongPass)
        return {c * portable::kSqrtPi, -portable::kSqrtPi / 2, portable::kSqrtPi, 0, 0};
    const Wide ea = exp_minus(a * a), ec = exp_minus(c * c);
    const Wide e = portable::kSqrtPi - ea * tails(-a).area - ec * tails(c).area;
    return {c * e + (ec - ea) / 2, (delta * ea - e) / 2, e, (ea - ec) / 2, 0};
}

/// e^{-b2} times the integrals over [a, c], b2 = |b|²/σ². The exponent is 0.
Profile profile(Wide b2, Wide a, Wide c, Wide delta) {
    const bool nearer_start = std::abs(a) <= std::abs(c);
    const Wide nearest = a < 0 && c > 0 ? 0 : (nearer_start ? a : c);
    if (!(b2 + nearest * nearest <= kNegligibleExponent)) return {};
    const bool is_short = delta * (std::abs(a) + std::abs(c)) <= 0.25L;
    const Profile f = is_short ? short_ray(nearer_start ? a : -c, delta, nearer_start)
                      : a >= 0 ? ray_past_blob_behind(a, c, delta)
                      : c <= 0 ? ray_towards_blob_beyond(a, c, delta)
                               : ray_across_blob(a, c, delta);
    const Wide scale = exp_minus(b2 + f.exponent);
    return {scale * f.i1, scale * f.j2, scale * f.e, scale * f.g, 0};
}

double saturated(Wide x) {
    constexpr Wide kLargest = std::numeric_limits<double>::max();
    return static_cast<double>(std::clamp(x, -kLargest, kLargest));
}

dvec3 saturated(Wide3 v) {
    return {saturated(v.x), saturated(v.y), saturated(v.z)};
}

Perturbation perturb_wide(Wide sigma, Wide n, Wide3 b, Wide w_j, Wide3 p0, Wide u) {
    if (!(u > 0) || !(sigma > 0)) return {};
    const Wide inverse = 1 / sigma;
    const Wide3 b_hat = b * inverse;
    const Profile f = profile(glm::dot(b_hat, b_hat), -w_j * inverse, (u - w_j) * inverse, u * inverse);
    return {saturated(-2 * n * (f.i1 * b + f.j2 * sigma * p0)), saturated(-2 * n * (f.e * b_hat + f.g * p0))};
}

}  // namespace

BlobIntegrals blob_integrals(double sigma, double w_j, double u) {
    if (!(u > 0) || !(sigma > 0)) return {};
    const Wide s = sigma, w = w_j, length = u;
    const Profile f = profile(0, -w / s, (length - w) / s, length / s);
    return {saturated(s * s * f.i1), saturated(s * s * s * f.j2), saturated(s * f.e), saturated(s * s * f.g)};
}

Perturbation perturb(const Blob& blob, dvec3 q0, dvec3 p0, double u) {
    const Wide3 p = p0, d = Wide3(blob.center) - Wide3(q0);
    const Wide p2 = glm::dot(p, p);  // 1 up to rounding. The division by it makes b perpendicular to the given p0.
    const Wide w_j = p2 > 0 ? glm::dot(d, p) / p2 : 0;
    return perturb_wide(blob.sigma, blob.n, w_j * p - d, w_j, p, u);
}

Perturbation perturb_at(double sigma, double n, dvec3 b, double w_j, dvec3 p0, double u) {
    return perturb_wide(sigma, n, b, w_j, p0, u);
}

}  // namespace eikonal
