/// The lattice compared with its own discrete expectation, in space and in time.
///
/// Statistical tests pool a sum of many squared Gaussians, whose z-score is known, and compare it with kWorstZ: the
/// two-sided 1e-4 quantile after Bonferroni's correction for some 200 comparisons. Seeds are fixed.
#include "noise/turbulence/lattice/lattice.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "noise/base/error.h"
#include "noise/turbulence/lattice/lattice_instant.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "tests/noise/trigonometric_sum.h"
#include "tests/noise/turbulence/lattice_boxes.h"

namespace eikonal {
namespace {

constexpr double kWorstZ = 5.0;

TEST(Lattice, StructureFunctionOfPureKolmogorov) {
    TurbulenceSpec spec;
    spec.cn2 = 1;
    spec.outer_scale = 1e9;
    spec.inner_scale = 1e-9;
    spec.alpha = 0;
    const LatticeField field(spec, {{128, 128, 128, 1}, {1, 1, 1, 1}});
    constexpr std::array expected{0.480, 0.678, 0.790, 0.853, 0.872, 0.829, 0.652};  // PHYSICS.md#turbulence
    for (int i = 0; i < 7; ++i) {
        const double cells = 1 << i;
        EXPECT_NEAR(field.structure_function(i % 3, cells) / std::pow(cells / 128, 2.0 / 3), expected[i], 1e-3)
            << cells;
    }
}

TEST(Lattice, RealisationsHaveTheExpectedStructureFunction) {
    constexpr int kSeeds = 300;
    const LatticeGeometry g{{12, 16, 10, 1}, {1.0, 1.3, 0.9, 2.0}};
    for (const SpectrumKind kind : {SpectrumKind::VonKarman, SpectrumKind::Paper})
        for (int axis = 0; axis < 3; ++axis)
            for (const int r : {1, 2, 5}) {
                double sum = 0, sum2 = 0, expected = 0;
                for (int seed = 0; seed < kSeeds; ++seed) {
                    TurbulenceSpec spec = air(static_cast<std::uint64_t>(seed) + 100);
                    spec.spectrum = kind;
                    spec.lowest_wavenumber = 1;
                    const LatticeField field(spec, g);
                    expected = field.structure_function(axis, r);
                    const auto n = samples_of(field.spectrum_at(0), g);
                    const auto at = [&](int x, int y, int z) {
                        return n[static_cast<std::size_t>(((x % 12) * 16 + y % 16) * 10 + z % 10)];
                    };
                    double d = 0;
                    for (int x = 0; x < 12; ++x)
                        for (int y = 0; y < 16; ++y)
                            for (int z = 0; z < 10; ++z) {
                                const double e = at(x, y, z) - at(x + (axis == 0 ? r : 0), y + (axis == 1 ? r : 0),
                                                                  z + (axis == 2 ? r : 0));
                                d += e * e / static_cast<double>(n.size());
                            }
                    sum += d;
                    sum2 += d * d;
                }
                const double mean = sum / kSeeds, error = std::sqrt((sum2 / kSeeds - mean * mean) / kSeeds);
                EXPECT_LT(std::abs(mean - expected), kWorstZ * error) << "axis " << axis << " r " << r;
                EXPECT_LT(error, 0.05 * expected);
            }
}

// Every mode's power divided by its expectation is χ² with two degrees of freedom, or one if it is its own conjugate.
// It is pooled over shells of |m|² and over seeds, at sample instants and between them, and for every α.
TEST(Lattice, ModePowerIsChiSquareForEveryAlphaAndInstant) {
    constexpr int kSeeds = 60, kBins = 4;
    for (const auto& g : {box(8, 6, 10, 4), box(7, 5, 9, 5), box(6, 8, 4, 2)})
        for (const double alpha : {0.0, 1e-6, 1.0, 1e3, 1e12})
            for (const double t : {0.0, 0.25 * g.period[3], 0.317 * g.period[3]}) {
                std::array<double, kBins> sum{}, freedom{};
                for (int seed = 0; seed < kSeeds; ++seed) {
                    const LatticeField field(air(static_cast<std::uint64_t>(seed), alpha), g);
                    const auto spectrum = field.spectrum_at(t);
                    std::size_t at = 0;
                    for (int ix = 0; ix < g.size[0]; ++ix)
                        for (int iy = 0; iy < g.size[1]; ++iy)
                            for (int iz = 0; iz < g.half(); ++iz, ++at) {
                                const int mx = signed_index(ix, g.size[0]), my = signed_index(iy, g.size[1]);
                                const double expected = field.mode_variance(mx, my, iz);
                                const int m2 = mx * mx + my * my + iz * iz;
                                if (m2 == 0) {
                                    EXPECT_EQ(spectrum[at], complex32(0, 0));
                                    continue;
                                }
                                // in the planes of conjugate pairs take one of each
                                const bool own_plane = iz == 0 || is_nyquist(iz, g.size[2]);
                                const int px = (g.size[0] - ix) % g.size[0], py = (g.size[1] - iy) % g.size[1];
                                const int row = ix * g.size[1] + iy, partner = px * g.size[1] + py;
                                if (own_plane && partner < row) continue;
                                const bool real = own_plane && partner == row;
                                const int bin = m2 < 4 ? 0 : (m2 < 12 ? 1 : (m2 < 24 ? 2 : 3));
                                sum[bin] += (real ? 1 : 2) * std::norm(std::complex<double>(spectrum[at])) / expected;
                                freedom[bin] += real ? 1 : 2;
                            }
                }
                for (int bin = 0; bin < kBins; ++bin) {
                    if (freedom[bin] == 0) continue;
                    EXPECT_LT(std::abs(sum[bin] - freedom[bin]) / std::sqrt(2 * freedom[bin]), kWorstZ)
                        << "alpha " << alpha << " t " << t << " bin " << bin;
                }
            }
}

TEST(Lattice, ModesLoseTheirMemoryAsAGaussian) {
    // The discrete correlation is exp(-αk²t²/4) if the lattice resolves both the width and the period of the
    // correlation.
    TurbulenceSpec spec = air(1, 0.02);
    const LatticeGeometry g{{8, 8, 8, 64}, {1, 1, 1, 20}};
    const LatticeField field(spec, g);
    for (const int m : {1, 2, 3})
        for (const double t : {0.1, 0.5, 1.0, 2.0, 3.3}) {
            const double k = 2 * M_PI * m;
            EXPECT_NEAR(field.mode_correlation(m, 0, 0, t), std::exp(-0.02 * k * k * t * t / 4), 1e-7) << m << ' ' << t;
        }
    // and in an ensemble: <n̂(t0) n̂*(t0 + t)> over modes of equal |m|
    constexpr int kSeeds = 400;
    for (const double t : {0.4, 1.1}) {
        double sum = 0, sum2 = 0, count = 0;
        for (int seed = 0; seed < kSeeds; ++seed) {
            const LatticeField one(air(static_cast<std::uint64_t>(seed), 0.02), g);
            const auto a = one.spectrum_at(5.3), b = one.spectrum_at(5.3 + t);
            for (const std::size_t at :
                 {std::size_t{1}, std::size_t{1 * 5}, std::size_t{8 * 5}}) {  // (0,0,1), (0,1,0), (1,0,0)
                const double c = std::real(std::complex<double>(a[at]) * std::conj(std::complex<double>(b[at]))) /
                                 one.mode_variance(0, 0, 1);
                sum += c;
                sum2 += c * c;
                ++count;
            }
        }
        const double mean = sum / count, error = std::sqrt((sum2 / count - mean * mean) / count);
        EXPECT_LT(std::abs(mean - field.mode_correlation(1, 0, 0, t)), kWorstZ * error);
    }
}

TEST(Lattice, SpectrumIsHermitian) {
    for (const auto& g : {box(8, 6, 10, 4), box(7, 5, 9, 3), box(2, 2, 2, 2), box(6, 5, 4, 1)}) {
        TurbulenceSpec spec = air();
        spec.velocity = {0.3, -1.1, 0.7};
        const LatticeField field(spec, g);
        const auto half = field.spectrum_at(0.77);
        const FftPlan plan(FftPlan::Kind::ComplexToComplex, std::array{g.size[0], g.size[1], g.size[2]});
        FftVector<complex32> full(plan.spectrum_size()), out(plan.spectrum_size());
        for (int x = 0; x < g.size[0]; ++x)
            for (int y = 0; y < g.size[1]; ++y)
                for (int z = 0; z < g.size[2]; ++z) {
                    const auto at = [&](int i, int j, int l) {
                        return half[static_cast<std::size_t>((i * g.size[1] + j) * g.half() + l)];
                    };
                    full[static_cast<std::size_t>((x * g.size[1] + y) * g.size[2] + z)] =
                        z < g.half()
                            ? at(x, y, z)
                            : std::conj(at((g.size[0] - x) % g.size[0], (g.size[1] - y) % g.size[1], g.size[2] - z));
                }
        plan.execute(full.data(), out.data());
        double real = 0, imaginary = 0;
        for (const auto& v : out) {
            real = std::max(real, std::abs(double{v.real()}));
            imaginary = std::max(imaginary, std::abs(double{v.imag()}));
        }
        EXPECT_GT(real, 0);
        EXPECT_LT(imaginary, 1e-5 * real);
    }
}

TEST(Lattice, WholePeriodEqualsItsInstants) {
    for (const auto& g : {box(8, 6, 10, 4), box(5, 7, 3, 5), box(4, 4, 4, 1), box(3, 2, 5, 2), box(3, 2, 501, 31)})
        for (const double alpha : {0.0, 1e-3, 0.5, 1e12}) {
            const LatticeField field(air(5, alpha), g);
            PeriodSynthesis synthesis(field);
            for (const Component what : {Component::Index, Component::ForceX, Component::ForceY, Component::ForceZ}) {
                const FftVector<float> period = field.synthesize_period(what);
                EXPECT_EQ(worst_difference(period, synthesis(what)), 0);
                for (int m = 0; m < g.size[3]; ++m) {
                    const auto instant = node_field(field, m * g.period[3] / g.size[3], what);
                    const std::span<const float> slice(period.data() + static_cast<std::size_t>(m) * instant.size(),
                                                       instant.size());
                    EXPECT_LE(worst_difference(slice, instant), 1e-5 * rms(period)) << m << ' ' << alpha;
                }
            }
        }
}

TEST(Lattice, LoopIsSeamlessAndAnyTimeIsFinite) {
    const auto g = box(8, 6, 10, 8);
    const LatticeField field(air(), g);
    EXPECT_EQ(field.spectrum_at(0), field.spectrum_at(g.period[3]));
    EXPECT_EQ(field.spectrum_at(0.25), field.spectrum_at(0.25 + 1024 * g.period[3]));
    TurbulenceSpec spec = air();
    spec.velocity = {1.0, 1.3, -0.9};  // one period of space a second, two in T
    const LatticeField moving(spec, g);
    EXPECT_EQ(moving.spectrum_at(0), moving.spectrum_at(g.period[3]));
    for (const double t : {-3.3, 1e9, -1e9, 1e9 + 1.0 / 3}) {
        const auto n = samples_of(moving.spectrum_at(t), g);
        EXPECT_GT(rms(n), 0.3 * std::sqrt(moving.variance()));
        EXPECT_LT(rms(n), 3 * std::sqrt(moving.variance()));
    }
}

TEST(Lattice, AdvectionByACellIsAnIndexShift) {
    const LatticeGeometry g{{8, 6, 10, 1}, {1, 1.5, 2, 1}};
    for (int axis = 0; axis < 3; ++axis) {
        TurbulenceSpec spec = air(9, 0);
        const auto still = samples_of(LatticeField(spec, g).spectrum_at(0), g);
        spec.velocity[axis] = 3 * g.spacing(axis);
        const auto moved = samples_of(LatticeField(spec, g).spectrum_at(1), g);
        double worst = 0;
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 6; ++y)
                for (int z = 0; z < 10; ++z) {
                    const int sx = (x + (axis == 0 ? 8 - 3 : 0)) % 8, sy = (y + (axis == 1 ? 6 - 3 : 0)) % 6,
                              sz = (z + (axis == 2 ? 10 - 3 : 0)) % 10;
                    worst = std::max(worst, std::abs(double{moved[static_cast<std::size_t>((x * 6 + y) * 10 + z)]} -
                                                     still[static_cast<std::size_t>((sx * 6 + sy) * 10 + sz)]));
                }
        EXPECT_LT(worst, 1e-5 * rms(still)) << axis;
    }
}

TEST(Lattice, AdvectionIsExactAtSubVoxelShifts) {
    const auto g = box(8, 6, 10, 1);
    TurbulenceSpec spec = air(9, 0);
    const TrigonometricSum still(LatticeField(spec, g).spectrum_at(0), g);
    spec.velocity = {0.031, -0.4, 0.17};
    const auto moved = samples_of(LatticeField(spec, g).spectrum_at(1), g);
    for (const auto& i : {std::array{0, 0, 0}, std::array{3, 5, 7}, std::array{7, 2, 9}}) {
        const dvec3 x(i[0] * g.spacing(0), i[1] * g.spacing(1), i[2] * g.spacing(2));
        EXPECT_NEAR(moved[static_cast<std::size_t>((i[0] * 6 + i[1]) * 10 + i[2])], still.index(x - spec.velocity),
                    1e-5 * rms(moved));
    }
}

TEST(Lattice, ForceHasNoCurl) {
    for (const auto& g : {box(8, 6, 10, 4), box(7, 5, 9, 4)}) {
        const LatticeField field(air(), g);
        std::array<std::vector<std::complex<double>>, 3> force;
        for (int axis = 0; axis < 3; ++axis)
            force[axis] = forward_transform(node_field(field, 0.3, static_cast<Component>(axis + 1)), g);
        double worst = 0, largest = 0;
        for (int x = 0; x < g.size[0]; ++x)
            for (int y = 0; y < g.size[1]; ++y)
                for (int z = 0; z < g.size[2]; ++z) {
                    const auto at = static_cast<std::size_t>((x * g.size[1] + y) * g.size[2] + z);
                    const std::array<double, 3> k{bin_wavenumber(x, g.size[0], g.period[0]),
                                                  bin_wavenumber(y, g.size[1], g.period[1]),
                                                  bin_wavenumber(z, g.size[2], g.period[2])};
                    for (int a = 0; a < 3; ++a) {
                        const int b = (a + 1) % 3;
                        worst = std::max(worst, std::abs(k[a] * force[b][at] - k[b] * force[a][at]));
                        largest = std::max(largest, std::abs(k[a] * force[b][at]));
                    }
                }
        EXPECT_LT(worst, 1e-5 * largest);
    }
}

// F is ik n̂ below Nyquist and zero at Nyquist, while n has both. The continuous field has this F at its nodes.
TEST(Lattice, NyquistModesCountInTheIndexAndBendNoLight) {
    TurbulenceSpec spec = air();
    spec.spectrum = SpectrumKind::Paper;  // power up to Nyquist
    spec.lowest_wavenumber = 1;
    spec.velocity = {0.3, -0.2, 0.11};
    for (const auto& g : {box(8, 6, 10, 4), box(8, 5, 9, 4)}) {
        const LatticeField field(spec, g);
        const auto index = forward_transform(node_field(field, 0.3, Component::Index), g);
        const LatticeInstant instant(field, 0.3, 8);
        for (int axis = 0; axis < 3; ++axis) {
            const auto nodes = node_field(field, 0.3, static_cast<Component>(axis + 1));
            const auto force = forward_transform(nodes, g);
            double worst = 0, largest = 0, at_nyquist = 0, slope = 0;
            std::size_t at = 0;
            for (int x = 0; x < g.size[0]; ++x)
                for (int y = 0; y < g.size[1]; ++y)
                    for (int z = 0; z < g.size[2]; ++z, ++at) {
                        const std::array m{x, y, z};
                        const double k = bin_wavenumber(m[axis], g.size[axis], g.period[axis]);
                        const bool nyquist = 2 * x == g.size[0] || 2 * y == g.size[1] || 2 * z == g.size[2];
                        const std::complex<double> expected = nyquist ? 0.0 : std::complex<double>(0, k) * index[at];
                        worst = std::max(worst, std::abs(force[at] - expected));
                        largest = std::max(largest, std::abs(expected));
                        if (nyquist) at_nyquist = std::max(at_nyquist, std::abs(k * index[at]));
                        const dvec3 place{x * g.spacing(0), y * g.spacing(1), z * g.spacing(2)};
                        slope = std::max(slope, std::abs(instant.jet(place).gradient[axis] - nodes[at]));
                    }
            EXPECT_LT(worst, 1e-5 * largest) << axis;
            EXPECT_GT(at_nyquist, 0.01 * largest) << "a lattice without such modes tests nothing";
            EXPECT_LT(slope, 3 * lattice_spline_error(field, 8).slope * rms(nodes) + 1e-5 * rms(nodes)) << axis;
        }
    }
}

TEST(Lattice, SameBitsForAnyNumberOfThreads) {
    const auto g = box(16, 12, 18, 6);
    const LatticeField many(air(), g);
    const auto spectrum = many.spectrum_at(0.4);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(LatticeField(air(), g).spectrum_at(0.4), spectrum);
}

TEST(Lattice, ZeroStrengthIsZero) {
    TurbulenceSpec spec = air();
    spec.cn2 = 0;
    const LatticeField field(spec, box(4, 4, 4, 4));
    EXPECT_EQ(rms(field.synthesize_period(Component::Index)), 0);
    EXPECT_EQ(LatticeInstant(field, 0.1).sample({0.2, 0.3, 0.4}).n, 0);
}

TEST(LatticeGeometry, FillsWhatTheSpecLeavesOut) {
    TurbulenceSpec spec;
    spec.outer_scale = 1;
    spec.inner_scale = 0.1;
    LatticeGeometry g = choose_lattice(spec);
    EXPECT_GE(g.period[0], 2);
    EXPECT_LE(g.spacing(1), 0.05 * (1 + 1e-12));
    EXPECT_GT(g.size[3], 1);
    spec.inner_scale = 1e-4;
    EXPECT_EQ(choose_lattice(spec).size[0], kLargestDefaultSize);
    spec.alpha = 0;
    EXPECT_EQ(choose_lattice(spec).size[3], 1);
    spec.lattice = {5, 6, 7, 8};
    spec.period = {1, 2, 3, 4};
    g = choose_lattice(spec);
    EXPECT_EQ(g.size, *spec.lattice);
    EXPECT_EQ(g.period, *spec.period);
}

TEST(LatticeGeometry, RefusesTheImpossibleBeforeAllocating) {
    const auto message = [](const LatticeGeometry& g, std::uint64_t limit) -> std::string {
        try {
            check_lattice(air(), g, limit);
        } catch (const UserError& e) {
            return e.what();
        }
        return "";
    };
    constexpr std::uint64_t kLimit = 8'000'000'000;
    EXPECT_EQ(message(box(31, 17, 13, 7), kLimit), "");
    EXPECT_NE(message(box(0, 4, 4, 4), kLimit).find("nx = 0"), std::string::npos);
    EXPECT_NE(message(box(4, 4, 1, 4), kLimit).find("nz = 1"), std::string::npos);
    EXPECT_NE(message(box(4, 4, 4, 0), kLimit).find("nt = 0"), std::string::npos);
    EXPECT_NE(message(box(4, -4, 4, 1), kLimit).find("ny = -4"), std::string::npos);
    EXPECT_NE(message(box(1024, 1024, 1024, 64), kLimit).find("GB"), std::string::npos);
    EXPECT_NE(message(box(60000, 60000, 60000, 2000000000), kLimit).find("GB"), std::string::npos);
    // An int cannot count the modes of this row, however much memory there is.
    EXPECT_NE(message(box(2, 2, 131068, 70000), ~std::uint64_t{0}).find("nz = 131068 times nt = 70000"),
              std::string::npos);
    EXPECT_EQ(message(box(2, 2, 131068, 15000), ~std::uint64_t{0}), "");
    LatticeGeometry g = box(4, 4, 4, 4);
    g.period[2] = 0;
    EXPECT_NE(message(g, kLimit).find("period z"), std::string::npos);
    g.period[2] = std::nan("");
    EXPECT_NE(message(g, kLimit).find("period z"), std::string::npos);
    TurbulenceSpec spec = air();
    spec.cn2 = 1e300;
    EXPECT_THROW(LatticeField(spec, box(4, 4, 4, 1)), UserError);
}

}  // namespace
}  // namespace eikonal
