// The effect of the options on the picture: strength, depth, dispersion, shutter.

#include <cmath>

#include "tests/programs/program_run.h"

namespace program_test {
namespace {

class LookTest : public Program {
  protected:
    LookTest() { air(); }
    Pixels map(Words more) const {
        more.insert(more.begin(), {"map", "-o", "m.exr", "--overwrite"});
        const Ended ended = run(std::move(more));
        EXPECT_EQ(ended.status, 0) << ended.err;
        return read("m.exr");
    }
    Pixels air_map(Words more) const {
        more.insert(more.begin(), {"--scene", "air.toml"});
        return map(std::move(more));
    }
    /// Greatest difference of two maps [px].
    static double difference(const Pixels& a, const Pixels& b) {
        double largest = 0;
        for (std::size_t i = 0; i < a.values.size(); ++i)
            largest = std::max(largest, std::abs(double{a.values[i]} - b.values[i]));
        return largest;
    }
    static double rms_of(const Pixels& map, int x0, int x1, int y0 = 0, int y1 = kHeight) {
        double sum = 0;
        for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) sum += std::pow(map.at(x, y, 0), 2) + std::pow(map.at(x, y, 1), 2);
        return std::sqrt(sum / ((x1 - x0) * (y1 - y0)));
    }
};

TEST_F(LookTest, GainIsExact) {
    const Pixels one = air_map({}), two = air_map({"--gain", "2"});
    EXPECT_GT(rms(one), 0.01);
    for (std::size_t i = 0; i < one.values.size(); ++i) ASSERT_EQ(two.values[i], 2 * one.values[i]);
    EXPECT_NE(air_map({"--seed", "2"}).values, one.values);
}

// Eight frames, 100 apart, of a view that is some thirty eddies wide. Each has dozens of independent patches, so that
// the rms of the sample is within a few percent; 15 % is safe. Large outer scales make a part of it common to the
// frame.
TEST_F(LookTest, RmsIsHonouredOverTheShot) {
    for (const char* preset : {"gentle"}) {
        silent_but_for_folding(run({"map", "--preset", preset, "--set", "camera.resolution=[64, 48]", "--rms", "1.5",
                                    "--frames", "1-701x100", "-o", "r.####.exr"}));
        double sum = 0;
        for (int f = 1; f <= 701; f += 100) {
            char name[32];
            std::snprintf(name, sizeof name, "r.%04d.exr", f);
            sum += std::pow(rms(read(name)), 2);
        }
        EXPECT_NEAR(std::sqrt(sum / 8), 1.5, 0.15 * 1.5) << preset;
    }
}

TEST_F(LookTest, DepthTypesMeanTheSame) {
    const auto metres = [](int x, int y) { return static_cast<float>(10 + 0.2 * x + 0.1 * y); };
    const double f = 32 / std::tan(2.5 * M_PI / 180);
    depth("z.exr", metres);
    depth("ray.exr", [&](int x, int y) {
        return static_cast<float>(metres(x, y) * std::hypot(1, (x + 0.5 - 32) / f, (y + 0.5 - 24) / f));
    });
    depth("inverse.exr", [&](int x, int y) { return 1 / metres(x, y); });
    depth("coded.exr", [&](int x, int y) { return (metres(x, y) - 5) / 35; });
    const Pixels z = air_map({"--depth", "z.exr"});
    constexpr double kSame = 1e-4;
    EXPECT_GT(rms(z), 100 * kSame);
    EXPECT_LT(difference(z, air_map({"--depth", "ray.exr", "--depth-type", "ray"})), kSame);
    EXPECT_LT(difference(z, air_map({"--depth", "inverse.exr", "--depth-type", "inverse"})), kSame);
    EXPECT_LT(difference(z, air_map({"--depth", "coded.exr", "--depth-range", "5,40"})), kSame);
    // a constant depth map is a constant distance
    depth("flat.exr", [](int, int) { return 30.f; });
    EXPECT_LT(difference(air_map({"--depth", "flat.exr"}), air_map({"--distance", "30"})), 2e-3);
}

TEST_F(LookTest, GroundIsTheDepthOfAPlane) {
    constexpr double kHeightAbove = 0.5, kHorizon = 12;
    const double f = 32 / std::tan(2.5 * M_PI / 180);
    depth("z.exr", [&](int, int y) {
        const double below = y + 0.5 - kHorizon;
        return static_cast<float>(below > 0 ? std::min(40.0, kHeightAbove * f / below) : 40.0);
    });
    const Pixels ground = air_map({"--ground", "0.5,12"});
    EXPECT_LT(difference(ground, air_map({"--ground", "0.5,25%"})), 1e-6);
    EXPECT_LT(difference(ground, air_map({"--depth", "z.exr"})), 1e-4);
    EXPECT_LT(rms_of(ground, 0, kWidth, 44, 48), 0.8 * rms_of(ground, 0, kWidth, 0, 12)) << "near ground moves less";
}

// A foreground at 5 m (red) before a background at 300 m (green). In uniform air the variance of the angle is
// proportional to the path (PHYSICS.md#first-order), so that 5 m give √(5/300) = 0.13 of the rms. If the air is hot
// beyond 20 m only, the foreground does not move.
TEST_F(LookTest, ForegroundStaysStill) {
    const auto in_front = [](int x, int) { return x < 32; };
    depth("z.exr", [&](int x, int y) { return in_front(x, y) ? 5.f : 300.f; });
    paint("in.exr", OIIO::ImageSpec(kWidth, kHeight, 3, OIIO::TypeDesc::HALF),
          [&](int x, int y, int c) { return c == (in_front(x, y) ? 0 : 1) ? 1.f : 0.f; });
    const Words common{"warp", "in.exr", "--preset", "gentle",      "--depth",        "z.exr", "--far",
                       "300",  "--rms",  "4",        "--overwrite", "--displacement", "uv.exr"};
    const Words beyond{"--set", "medium.0.falloff={origin=[0, 0, -20], normal=[0, 0, 1], length=2}"};
    const auto dragged = [&](const Words& more) {
        Words words = common;
        words.insert(words.end(), {"-o", "out.exr"});
        words.insert(words.end(), more.begin(), more.end());
        silent_but_for_folding(run(words));
        const Pixels out = read("out.exr");
        double red = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 33; x < kWidth; ++x) red += out.at(x, y, 0);
        return red / kHeight;
    };
    const double own = dragged({"--depth-meeting", "own"}), march = dragged({});
    const Pixels map = read("uv.exr");
    EXPECT_LT(rms_of(map, 0, 31), 0.2 * rms_of(map, 36, kWidth));
    dragged(beyond);
    const Pixels still = read("uv.exr");
    EXPECT_LT(rms_of(still, 0, 31), 0.05);
    EXPECT_GT(rms_of(still, 36, kWidth), 1.0);
    EXPECT_GT(own, 0.2) << "pixels of foreground a row";
    EXPECT_LT(march, 0.3 * own);
}

