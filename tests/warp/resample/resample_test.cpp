/// The resampler, compared with a naive double-precision reference; exact cases are compared bit by bit.
#include "warp/resample/resample.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/warp/resample/resample_image.h"

namespace eikonal {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr Filter all_filters[] = {Filter::Bilinear, Filter::Cubic, Filter::Lanczos3, Filter::Area};
constexpr Filter separable_filters[] = {Filter::Bilinear, Filter::Cubic, Filter::Lanczos3};
constexpr Edge all_edges[] = {Edge::Mirror, Edge::Clamp, Edge::Wrap, Edge::Black};

// ---- naive reference: kernels by their definitions, one coordinate step at a time at the edges ----

double kernel(Filter filter, double x) {
    const double a = std::abs(x), pi = std::numbers::pi;
    switch (filter) {
        case Filter::Bilinear:
        case Filter::Area:
            return std::max(0.0, 1 - a);
        case Filter::Cubic:
            return a < 1 ? 1.5 * a * a * a - 2.5 * a * a + 1 : a < 2 ? -0.5 * a * a * a + 2.5 * a * a - 4 * a + 2 : 0;
        case Filter::Lanczos3:
            return a < 1e-12 ? 1 : a < 3 ? 3 * std::sin(pi * a) * std::sin(pi * a / 3) / (pi * pi * a * a) : 0;
    }
    return 0;
}

/// Steps inward until inside; false for black.
bool naive_edge(int& i, int n, Edge edge) {
    while (i < 0 || i >= n) {
        if (edge == Edge::Black) return false;
        if (edge == Edge::Clamp) i = i < 0 ? 0 : n - 1;
        if (edge == Edge::Wrap) i += i < 0 ? n : -n;
        if (edge == Edge::Mirror) i = i < 0 ? -1 - i : 2 * n - 1 - i;
    }
    return true;
}

double naive_sample(const Image& in, int x, int y, int c, double u, double v, Filter filter, Edge edge) {
    const int ix = static_cast<int>(std::floor(u)), iy = static_cast<int>(std::floor(v));
    double sum = 0, weights = 0, nearest = std::numeric_limits<double>::infinity();
    for (int j = -3; j <= 4; ++j)
        for (int i = -3; i <= 4; ++i) {
            const double w = kernel(filter, i - (u - ix)) * kernel(filter, j - (v - iy));
            weights += w;
            int column = x + ix + i - in.window.x0, row = y + iy + j - in.window.y0;
            const bool lit = naive_edge(column, in.window.width, edge) && naive_edge(row, in.window.height, edge);
            const double sample = lit ? in.at(in.window.x0 + column, in.window.y0 + row, c) : 0;
            sum += w * sample;
            if (std::abs(i - (u - ix)) < 1 && std::abs(j - (v - iy)) < 1) nearest = std::min(nearest, sample);
        }
    if (filter == Filter::Cubic) return std::max(sum / weights, nearest - cubic_undershoot);
    if (filter == Filter::Lanczos3) return std::max(sum / weights, nearest - lanczos3_undershoot);
    return sum / weights;
}

TEST(Resample, MatchesNaiveReferenceForEveryFilterEdgeAndWindow) {
    const Window output{-3, 5, 79, 17};
    const Window inputs[] = {output, {-20, -10, 130, 60}, {5, 9, 30, 6}, {10, 12, 1, 1}, {10, 8, 2, 3}, {-3, 5, 79, 1}};
    const Image map = noise(output, 2, 7, -9, 9);
    for (const Window& input : inputs)
        for (int channels = 1; channels <= 4; ++channels) {
            const Image in = noise(input, channels, 11);
            for (Filter filter : separable_filters)
                for (Edge edge : all_edges) {
                    const Image out = run(in, map, {filter, edge});
                    double worst = 0;
                    for (int y = output.y0; y < output.y0 + output.height; ++y)
                        for (int x = output.x0; x < output.x0 + output.width; ++x)
                            for (int c = 0; c < channels; ++c)
                                worst = std::max(
                                    worst, std::abs(out.at(x, y, c) - naive_sample(in, x, y, c, map.at(x, y, 0),
                                                                                   map.at(x, y, 1), filter, edge)));
                    EXPECT_LT(worst, 4e-6) << "filter " << int(filter) << " edge " << int(edge) << " input width "
                                           << input.width << " channels " << channels;
                }
        }
}

TEST(Resample, ZeroDisplacementKeepsEveryBit) {
    const float specials[] = {0.0f, -0.0f, infinity, -infinity, nan, 1e-42f, 3.4e38f, -3.4e38f};
    for (int width : {1, 2, 63, 64, 65, 131})
        for (int channels = 1; channels <= 4; ++channels) {
            Image in = noise({4, -2, width, 3}, channels, 5);
            for (std::size_t i = 0; i < in.data.size(); ++i)
                if (i % 3 == 0) in.data[i] = specials[i / 3 % std::size(specials)];
            for (float zero : {0.0f, -0.0f})
                for (Filter filter : all_filters)
                    for (Edge edge : all_edges)
                        EXPECT_TRUE(same_bits(run(in, constant_map(in.window, zero, zero), {filter, edge}), in));
        }
}

TEST(Resample, NeighboursOfAnUnmovedPixelDoNotPoisonIt) {
    const Window window{0, 0, 41, 41};
    for (float poison : {nan, infinity})
        for (Filter filter : all_filters) {
            Image in(window, 4), map = noise(window, 2, 3, -2, 2);
            in.fill([&](int x, int y, int c) { return x == 20 && y == 20 ? 0.1f * float(c + 1) : poison; });
            map.at(20, 20, 0) = map.at(20, 20, 1) = 0;
            const Image out = run(in, map, {filter});
            for (int c = 0; c < 4; ++c) EXPECT_EQ(out.at(20, 20, c), in.at(20, 20, c));
        }
}

TEST(Resample, AnAxisThatDoesNotMoveIsNotFiltered) {
    // Columns other than x = 8 are NaN; a vertical shift by half a pixel must not read them.
    Image in({0, 0, 17, 17}, 4);
    in.fill([](int x, int y, int) { return x == 8 ? float(y) : nan; });
    for (Filter filter : all_filters)
        EXPECT_NEAR(run(in, constant_map(in.window, 0, 0.5f), {filter}).at(8, 8, 2), 8.5f, 1e-5f);
}

TEST(Resample, IntegerShiftCopiesBits) {
    Image in = noise({-4, 3, 70, 20}, 4, 9);
    for (std::size_t i = 0; i < in.data.size(); i += 7) in.data[i] = nan;
    for (Filter filter : all_filters)
        for (Edge edge : all_edges)
            for (auto [u, v] : {std::pair{3, -2}, {-65, 21}, {1, 0}, {1000, -1000}}) {
                const Image out = run(in, constant_map(in.window, float(u), float(v)), {filter, edge});
                Image expected(in.window, 4);
                expected.fill([&](int x, int y, int c) {
                    int column = x + u - in.window.x0, row = y + v - in.window.y0;
                    if (!naive_edge(column, in.window.width, edge) || !naive_edge(row, in.window.height, edge))
                        return 0.0f;
                    return in.at(in.window.x0 + column, in.window.y0 + row, c);
                });
                EXPECT_TRUE(same_bits(out, expected)) << int(filter) << " " << int(edge) << " " << u << " " << v;
            }
}

TEST(Resample, PositionsAreExactFarFromTheOrigin) {
    // The pixels hold x - 16000: a shift of 0.001 must show to the precision of float near 1, not near 16000.
    for (float shift : {0.001f, -0.001f}) {
        for (Filter filter : all_filters) {
            float results[2];
            for (int x0 : {0, 16000}) {
                Image in({x0 - 8, 0, 17, 9}, 1);
                in.fill([&](int x, int, int) { return float(x - x0); });
                results[x0 > 0] = run(in, constant_map(in.window, shift, 0), {filter}).at(x0, 4);
            }
            EXPECT_EQ(results[0], results[1]);
            if (filter != Filter::Lanczos3) {
                EXPECT_NEAR(results[1], shift, 5e-7);  // Lanczos3 is not exact on ramps
            }
        }
    }
}

TEST(Resample, ReproducesPolynomials) {
    const Window window{0, 0, 40, 40};
    const Image map = noise({10, 10, 20, 20}, 2, 21, -4, 4);
    Image linear(window, 3), quadratic(window, 1);
    linear.fill([](int x, int y, int c) { return 0.1f * float(x) * float(c + 1) - 0.03f * float(y) + 1; });
    quadratic.fill(
        [](int x, int y, int) { return 0.01f * float(x * x) - 0.02f * float(x * y) + 0.015f * float(y * y); });
    // Lanczos3 keeps constants but ripples on a ramp by up to about 1 % of the slope.
    for (auto [filter, tolerance] :
         {std::pair{Filter::Bilinear, 1e-5}, {Filter::Cubic, 1e-5}, {Filter::Lanczos3, 0.02}}) {
        const Image out = run(linear, map, {filter});
        for (int y = 10; y < 30; ++y)
            for (int x = 10; x < 30; ++x)
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(
                        out.at(x, y, c),
                        0.1 * (c + 1) * (x + double(map.at(x, y, 0))) - 0.03 * (y + double(map.at(x, y, 1))) + 1,
                        tolerance);
    }
    const Image out = run(quadratic, map, {Filter::Cubic});
    for (int y = 10; y < 30; ++y)
        for (int x = 10; x < 30; ++x) {
            const double px = x + double(map.at(x, y, 0)), py = y + double(map.at(x, y, 1));
            EXPECT_NEAR(out.at(x, y), 0.01 * px * px - 0.02 * px * py + 0.015 * py * py, 3e-5);
        }
}

TEST(Resample, JacobianOfACoordinatePictureIsThatOfTheMap) {
    const Window window{0, 0, 96, 96};
    Image in({-16, -16, 128, 128}, 2);
    in.fill([](int x, int y, int c) { return float(c == 0 ? x : y); });
    const Image map = shimmer(window, 24, 2, 3);
    for (Filter filter : {Filter::Bilinear, Filter::Cubic}) {
        const Image out = run(in, map, {filter});
        for (int y = 1; y < 95; ++y)
            for (int x = 1; x < 95; ++x)
                for (int c = 0; c < 2; ++c) {
                    EXPECT_NEAR(out.at(x + 1, y, c) - out.at(x - 1, y, c),
                                (c == 0 ? 2 : 0) + map.at(x + 1, y, c) - map.at(x - 1, y, c), 1e-4);
                    EXPECT_NEAR(out.at(x, y + 1, c) - out.at(x, y - 1, c),
                                (c == 1 ? 2 : 0) + map.at(x, y + 1, c) - map.at(x, y - 1, c), 1e-4);
                }
    }
}

TEST(Resample, Lanczos3WeightsAreWithinTheirStatedError) {
    for (int i = 1; i < 1000; ++i) {
        const float t = float(i) / 1000;
        double sum = 0, exact_sum = 0, weight[6], exact[6];
        for (int k = 0; k < 6; ++k) {
            Image in({0, 0, 20, 1}, 1);
            in.at(10 + k - 2, 0) = 1;
            weight[k] = run(in, constant_map({10, 0, 1, 1}, t, 0), {Filter::Lanczos3}).at(10, 0);
            exact[k] = kernel(Filter::Lanczos3, k - 2 - double{t});
            sum += weight[k];
            exact_sum += exact[k];
        }
        for (int k = 0; k < 6; ++k) EXPECT_NEAR(weight[k], exact[k] / exact_sum, lanczos3_weight_error);
        EXPECT_NEAR(sum, 1, lanczos3_weight_error);
    }
}

TEST(Resample, OvershootStaysWithinTheStatedBound) {
    const Image map = noise({8, 8, 200, 200}, 2, 31, -1, 1);
    Image in = noise({0, 0, 216, 216}, 1, 33);
    for (float& v : in.data) v = v < 0.5f ? 0.0f : 1.0f;
    for (auto [filter, bound] : {std::pair{Filter::Bilinear, 1e-6},
                                 {Filter::Area, 1e-6},
                                 {Filter::Cubic, cubic_overshoot},
                                 {Filter::Lanczos3, lanczos3_overshoot}})
        for (float v : run(in, map, {filter}).data) {
            ASSERT_GE(v, -bound);
            ASSERT_LE(v, 1 + bound);
        }
}

TEST(Resample, HighlightsAreNotRingedInBlack) {
    Image in({0, 0, 32, 32}, 4);
    for (float& v : in.data) v = 0.3f;
    for (int y = 15; y < 18; ++y)
        for (int x = 15; x < 18; ++x)
            for (int c = 0; c < 4; ++c) in.at(x, y, c) = 60;
    const Image map = noise({0, 0, 32, 32}, 2, 5, -1, 1);
    for (auto [filter, limit] : {std::pair{Filter::Cubic, cubic_undershoot}, {Filter::Lanczos3, lanczos3_undershoot}})
        for (float v : run(in, map, {filter}).data) ASSERT_GE(v, 0.3f - limit);
}

TEST(Resample, ExtremeDisplacementsAreSafeAndDefined) {
    const Window window{0, 0, 9, 9};
    const float extremes[] = {nan,    infinity, -infinity, 1e30f,   -1e30f,  3.4e38f,    2.2e9f,      -2.2e9f,
                              1e-45f, -1e-45f,  1e-10f,    -1e-10f, 1 << 30, -(1 << 30), 0.99999994f, -0.99999994f};
    const Image in = noise(window, 4, 41);
    for (float u : extremes)
        for (float v : extremes)
            for (Filter filter : all_filters)
                for (Edge edge : all_edges) {
                    const Image out = run(in, constant_map(window, u, v), {filter, edge});
                    if (!std::isfinite(u) || !std::isfinite(v)) {
                        EXPECT_TRUE(same_bits(out, in));
                    }
                    for (float p : out.data) ASSERT_TRUE(std::isfinite(p));
                    if (edge == Edge::Black && std::isfinite(v) && std::isfinite(u) && std::abs(u) > 100) {
                        for (float p : out.data) ASSERT_EQ(p, 0);
                    }
                    if (edge == Edge::Clamp && u == 1e30f && v == -1e30f) {
                        for (int c = 0; c < 4; ++c) ASSERT_EQ(out.at(4, 4, c), in.at(8, 0, c));
                    }
                }
    // A mixture in one span, next to each other (the Jacobian is absurd too).
    Image map = noise({0, 0, 150, 20}, 2, 43, -3, 3);
    std::mt19937 random(1);
    for (float& d : map.data)
        if (random() % 5 == 0) d = extremes[random() % std::size(extremes)];
    const Image wide = noise(map.window, 3, 45);
    for (Filter filter : all_filters)
        for (Edge edge : all_edges)
            for (float p : run(wide, map, {filter, edge, {1, 3e38f, -2, 1}}).data) ASSERT_TRUE(std::isfinite(p));
}

TEST(Resample, LargestFinitePixelsStayFiniteWithoutNegativeLobes) {
    Image in({0, 0, 30, 30}, 4);
    in.fill([](int x, int y, int) { return (x + y) % 2 ? 3.4e38f : -3.4e38f; });
    const Image map = noise(in.window, 2, 51, -2, 2);
    for (Filter filter : {Filter::Bilinear, Filter::Area})
        for (float p : run(in, map, {filter}).data) ASSERT_TRUE(std::isfinite(p));
}

TEST(Resample, ChannelScaleMovesEachChannelByItsOwn) {
    const Window window{0, 0, 100, 30};
    const Image in = noise(window, 4, 61), map = shimmer(window, 20, 3, 5);
    const std::array<float, 4> scale{0.99f, 1, 1.25f, 1};
    for (Filter filter : all_filters) {
        const Image dispersed = run(in, map, {filter, Edge::Mirror, scale});
        for (int c = 0; c < 4; ++c) {
            Image scaled = map;
            for (float& d : scaled.data) d *= scale[std::size_t(c)];
            const Image expected = run(in, scaled, {filter});
            for (int y = 0; y < 30; ++y)
                for (int x = 0; x < 100; ++x) ASSERT_EQ(dispersed.at(x, y, c), expected.at(x, y, c));
        }
    }
}

TEST(Resample, BytesDoNotDependOnThreadsOrWindows) {
    const Window window{0, 0, 333, 217};
    const Image in = noise(window, 4, 71), map = shimmer(window, 20, 3, 6);
    for (Filter filter : all_filters) {
        Image results[2] = {in, in};
        for (int threads = 1; threads <= 2; ++threads) {
            const tbb::global_control control(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
            results[threads - 1] = run(in, map, {filter});
        }
        EXPECT_TRUE(same_bits(results[0], results[1]));
        Image part({57, 40, 101, 33}, 2);
        part.fill([&](int x, int y, int c) { return map.at(x, y, c); });
        const Image cut = run(in, part, {filter});
        for (int y = 41; y < 72; ++y)
            for (int x = 58; x < 157; ++x)
                for (int c = 0; c < 4; ++c) ASSERT_EQ(cut.at(x, y, c), results[0].at(x, y, c));
    }
}

TEST(Resample, PaddedRowsAreLeftAlone) {
    const int stride = 4 * 20 + 3;
    std::vector<float> in(std::size_t(stride) * 5, 2.0f), out(std::size_t(stride) * 5, -7.0f),
        map(std::size_t(45) * 5, 0.3f);
    const Window window{0, 0, 20, 5};
    for (Filter filter : all_filters) {
        resample({in.data(), window, 4, stride}, {map.data(), window, 45}, {out.data(), window, 4, stride}, {filter});
        for (int y = 0; y < 5; ++y)
            for (int i = 0; i < stride; ++i)
                ASSERT_NEAR(out[std::size_t(y * stride + i)], i < 80 ? 2.0f : -7.0f, 1e-6f);
    }
}

TEST(Resample, BrokenCallsThrow) {
    Image in({0, 0, 4, 4}, 4), map({0, 0, 4, 4}, 2), out({0, 0, 4, 4}, 4);
    const auto call = [&](Window iw, int ic, Window mw, Window ow, int oc) {
        resample({in.data.data(), iw, ic, 16}, {map.data.data(), mw, 8}, {out.data.data(), ow, oc, 16}, {});
    };
    const Window w{0, 0, 4, 4};
    EXPECT_THROW(call(w, 5, w, w, 5), std::invalid_argument);
    EXPECT_THROW(call(w, 3, w, w, 4), std::invalid_argument);
    EXPECT_THROW(call({0, 0, 0, 4}, 4, w, w, 4), std::invalid_argument);
    EXPECT_THROW(call(w, 4, {1, 0, 4, 4}, w, 4), std::invalid_argument);
    EXPECT_THROW(call({max_coordinate + 1, 0, 4, 4}, 4, w, w, 4), std::invalid_argument);
    EXPECT_NO_THROW(call(w, 4, {0, 0, 0, 0}, {0, 0, 0, 0}, 4));
}

TEST(NearestSource, RoundsAndFollowsTheEdges) {
    const Window w{-2, 10, 5, 4};
    using Position = std::array<int, 2>;
    EXPECT_EQ(nearest_source(0, 11, 0, 0, w, Edge::Black), (Position{0, 11}));
    EXPECT_EQ(nearest_source(0, 11, 0.5f, -0.5f, w, Edge::Black), (Position{1, 11}));
    EXPECT_EQ(nearest_source(0, 11, 0.49999997f, -0.50000006f, w, Edge::Black), (Position{0, 10}));
    EXPECT_EQ(nearest_source(0, 11, 100, 0, w, Edge::Clamp), (Position{2, 11}));
    EXPECT_EQ(nearest_source(0, 11, 100, 0, w, Edge::Black), std::nullopt);
    EXPECT_EQ(nearest_source(2, 11, 1, 0, w, Edge::Wrap), (Position{-2, 11}));
    EXPECT_EQ(nearest_source(2, 11, 2, 0, w, Edge::Mirror), (Position{1, 11}));
    EXPECT_EQ(nearest_source(1, 12, nan, 3, w, Edge::Black), (Position{1, 12}));
    EXPECT_EQ(nearest_source(1, 12, 1e30f, -1e30f, w, Edge::Clamp), (Position{2, 10}));
    EXPECT_TRUE(nearest_source(1, 12, 1e30f, -1e30f, w, Edge::Mirror).has_value());
}

}  // namespace
}  // namespace eikonal
