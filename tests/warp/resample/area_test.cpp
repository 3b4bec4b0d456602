/// The area filter: bilinear where nothing is squeezed, and the flux of lights against a supersampled integral.
#include "warp/resample/area.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/warp/resample/resample_image.h"

namespace eikonal {
namespace {

TEST(Area, IsBilinearWhereTheMapShiftsOrMagnifies) {
    const Window window{0, 0, 90, 40};
    const Image in = noise(window, 4, 81);
    Image magnify(window, 2);
    magnify.fill([](int x, int y, int c) { return c == 0 ? -0.3f * (float(x) - 44.3f) : -0.2f * (float(y) - 19.6f); });
    for (const Image& map : {constant_map(window, 0.3f, -1.7f), magnify})
        EXPECT_TRUE(same_bits(run(in, map, {Filter::Area}), run(in, map, {Filter::Bilinear})));
}

TEST(Area, GoesOverContinuouslyIntoBilinear) {
    const Window window{0, 0, 60, 40};
    const Image in = noise(window, 1, 83);
    Image map(window, 2);
    map.fill([](int x, int y, int c) { return c == 0 ? 1e-4f * float(x) + 0.3f : 1e-4f * float(y) + 0.7f; });
    const Image area = run(in, map, {Filter::Area}), bilinear = run(in, map, {Filter::Bilinear});
    for (std::size_t i = 0; i < area.data.size(); ++i) ASSERT_NEAR(area.data[i], bilinear.data[i], 3e-4);
}

TEST(Area, AveragesTheFootprintExactly) {
    // Shrinking by 3 x 2 about a point that puts every footprint's borders on pixel borders: plain block means.
    const Image in = noise({0, 0, 60, 40}, 1, 85);
    Image map({0, 0, 20, 20}, 2);
    map.fill([](int x, int y, int c) { return c == 0 ? float(2 * x + 1) : float(y) + 0.5f; });
    const Image out = run(in, map, {Filter::Area});
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 20; ++x) {
            double mean = 0;
            for (int j = 0; j < 2; ++j)
                for (int i = 0; i < 3; ++i) mean += in.at(3 * x + i, 2 * y + j) / 6.0;
            ASSERT_NEAR(out.at(x, y), mean, 2e-6);
        }
}

TEST(Area, KeepsConstantsUnderFoldsAtEveryEdge) {
    const Window window{0, 0, 120, 70};
    Image in(window, 4);
    in.fill([](int, int, int c) { return 0.25f + float(c); });
    const Image map = shimmer(window, 6, 8, 9);  // folds everywhere
    for (Edge edge : {Edge::Mirror, Edge::Clamp, Edge::Wrap}) {
        const Image out = run(in, map, {Filter::Area, edge});
        for (std::size_t i = 0; i < out.data.size(); ++i)
            ASSERT_NEAR(out.data[i], in.data[i % 4], 2e-6f * in.data[i % 4]);
    }
}

TEST(Area, DoesNotSmearOverASilhouette) {
    // Foreground x < 30 at rest, background moved by 5.5 px: a jump is not a squeeze.
    const Window window{0, 0, 60, 20};
    const Image in = noise(window, 4, 87);
    Image map(window, 2);
    map.fill([](int x, int, int) { return x < 30 ? 0.0f : 5.5f; });
    EXPECT_TRUE(same_bits(run(in, map, {Filter::Area}), run(in, map, {Filter::Bilinear})));
}

/// Flux of every source pixel by brute force: 32 x 32 points an output pixel through the bilinearly interpolated map,
/// each carrying 1/1024 of the radiance of the source pixel (a unit square) it falls on.
Image supersampled_flux(const Image& map) {
    constexpr int n = 32;
    const Window& w = map.window;
    Image flux(w, 1);
    for (int y = 1; y < w.height - 1; ++y)
        for (int x = 1; x < w.width - 1; ++x)
            for (int quadrant = 0; quadrant < 4; ++quadrant) {
                const int sx = quadrant % 2 ? 1 : -1, sy = quadrant / 2 ? 1 : -1;
                double corner[2][4];
                for (int c = 0; c < 2; ++c)
                    for (int k = 0; k < 4; ++k) corner[c][k] = map.at(x + k % 2 * sx, y + k / 2 * sy, c);
                for (int j = 0; j < n / 2; ++j)
                    for (int i = 0; i < n / 2; ++i) {
                        const double a = (i + 0.5) / n, b = (j + 0.5) / n;
                        const double weight[4] = {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b};
                        double px = x + sx * a + 0.5, py = y + sy * b + 0.5;
                        for (int k = 0; k < 4; ++k) {
                            px += weight[k] * corner[0][k];
                            py += weight[k] * corner[1][k];
                        }
                        if (px >= 0 && px < w.width && py >= 0 && py < w.height)
                            flux.at(static_cast<int>(px), static_cast<int>(py)) += 1.0f / (n * n);
                    }
            }
    return flux;
}

/// Lights of one pixel on a grid so wide that their images stay apart; flux of each, ours less the reference.
struct FluxError {
    double mean = 0, rms = 0, reference_mean = 0, reference_spread = 0;
    int lights = 0;
};

FluxError flux_error(const Image& map, const Image& reference, Filter filter) {
    constexpr int pitch = 24;
    const Window& w = map.window;
    Image in(w, 1), flux(w, 1);
    in.fill([&](int x, int y, int) { return x % pitch || y % pitch ? 0.0f : 1.0f; });
    const Image out = run(in, map, {filter});
    // An output pixel's light belongs to the light nearest to where it looks.
    const auto nearest = [](float position) { return pitch * static_cast<int>(std::lround(position / pitch)); };
    for (int y = 0; y < w.height; ++y)
        for (int x = 0; x < w.width; ++x) {
            const int column = nearest(float(x) + map.at(x, y, 0)), row = nearest(float(y) + map.at(x, y, 1));
            if (column >= 0 && row >= 0 && column < w.width && row < w.height) flux.at(column, row) += out.at(x, y);
        }
    FluxError e;
    double square = 0;
    for (int y = pitch; y <= w.height - pitch; y += pitch)
        for (int x = pitch; x <= w.width - pitch; x += pitch) {
            const double expected = reference.at(x, y), error = flux.at(x, y) - expected;
            e.mean += error;
            e.rms += error * error;
            e.reference_mean += expected;
            square += expected * expected;
            ++e.lights;
        }
    e.mean /= e.lights;
    e.rms = std::sqrt(e.rms / e.lights);
    e.reference_mean /= e.lights;
    e.reference_spread = std::sqrt(square / e.lights - e.reference_mean * e.reference_mean);
    return e;
}

TEST(Area, FluxOfALightIsItsSharedArea) {
    // Affine squeeze, det J = 1.4 * 1.1 - 0.2^2 = 1.5: the footprints tile, so every light has flux 1/1.5 exactly.
    const Window window{0, 0, 64, 64};
    Image map(window, 2);
    map.fill([](int x, int y, int c) {
        const float px = float(x) - 31.7f, py = float(y) - 30.2f;
        return c == 0 ? 0.4f * px + 0.2f * py : 0.2f * px + 0.1f * py;
    });
    for (int k = 0; k < 10; ++k) {
        Image in({-60, -60, 180, 180}, 1);
        in.at(28 + k, 27 + k / 2) = 1;
        double flux = 0;
        for (float v : run(in, map, {Filter::Area}).data) flux += v;
        EXPECT_NEAR(flux, 1 / 1.5, 2e-5);
    }
}

TEST(Area, FluxMatchesTheSupersampledIntegral) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        const Image map = shimmer({0, 0, 384, 384}, 24, 2, seed), reference = supersampled_flux(map);
        const FluxError e = flux_error(map, reference, Filter::Area),
                        plain = flux_error(map, reference, Filter::Bilinear);
        RecordProperty("rms_area_" + std::to_string(seed), std::to_string(e.rms));
        RecordProperty("rms_bilinear_" + std::to_string(seed), std::to_string(plain.rms));
        EXPECT_GT(e.reference_spread, 0.12) << "the map must twinkle for the test to mean anything";
        EXPECT_LT(e.rms, resampling::area_flux_error) << "spread " << e.reference_spread;
        EXPECT_LT(std::abs(e.mean), 3 * resampling::area_flux_error / std::sqrt(e.lights));
        EXPECT_GT(plain.rms, e.rms);
    }
}

TEST(Area, FluxIsNearlyExactWhereTheMapSqueezes) {
    Image map = shimmer({0, 0, 384, 384}, 40, 2, 4);
    for (int y = 0; y < 384; ++y)
        for (int x = 0; x < 384; ++x) {
            map.at(x, y, 0) += 0.4f * float(x - 192);
            map.at(x, y, 1) += 0.4f * float(y - 192);
        }
    const Image reference = supersampled_flux(map);
    const FluxError e = flux_error(map, reference, Filter::Area), plain = flux_error(map, reference, Filter::Bilinear);
    EXPECT_LT(e.rms, resampling::area_squeezed_flux_error);
    EXPECT_GT(plain.rms, 5 * e.rms);
}

TEST(Area, FluxHoldsOnAverageWhereRaysFold) {
    double error = 0, total = 0;
    for (unsigned seed = 1; seed <= 2; ++seed) {
        const Image map = shimmer({0, 0, 384, 384}, 16, 4, seed);
        const FluxError e = flux_error(map, supersampled_flux(map), Filter::Area);
        error += e.mean;
        total += e.reference_mean;
    }
    EXPECT_LT(std::abs(error / total), resampling::area_flux_error);
}

}  // namespace
}  // namespace eikonal