// Each pixel holds its own column, so the output shows how far each colour has moved. Ciddor's (n-1) at 650, 550, 450
// nm.
TEST_F(LookTest, DispersionFollowsTheIndexOfAir) {
    paint("in.exr", OIIO::ImageSpec(kWidth, kHeight, 3, OIIO::TypeDesc::FLOAT),
          [](int x, int, int) { return static_cast<float>(x); });
    const auto slopes = [&](const char* amount) {
        silent_but_for_folding(run({"warp", "in.exr", "-o", "out.exr", "--scene", "air.toml", "--rms", "2",
                                    "--dispersion", amount, "--overwrite"}));
        const Pixels out = read("out.exr");
        double red = 0, blue = 0, green = 0;
        for (int y = 8; y < kHeight - 8; ++y)
            for (int x = 10; x < kWidth - 10; ++x) {
                const double g = out.at(x, y, 1) - x;
                red += g * (out.at(x, y, 0) - x);
                blue += g * (out.at(x, y, 2) - x);
                green += g * g;
            }
        return std::pair{red / green, blue / green};
    };
    EXPECT_NEAR(slopes("1").first, 2.7632 / 2.7784, 2e-4);
    EXPECT_NEAR(slopes("1").second, 2.8053 / 2.7784, 2e-4);
    EXPECT_NEAR(slopes("0").first, 1, 1e-6);
}

TEST_F(LookTest, ShutterBlurs) {
    paint("in.exr", OIIO::ImageSpec(kWidth, kHeight, 1, OIIO::TypeDesc::FLOAT),
          [](int x, int y, int) { return static_cast<float>((x + y) % 4 < 2); });
    const auto contrast = [&](Words more) {
        more.insert(more.begin(), {"warp", "in.exr", "-o", "out.exr", "--scene", "air.toml", "--rms", "3", "--set",
                                   "medium.0.velocity=[6, 0, 0]", "--overwrite"});
        silent_but_for_folding(run(more));
        const Pixels out = read("out.exr");
        double sum = 0, squares = 0;
        for (const float v : out.values) {
            sum += v;
            squares += double{v} * v;
        }
        const auto n = static_cast<double>(out.values.size());
        return squares / n - sum / n * sum / n;
    };
    EXPECT_LT(contrast({"--shutter", "1", "--samples", "8"}), 0.8 * contrast({}));
}

}  // namespace
}  // namespace program_test
