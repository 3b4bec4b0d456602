/// Perturbation by a blob against quadrature of its definition in 113-bit arithmetic, to the errors that the header
/// states; and the integrals of the paper's Appendix A, as printed and as corrected.
#include "noise/blobs/blob_kernel.h"

#include <gtest/gtest.h>
#include <quadmath.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "noise/math/erf.h"
#include "tests/noise/blobs/random_numbers.h"

namespace eikonal {
namespace {

using Quad = __float128;
using Quad3 = std::array<Quad, 3>;

Quad3 quad(dvec3 v) {
    return {v.x, v.y, v.z};
}
Quad dot(const Quad3& a, const Quad3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Gauss-Legendre of 16 points on [-1, 1], by Newton's iteration on P16.
struct Rule {
    static constexpr int kPoints = 16;
    std::array<Quad, kPoints> x, weight;
    Rule() {
        for (int i = 0; i < kPoints; ++i) {
            Quad z = std::cos(M_PI * (i + 0.75) / (kPoints + 0.5)), derivative = 0;
            for (int iteration = 0; iteration < 8; ++iteration) {
                Quad p = 1, previous = 0;
                for (int k = 1; k <= kPoints; ++k) {
                    const Quad next = ((2 * k - 1) * z * p - (k - 1) * previous) / k;
                    previous = p;
                    p = next;
                }
                derivative = kPoints * (z * p - previous) / (z * z - 1);
                z -= p / derivative;
            }
            x[i] = z;
            weight[i] = 2 / ((1 - z * z) * derivative * derivative);
        }
    }
};

// A ray past a blob: r(w) = start + w p0 from the blob's centre, 0 <= w <= u.
struct Ray {
    Quad3 start, p0;
    Quad sigma, n, u;
};

// Components of ∫₀^u (u - w) ∇n dw and ∫₀^u ∇n dw, and the same of the integrands' absolute values: along `side` and
// p0.
struct Definition {
    Quad3 x1{}, dx1{};
    Quad side_x1 = 0, side_dx1 = 0, along_x1 = 0, along_dx1 = 0;
};

Definition integrate(const Ray& ray, const Quad3& side) {
    static const Rule rule;
    // Only the stretch where the Gaussian is within e^-85 of its largest value on the ray counts.
    const Quad closest = -dot(ray.start, ray.p0) / dot(ray.p0, ray.p0);
    const Quad nearest = closest < 0 ? 0 : (closest > ray.u ? ray.u : closest);
    const Quad off = (nearest - closest) / ray.sigma;
    const Quad reach = ray.sigma * sqrtq(off * off + 85);
    const Quad ends[4] = {closest - reach, 0, closest + reach, ray.u};
    const Quad lo = ends[0] > ends[1] ? ends[0] : ends[1], hi = ends[2] < ends[3] ? ends[2] : ends[3];
    Definition sum;
    constexpr int kPanels = 10;
    const auto panel = [&](Quad from, Quad to) {
        for (int i = 0; i < Rule::kPoints; ++i) {
            const Quad w = (from + to) / 2 + (to - from) / 2 * rule.x[i];
            Quad3 r;
            for (int k = 0; k < 3; ++k) r[k] = ray.start[k] + w * ray.p0[k];
            const Quad gradient = -2 * ray.n / (ray.sigma * ray.sigma) * expq(-dot(r, r) / (ray.sigma * ray.sigma));
            const Quad weight = (to - from) / 2 * rule.weight[i] * gradient;
            for (int k = 0; k < 3; ++k) {
                sum.dx1[k] += weight * r[k];
                sum.x1[k] += weight * (ray.u - w) * r[k];
            }
            const Quad size_side = fabsq(weight * dot(r, side)), size_along = fabsq(weight * dot(r, ray.p0));
            sum.side_dx1 += size_side;
            sum.side_x1 += size_side * (ray.u - w);
            sum.along_dx1 += size_along;
            sum.along_x1 += size_along * (ray.u - w);
        }
    };
    // Panels end at the closest point, where the absolute integrand has a kink.
    const Quad cut = closest > lo && closest < hi ? closest : lo;
    for (int k = 0; k < kPanels && cut > lo; ++k) {
        panel(lo + (cut - lo) * k / kPanels, lo + (cut - lo) * (k + 1) / kPanels);
    }
    for (int k = 0; k < kPanels; ++k) panel(cut + (hi - cut) * k / kPanels, cut + (hi - cut) * (k + 1) / kPanels);
    return sum;
}

// |error| in units of the bound. Where the exact value is not a normal double, 1e-300 is enough.
double relative(double value, Quad exact, Quad scale) {
    if (!std::isfinite(value)) return std::numeric_limits<double>::infinity();
    const Quad error = fabsq(value - exact);
    if (scale < std::numeric_limits<double>::min()) return error <= 1e-300 ? 0 : 1;
    return static_cast<double>(error / scale);
}

// One blob seen along z, offset b along x, and the worst of all eight errors.
double worst_error(double sigma, double n, double b, double w_j, double u) {
    const Definition exact = integrate({{b, 0, -Quad(w_j)}, {0, 0, 1}, sigma, n, u}, {1, 0, 0});
    const Perturbation p = perturb_at(sigma, n, {b, 0, 0}, w_j, {0, 0, 1}, u);
    double worst =
        std::max({relative(p.x1.x, exact.x1[0], exact.side_x1), relative(p.x1.z, exact.x1[2], exact.along_x1),
                  relative(p.dx1.x, exact.dx1[0], exact.side_dx1), relative(p.dx1.z, exact.dx1[2], exact.along_dx1)});
    EXPECT_EQ(p.x1.y, 0);
    EXPECT_EQ(p.dx1.y, 0);

    // The integrals alone: the same without the factors that the definition gives them.
    const Quad ratio = Quad(b) / sigma, along = -2 * Quad(n) / (Quad(sigma) * sigma) * expq(-ratio * ratio);
    const Quad side = along * b;
    if (b == 0 || fabsq(ratio) > 100) return worst;
    const BlobIntegrals f = blob_integrals(sigma, w_j, u);
    return std::max({worst, relative(f.I1, exact.x1[0] / side, exact.side_x1 / fabsq(side)),
                     relative(f.J2, exact.x1[2] / along, exact.along_x1 / fabsq(along)),
                     relative(f.dI1, exact.dx1[0] / side, exact.side_dx1 / fabsq(side)),
                     relative(f.dJ2, exact.dx1[2] / along, exact.along_dx1 / fabsq(along))});
}

TEST(BlobKernel, GaussianTails) {
    double worst = 0;
    for (double x = 1e-12; x < 60; x = x < 0.01 ? x * 3 : x + 0.0037) {
        const auto [area, moment] = portable::gaussian_tails(x);
        const Quad exact = sqrtq(acosq(-1)) / 2 * expq(Quad(x) * x) * erfcq(x);
        worst = std::max({worst, relative(area, exact, exact), relative(moment, 0.5 - x * exact, 0.5 - x * exact)});
    }
    for (double x = 60; x < portable::kGaussianTailsLimit; x *= 1.7) {  // asymptotic series
        const auto [area, moment] = portable::gaussian_tails(x);
        const Quad y = 0.5 / (Quad(x) * x), moment_series = y * (0.5 - y * (1.5 - y * (7.5 - y * (52.5 - y * 472.5))));
        const Quad exact = (0.5 - moment_series) / x;
        worst = std::max({worst, relative(area, exact, exact), relative(moment, moment_series, moment_series)});
    }
    EXPECT_LT(worst, portable::kGaussianTailsError);
    EXPECT_GT(worst, portable::kGaussianTailsError / 20) << "the stated error is far from what is reached";
    const auto [area, moment] = portable::gaussian_tails(0);
    EXPECT_NEAR(area, portable::kSqrtPi / 2, 1e-15);
    EXPECT_NEAR(moment, 0.5, 1e-15);
}

// Parameters over twelve decades. The result differs from zero only if |b| and the distance to the blob are below about
// 27 σ. The five kinds of ray make sure that this holds for most rays.
TEST(BlobKernel, DefinitionOverTwelveDecades) {
    Random random(3);
    double worst = 0;
    int normal = 0;
    for (int i = 0; i < 4000; ++i) {
        const double sigma = decades(random, -6, 6);
        double u = sigma * decades(random, -6, 6), w_j = 0, b = sigma * decades(random, -6, 1.43);
        switch (i % 5) {
            case 0:  // anything
                w_j = sign(random) * sigma * decades(random, -6, 6);
                b = sigma * decades(random, -6, 6);
                break;
            case 1:  // on the way
                w_j = u * uniform(random, 0, 1);
                break;
            case 2:  // behind
                w_j = -sigma * decades(random, -6, 1.43);
                break;
            case 3:  // beyond
                w_j = u + sigma * decades(random, -6, 1.43);
                break;
            default:  // the camera within the blob
                w_j = sign(random) * sigma * decades(random, -6, 0);
                u = sigma * decades(random, -6, 1.5);
        }
        const double error = worst_error(sigma, 1e-5 * sign(random), sign(random) * b, w_j, u);
        EXPECT_LT(error, kBlobKernelError) << "sigma " << sigma << " b/s " << b / sigma << " a " << -w_j / sigma
                                           << " c " << (u - w_j) / sigma << " delta " << u / sigma;
        worst = std::max(worst, error);
        normal += std::abs(perturb_at(sigma, 1, {b, 0, 0}, w_j, {0, 0, 1}, u).x1.x) > 1e-300;
    }
    EXPECT_GT(normal, 2000);
    EXPECT_LT(worst, kBlobKernelError / 50) << "the header says so";
}

// Both sides of every border between the forms, and of a = 0 and c = 0, down to the last bits.
TEST(BlobKernel, BordersBetweenForms) {
    for (const double near : {0.0, 1e-9, 0.01, 0.2, 0.5, 1.0, 3.0, 10.0, 25.0}) {
        for (const double delta : {1e-7, 0.009, 0.1, 0.49999, 0.50001, 0.7, 1.2, 4.0, 30.0, 1e9}) {
            for (const double a :
                 {near, -near, -near - delta, -delta / 2, -delta * (1 - 1e-13), -delta * (1 + 1e-13)}) {
                EXPECT_LT(worst_error(1, 1, 0.3, -a, delta), kBlobKernelError) << "a " << a << " delta " << delta;
            }
        }
        const double threshold = std::sqrt(near * near + 0.25) - near;  // δ (2 near + δ) = ¼
        for (const double factor : {1 - 1e-12, 1.0, 1 + 1e-12}) {
            EXPECT_LT(worst_error(1, 1, 0.3, -near, threshold * factor), kBlobKernelError) << near;
            EXPECT_LT(worst_error(1, 1, 0.3, near + threshold, threshold * factor), kBlobKernelError) << near;
        }
    }
}

// A large exponent, with a strength that brings the result back from underflow. J2 and dJ2 have the same sign, so the
// error is relative.
TEST(BlobKernel, ExtremesKeepTheirDigits) {
    constexpr double kSide = 26.7;  // e^-713
    EXPECT_LT(worst_error(1, 1e10, kSide, 0.3, 2), kBlobKernelError);
    EXPECT_LT(worst_error(1, 1e300, 36, -2, 2), kBlobKernelError);
    EXPECT_GT(std::abs(perturb_at(1, 1e300, {36, 0, 0}, -2, {0, 0, 1}, 2).x1.x), 1e-300);
    EXPECT_LT(worst_error(1e-300, 1e-5, 1e-301, 30e-300, 1e300), kBlobKernelError);
    EXPECT_LT(worst_error(1e150, 1e-5, 3e149, 1e149, 1e-150), kBlobKernelError);
    EXPECT_LT(worst_error(1e-160, 1e-5, 3e-161, 1e-161, 1e-159), kBlobKernelError);
    // A whole pass at ratios that quadrature cannot follow: -2√π n b (u - w_j)/σ e^{-b²/σ²}
    const double x1 = perturb_at(1e-300, 1, {1e-300, 0, 0}, 1e290, {0, 0, 1}, 1e300).x1.x;
    EXPECT_NEAR(x1 / (-2 * portable::kSqrtPi * std::exp(-1) * (1e300 - 1e290)), 1, 1e-14);
}

// Oblique rays from q0: closest approach included. Rounding x1 itself to doubles mixes the components a little.
TEST(BlobKernel, ObliqueRays) {
    Random random(4);
    for (int i = 0; i < 1000; ++i) {
        const auto direction = [&] {
            dvec3 v;
            double square;
            do {
                v = {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
                square = v.x * v.x + v.y * v.y + v.z * v.z;
            } while (square > 1 || square < 0.1);
            return v / std::sqrt(square);
        };
        const double sigma = decades(random, -3, 3), distance = sigma * decades(random, -2, 4);
        const dvec3 p0 = direction(), q0 = direction() * distance;
        const Blob blob{q0 + p0 * distance + direction() * sigma * uniform(random, 0, 4), sigma, -1e-5};
        const double u = distance * decades(random, -1, 1);
        const Quad3 start = {Quad(q0.x) - blob.center.x, Quad(q0.y) - blob.center.y, Quad(q0.z) - blob.center.z};
        const Definition exact = integrate({start, quad(p0), sigma, blob.n, u}, {1, 0, 0});
        const Perturbation p = perturb(blob, q0, p0, u);
        const Quad size_x1 = sqrtq(dot(exact.x1, exact.x1)), size_dx1 = sqrtq(dot(exact.dx1, exact.dx1));
        for (int k = 0; k < 3; ++k) {
            EXPECT_LT(relative(p.x1[k], exact.x1[k], size_x1), kBlobKernelError) << distance / sigma;
            EXPECT_LT(relative(p.dx1[k], exact.dx1[k], size_dx1 + exact.along_dx1), kBlobKernelError)
                << distance / sigma;
        }
    }
}

TEST(BlobKernel, WholePassBendsByItsCheckValue) {
    const Blob blob{{0, 0, 0}, 0.1, -1e-5};
    const Perturbation p = perturb(blob, {0.05, 0, -1000}, {0, 0, 1}, 2000);
    const double angle = -2 * portable::kSqrtPi * blob.n * (0.05 / 0.1) * std::exp(-0.25);
    EXPECT_NEAR(angle, 13.804e-6, 5e-10);
    EXPECT_NEAR(p.dx1.x, angle, 1e-14 * angle);
    EXPECT_NEAR(p.x1.x, angle * 1000, 1e-14 * angle * 1000);
}

TEST(BlobKernel, ZeroAndDegenerateInput) {
    const Blob blob{{0, 0, 0}, 0.1, -1e-5};
    const auto is_zero = [](const Perturbation& p) { return p.x1 == dvec3(0, 0, 0) && p.dx1 == dvec3(0, 0, 0); };
    EXPECT_TRUE(is_zero(perturb(blob, {0.05, 0, -1}, {0, 0, 1}, 0)));
    EXPECT_TRUE(is_zero(perturb({{0, 0, 0}, 0.1, 0}, {0.05, 0, -1}, {0, 0, 1}, 2)));
    EXPECT_TRUE(is_zero(perturb({{0, 0, 0}, 0, 1}, {0.05, 0, -1}, {0, 0, 1}, 2)));
    EXPECT_TRUE(is_zero(perturb({{0, 0, 0}, -1, 1}, {0.05, 0, -1}, {0, 0, 1}, 2)));
    EXPECT_TRUE(is_zero(perturb(blob, {5, 0, -1}, {0, 0, 1}, 2)));
    // Through the centre: no bending sideways, exactly.
    const Perturbation p = perturb(blob, {0, 0, -1}, {0, 0, 1}, 2);
    EXPECT_EQ(p.x1.x, 0);
    EXPECT_NE(p.x1.z, 0);
}

TEST(BlobKernel, FiniteForEveryFiniteInput) {
    constexpr double kMax = std::numeric_limits<double>::max();
    constexpr std::array<double, 13> kSizes = {0, 5e-324, 1e-310, 1e-300, 1e-160, 1e-12, 0.3,
                                               1, 1e12,   1e155,  1e300,  1e308,  kMax};
    Random random(5);
    const auto any = [&] { return sign(random) * kSizes[random() % kSizes.size()]; };
    const auto any3 = [&] { return dvec3(any(), any(), any()); };
    const auto finite = [](dvec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
    for (int i = 0; i < 200000; ++i) {
        const Blob blob{any3(), any(), any()};
        const dvec3 q0 = any3(), p0 = i % 2 == 0 ? dvec3(0, 0, 1) : any3(), b = any3();
        const double w_j = any(), u = any();
        const Perturbation p = perturb(blob, q0, p0, u), at = perturb_at(blob.sigma, blob.n, b, w_j, p0, u);
        const BlobIntegrals f = blob_integrals(blob.sigma, w_j, u);
        ASSERT_TRUE(finite(p.x1) && finite(p.dx1) && finite(at.x1) && finite(at.dx1)) << i;
        ASSERT_TRUE(std::isfinite(f.I1) && std::isfinite(f.J2) && std::isfinite(f.dI1) && std::isfinite(f.dJ2)) << i;
        ASSERT_TRUE(f.I1 >= 0 && f.dI1 >= 0) << i;
    }
}

// --- The paper's Appendix A ------------------------------------------------------------------------------------------
// It splits r = (q0 - x_j) + w p0, so that x1 = -(2 n_j/σ²) W(|b|) [ I_first (q0 - x_j) + I_second p0 ] with W(r) =
// e^{-r²/σ²},
//     I_first  = ∫₀^u (u - w) e^{-(w - w_j)²/σ²} dw      I_second = ∫₀^u (u - w) w e^{-(w - w_j)²/σ²} dw
// (physical convention; the paper's is half of it). Here as printed, and with its misprints corrected:

struct AppendixA {
    double first, second;
};

AppendixA appendix_a(double sigma, double w_j, double u, bool corrected) {
    const double a = -w_j / sigma, c = (u - w_j) / sigma, s2 = sigma * sigma;
    const double bracket = (corrected ? portable::kSqrtPi / 2 : 1) * (std::erf(c) - std::erf(a));
    const double ending = 0.5 * s2 * (w_j * std::exp(-c * c) + (u - w_j) * std::exp(-a * a));
    return {sigma * (u - w_j) * bracket + 0.5 * s2 * (std::exp(-c * c) - std::exp(-a * a)),
            sigma * (w_j * (u - w_j) - 0.5 * s2) * bracket + (corrected ? ending : 0)};
}

// Errors relative to the definition: of the two integrals, and of x1 along p0, second - w_j first.
struct AppendixErrors {
    double first, second, along;
};

AppendixErrors appendix_errors(double sigma, double w_j, double u, bool corrected) {
    const AppendixA f = appendix_a(sigma, w_j, u, corrected);
    const Definition exact = integrate({{sigma, 0, -Quad(w_j)}, {0, 0, 1}, sigma, 1, u}, {1, 0, 0});
    const Quad factor = -2 / (Quad(sigma) * sigma) * expq(-1), along_size = exact.along_x1 / fabsq(factor);
    const Quad first = exact.x1[0] / (factor * sigma), along = exact.x1[2] / factor, second = along + w_j * first;
    return {relative(f.first, first, first), relative(f.second, second, fabsq(second)),
            relative(f.second - w_j * f.first, along, along_size)};
}

TEST(BlobAppendixA, PrintedIntegralsAreWrongByOrderOne) {
    for (const double w_j : {0.3, 1.0, 1.7}) {  // an ordinary blob of σ = 0.4 on a ray of 2 m
        const AppendixErrors printed = appendix_errors(0.4, w_j, 2, false);
        EXPECT_GT(printed.first, 0.1) << w_j;
        EXPECT_GT(printed.second, 0.1) << w_j;
        const AppendixErrors corrected = appendix_errors(0.4, w_j, 2, true);
        EXPECT_LT(corrected.first, 1e-13) << w_j;
        EXPECT_LT(corrected.second, 1e-13) << w_j;
        EXPECT_LT(worst_error(0.4, 1, 0.2, w_j, 2), kBlobKernelError);
    }
}

TEST(BlobAppendixA, PrintedDerivativeOfTheProfileLacksAFactor) {
    const double sigma = 0.1, h = 1e-6;
    const auto W = [&](double r) { return std::exp(-r * r / (sigma * sigma)); };
    for (const double r : {0.02, 0.05, 0.2}) {
        const double difference = (W(r + h) - W(r - h)) / (2 * h);
        const double printed = -2 / (sigma * sigma) * W(r), corrected = printed * r;
        EXPECT_NEAR(corrected / difference, 1, 1e-7);
        EXPECT_GT(std::abs(printed / difference - 1), 1);
    }
}

// The form of the appendix loses digits even after correction, for short rays and for blobs behind, beyond and far
// away. Ours does not.
TEST(BlobAppendixA, CorrectedButNotRearrangedFailsAtTheExtremes) {
    struct Case {
        const char* what;
        double w_j, u, least_first, least_along;
    };
    for (const Case& c : {Case{"short", 0.3, 1e-7, 1e-4, 1e-4}, Case{"behind", -7, 20, 0.5, 1e-3},
                          Case{"beyond", 27, 20, 0.5, 0.5}, Case{"far", 1e9, 1e9 + 2, 0, 1e-9}}) {
        const AppendixErrors error = appendix_errors(1, c.w_j, c.u, true);
        EXPECT_GE(error.first, c.least_first) << c.what;
        EXPECT_GE(error.along, c.least_along) << c.what;
        EXPECT_LT(worst_error(1, 1, 0.5, c.w_j, c.u), kBlobKernelError) << c.what;
    }
}

// --- Single precision
// -------------------------------------------------------------------------------------------------

}  // namespace
}  // namespace eikonal
