// Media at the ends of their ranges (noise/README.md, "Extremes"). They agree with long double and quadrature, or are
// refused.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <variant>

#include "noise/base/error.h"
#include "noise/blobs/blobs.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/medium/optics.h"
#include "noise/medium/refractivity.h"
#include "noise/turbulence/gradient_noise/gradient_noise.h"
#include "noise/turbulence/lattice/lattice.h"
#include "noise/turbulence/lattice/lattice_instant.h"
#include "noise/turbulence/parameters/spectrum.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "noise/turbulence/screens/screens.h"

namespace eikonal {
namespace {

constexpr double kDenormal = std::numeric_limits<double>::denorm_min();

/// The message of the error of type E that an action throws; empty if it throws none.
template <class E, class Action>
std::string refusal(Action&& action) {
    try {
        action();
    } catch (const E& error) {
        return error.what();
    }
    return {};
}

void has(const std::string& message, std::initializer_list<std::string_view> fragments) {
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    for (const std::string_view fragment : fragments)
        EXPECT_NE(message.find(fragment), std::string::npos) << "no '" << fragment << "' in: " << message;
}

// n(T) - n(T_a) = (n0 - 1) T0 (1/T - 1/T_a), compared with a computation in 64 bits of mantissa.
TEST(Extremes, IndexFromOneKelvinToABillion) {
    for (const double Ta : {1.0, 150.0, 293.15, 1e5, 1e9})
        for (const double T : {1.0, 20.0, 293.15, 293.1500001, 1e3, 1e5, 1e9}) {
            const IndexLaw law = index_law(OpticsSpec{.ambient_temperature = Ta});
            const long double scale = (long double)law.refractivity * law.T0;
            const long double exact = scale * ((long double)Ta - T) / ((long double)T * Ta);
            EXPECT_NEAR(law.above_ambient(T), static_cast<double>(exact), 1e-15 * std::abs(exact)) << T << ' ' << Ta;
        }
}

// The formulae are computed by the C library in long double. The relative error of an exponential is the absolute error
// of its argument. This is some 1e-16 of (11/6) ln k², which is at most 120 here.
TEST(Extremes, SpectraOverTwentyFourDecades) {
    for (const double cn2 : {0.0, kDenormal, 1e-308, 1e-30, 1e-13, 1e-6, 1e12})
        for (const double l0 : {1e-12, 1e-6, 0.01, 1e6})
            for (const double L0 : {1e-6, 1.0, 1e9, 1e12}) {
                if (!(l0 < L0)) continue;
                TurbulenceSpec spec;
                spec.cn2 = spec.strength = cn2;
                spec.inner_scale = l0;
                spec.outer_scale = L0;
                const Spectrum von_karman(spec, 0);
                spec.spectrum = SpectrumKind::Paper;
                const Spectrum paper(spec, 1e-12);
                for (const double k : {0.0, 1e-12, 1e-6, 1.0, 1e6, 1e12}) {
                    const long double k0 = 2 * M_PIl / L0, km = 5.92L / l0, k2 = (long double)k * k;
                    const long double exact =
                        0.0330054L * cn2 * std::pow(k2 + k0 * k0, -11.0L / 6) * std::exp(-k2 / (km * km));
                    const double value = von_karman(k * k);
                    ASSERT_TRUE(std::isfinite(value)) << cn2 << ' ' << l0 << ' ' << L0 << ' ' << k;
                    // a denormal Cn² has few digits of its own
                    if (cn2 == 0 || (cn2 > 1e-300 && exact > 1e-290L && exact < 1e300L)) {
                        EXPECT_NEAR(value, static_cast<double>(exact), 1e-13 * static_cast<double>(exact))
                            << cn2 << ' ' << l0 << ' ' << L0 << ' ' << k;
                    }
                    const long double power = k > 0 ? cn2 * std::pow((long double)k, -11.0L / 3) : 0;
                    ASSERT_TRUE(std::isfinite(paper(k * k)));
                    if (cn2 == 0 || (cn2 > 1e-300 && power > 1e-290L)) {
                        EXPECT_NEAR(paper(k * k), static_cast<double>(power), 1e-13 * static_cast<double>(power));
                    }
                }
            }
    for (const double alpha : {0.0, kDenormal, 1e-12, 1.0, 1e12})
        for (const double kappa : {0.0, 1e-9, 1.0, 1e9})
            for (const double k : {0.0, 1e-9, 1.0, 1e12}) {
                const double rate = alpha * k * k, weight = temporal_weight(kappa, alpha, k * k);
                const double exact = rate > 0    ? static_cast<double>(std::exp(-(long double)kappa * kappa / rate))
                                     : kappa > 0 ? 0
                                                 : 1;
                EXPECT_NEAR(weight, exact, 1e-13) << alpha << ' ' << kappa << ' ' << k;
            }
}

TurbulenceSpec paper_lattice(double lowest) {
    TurbulenceSpec spec;
    spec.spectrum = SpectrumKind::Paper;
    spec.lowest_wavenumber = lowest;
    spec.lattice = {{16, 16, 16, 8}};
    spec.period = {{4.0, 4.0, 4.0, 4.0}};
    return spec;
}

// 16 samples resolve 7 cycles along an axis, and 7 √3 = 12.1 along the diagonal. The 8th is Nyquist's, which bends no
// light.
TEST(Extremes, ALowestWavenumberBeyondNyquistIsRefused) {
    for (const double lowest : {0.0, 2.0, 7.0, 12.1}) {
        const TurbulenceSpec spec = paper_lattice(lowest);
        EXPECT_GT(LatticeField(spec, choose_lattice(spec)).variance(), 0) << lowest;
    }
    for (const double lowest : {12.2, 1e12}) {
        const TurbulenceSpec spec = paper_lattice(lowest);
        has(refusal<UserError>([&] { LatticeField(spec, choose_lattice(spec)); }),
            {"lowest_wavenumber", "12.1", "lower it"});
    }
    TurbulenceSpec spec = paper_lattice(1e12);
    spec.lattice = {{64, 64, 1, 1}};
    const auto geometry = layout_screens(spec, {.far = 100, .half_width = 0.1, .half_height = 0.1, .pixel = 1e-3});
    has(refusal<UserError>([&] {
            ScreenField(spec, geometry, {1, 0, 0}, {0, 1, 0});
        }),
        {"lowest_wavenumber", "1e+12", "64 x 64"});
}

// Slabs fill the path for every ratio of its length to L0. No screen needs more memory than there is.
TEST(Extremes, ScreensAreLaidOutForEveryLengthAndScale) {
    for (const double far : {1e-6, 1.0, 1e3, 1e9, 1e12})
        for (const double L0 : {1e-6, 1.0, 1e6, 1e12})
            for (const double f_px : {1.0, 1e3, 1e7})
                for (const bool perspective : {true, false}) {
                    TurbulenceSpec spec;
                    spec.outer_scale = L0;
                    spec.inner_scale = 1e-3 * L0;
                    spec.alpha = 1e12;
                    ShotView view{perspective, far, 500 / f_px, 300 / f_px, 1 / f_px};
                    view.aperture = L0;
                    const auto screens = layout_screens(spec, view);
                    double end = 0;
                    for (const ScreenGeometry& s : screens) {
                        EXPECT_GT(s.thickness, 0);
                        EXPECT_NEAR(s.w, end + 0.5 * s.thickness, 1e-9 * far);
                        end += s.thickness;
                        EXPECT_TRUE(s.Lx > 0 && s.Ly > 0 && s.T > 0 && std::isfinite(s.Lx * s.Ly * s.T));
                        EXPECT_TRUE(s.nx >= 1 && s.ny >= 1 && s.nt >= 1);
                    }
                    EXPECT_NEAR(end, far, 1e-9 * far);
                    EXPECT_LE(screens.size(), static_cast<std::size_t>(kMostScreens));
                    EXPECT_LT(screens_bytes(spec, screens), 16e9) << far << ' ' << L0 << ' ' << f_px;
                }
}

// Multiplying every length by a power of two gives the same air (k, x and the period scale alike, Cn² by
// length^(-2/3)).
TEST(Extremes, GradientNoiseAndLatticesHaveNoScaleOfTheirOwn) {
    const auto scaled = [](double s) {
        TurbulenceSpec spec;
        spec.cn2 = 1e-12 * std::pow(s, -2.0 / 3);
        spec.outer_scale = s;
        spec.inner_scale = 0.25 * s;
        spec.alpha = 0.3 * s * s;
        spec.velocity = {0.25 * s, 0, 0};
        spec.lattice = {{8, 8, 8, 4}};
        spec.period = {{2 * s, 2 * s, 2 * s, 4.0}};
        return spec;
    };
    const GradientNoiseField noise(scaled(1));
    const LatticeField lattice(scaled(1), choose_lattice(scaled(1)));
    const LatticeInstant snapshot(lattice, 1.5);
    for (const double s : {0x1p-36, 0x1p-20, 0x1p20, 0x1p33}) {
        const GradientNoiseField other_noise(scaled(s));
        const LatticeField other_lattice(scaled(s), choose_lattice(scaled(s)));
        const LatticeInstant other(other_lattice, 1.5);
        for (int i = 0; i < 50; ++i) {
            const dvec3 x(0.31 * i, 2 - 0.17 * i, 0.05 * i * i);
            const auto same = [&](const IndexSample& a, const IndexSample& b, double rms) {
                EXPECT_NEAR(b.n, a.n, 1e-5 * rms) << s;
                for (int axis = 0; axis < 3; ++axis)
                    EXPECT_NEAR(s * b.gradient[axis], a.gradient[axis], 1e-4 * rms) << s;
            };
            const double rms = std::sqrt(lattice.variance());
            same(noise.sample(x, 1.5), other_noise.sample(s * x, 1.5), rms);
            same(snapshot.sample(x), other.sample(s * x), rms);
        }
    }
}

TEST(Extremes, SourcesHaveATimeUpToABillionSeconds) {
    BlobsSpec spec;
    spec.blobs = {{{0, 0, -3}, 0.2, 600}};
    const IndexLaw law = index_law({});
    EXPECT_EQ(BlobCloud(spec, law, "medium.0").at(1e300).size(), 1) << "stands still for ever";
    spec.sources = {{.rate = 20, .lifetime = 5}};
    spec.wind = WindSpec{};
    const BlobCloud cloud(spec, law, "medium.0");
    for (const double t : {-kLatestTime, kLatestTime}) EXPECT_NEAR(static_cast<double>(cloud.at(t).size()), 101, 1);
    has(refusal<FrameError>([&] { cloud.at(1.1e9); }), {"medium.0", "1.1e+09", "first_frame"});
}

}  // namespace
}  // namespace eikonal
