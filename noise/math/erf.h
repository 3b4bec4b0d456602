/// Tails of the Gaussian, divided by its value where they begin. Portable like noise/math/portable_math.h: double
/// precision, and + - * / only.
///
///     area(x)   = e^{x²} ∫_x^∞ e^{-s²} ds          = (√π/2) erfcx(x)
///     moment(x) = e^{x²} ∫_x^∞ (s - x) e^{-s²} ds   = ½ - x area(x)
///
/// Hence erfc x = (2/√π) e^{-x²} area(x). Neither function underflows. `moment` does not suffer from the cancellation
/// on the right side above. Both are positive and fall with x, from √π/2 and ½ to 1/(2x) and 1/(4x²). Range: 0 <= x <=
/// kGaussianTailsLimit. Relative error: at most kGaussianTailsError (tests/noise/blobs/blob_kernel_test.cpp).
///
/// (x + 4) area and (x + 4)² moment are smooth functions of t = (x - 4)/(x + 4), which maps [0, ∞) to [-1, 1). They are
/// minimax polynomials in t, of degree 22 and 23, fitted by Remez exchange to 4e-17 and 2e-16.
#pragma once

#include <array>

namespace eikonal::portable {

inline constexpr double kGaussianTailsError = 4e-15;
inline constexpr double kGaussianTailsLimit = 1e100;
inline constexpr long double kSqrtPi = 1.772453850905516027298167483341145183L;

struct GaussianTails {
    double area, moment;
};

inline GaussianTails gaussian_tails(double x) {
    constexpr std::array<double, 23> kArea = {
        0.971300864958028522,    -0.865443777728148276,     0.685238370941828026,     -0.479319228044078671,
        0.293209585506758271,    -0.15421317790525489,      0.0676913551111711427,    -0.0233698512952775482,
        0.00541666836797634633,  -0.000248993320788918339,  -0.000403280343295299607, 0.000156696331656848795,
        -3.22027254519823918e-6, -0.0000167151604698953753, 4.15761461468207496e-6,   1.26231111386986809e-6,
        -7.46528946518632025e-7, -6.69052778640917456e-8,   1.07702272244475625e-7,   5.38403347612165584e-10,
        -1.31492226735916708e-8, 2.72606043091519084e-10,   9.96876428024625341e-10};
    constexpr std::array<double, 24> kMoment = {
        0.918372321343088416,     -1.55068214866998172,     1.74683639847886596,      -1.54505762710120073,
        1.11855690852932112,      -0.665713599061048354,    0.318714222442051798,     -0.115146078523083382,
        0.0254954773697446217,    0.000771434351925054316,  -0.00307987026744222793,  0.000959502180454721753,
        0.0000877114108970276879, -0.000146114422016883116, 0.0000217270740359463937, 0.0000160759774921963999,
        -5.79442786134128301e-6,  -1.57322238104942089e-6,  1.03341421386240494e-6,   1.34945368922444288e-7,
        -1.4836422993852873e-7,   -5.83152897972314562e-9,  1.29973156236653238e-8,   -6.24000615664423323e-10};
    const double inverse = 1 / (x + 4);
    const double t = (x - 4) * inverse;
    double area = kArea.back(), moment = kMoment.back() * t + kMoment[22];
    for (int k = 21; k >= 0; --k) {
        area = area * t + kArea[k];
        moment = moment * t + kMoment[k];
    }
    return {area * inverse, moment * inverse * inverse};
}

}  // namespace eikonal::portable
