/// The positions of thin screens, and the settings that are refused.
#include "noise/turbulence/screens/screen_layout.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "noise/base/error.h"

namespace eikonal {
namespace {

TEST(ScreenLayout, SlabsAreThickerThanTheOuterScaleAndFillThePath) {
    TurbulenceSpec spec;
    for (const double far : {0.5, 1.5, 5.0, 9.0, 300.0}) {
        const auto screens = layout_screens(spec, {true, far, 0.3, 0.2, 1e-3, 0.05, 24});
        EXPECT_LE(screens.size(), std::max<std::size_t>(1, static_cast<std::size_t>(far)));
        EXPECT_LE(screens.size(), static_cast<std::size_t>(kMostScreens));
        double w = 0;
        for (const ScreenGeometry& s : screens) {
            EXPECT_NEAR(s.w, w + s.thickness / 2, 1e-9);
            w += s.thickness;
            EXPECT_NEAR(s.aperture, 0.05 * (1 - s.w / far), 1e-12);
            EXPECT_LE(std::max(s.nx, s.ny), kLargestSide);
            if (screens.size() > 1) {
                EXPECT_GE(s.thickness, spec.outer_scale);
            }
        }
        EXPECT_NEAR(w, far, 1e-9);
        // the table of the header: variance of the displacement angle against D/3
        const auto error = [&](double D) {
            double sum = 0;
            for (const ScreenGeometry& s : screens) {
                const double lever = slab_lever(s.w - s.thickness / 2, s.w + s.thickness / 2, D).length / D;
                sum += lever * lever * s.thickness;
            }
            return sum / (D / 3) - 1;
        };
        if (far >= 2) {
            EXPECT_NEAR(error(1), -0.25, 0.17);
        }
        for (double D = 4; D < far; D *= 1.02) EXPECT_NEAR(error(D), 0, kSlabError) << D;
        // patterns that repeat within the view do so at different angles
        for (std::size_t m = 1; m < screens.size(); ++m)
            if (screens[m].Lx < 0.6 * screens[m].w) {
                EXPECT_GT(std::abs(screens[m].Lx / screens[m].w - screens[m - 1].Lx / screens[m - 1].w),
                          1e-3 * screens[m].Lx / screens[m].w);
            }
    }
}

TEST(ScreenLayout, OverridesAndErrors) {
    TurbulenceSpec spec;
    const ShotView view{true, 100, 0.3, 0.2, 1e-3, 0, 24};
    spec.lattice = {64, 32, 10, 7};
    spec.period = {3, 4, 1, 5};
    const auto screens = layout_screens(spec, view);
    ASSERT_EQ(screens.size(), 10u);
    EXPECT_EQ(screens[3].nx, 64);
    EXPECT_EQ(screens[3].ny, 32);
    EXPECT_EQ(screens[3].nt, 7);
    EXPECT_EQ(screens[3].Lx, 3);
    EXPECT_EQ(screens[3].Ly, 4);
    EXPECT_EQ(screens[3].T, 5);
    for (const std::array<int, 4>& bad : {std::array{0, 32, 8, 7},
                                          {32, 1, 8, 7},
                                          {64, 64, 101, 7},
                                          {64, 64, 0, 7},
                                          {64, 64, 8, 0},
                                          {1 << 30, 64, 8, 1}}) {
        spec.lattice = bad;
        EXPECT_THROW(layout_screens(spec, view), UserError);
    }
    spec.lattice = {32768, 32768, 8, 8};
    const auto huge = layout_screens(spec, view);
    EXPECT_GT(screens_bytes(spec, huge), 100'000'000'000u);
    EXPECT_THROW(check_screens(spec, huge, 8'000'000'000u), UserError);
    EXPECT_NO_THROW(check_screens(spec, screens, 8'000'000'000u));
    spec.period = {0, 1, 1, 1};
    EXPECT_THROW(layout_screens(spec, view), UserError);
}

}  // namespace
}  // namespace eikonal
