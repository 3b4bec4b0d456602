// The public interface of the library, used from its header alone as a host uses it.

#include <eikonal/eikonal.h>
#include <gtest/gtest.h>

#include <cmath>

namespace {

constexpr int kWidth = 48, kHeight = 32;
constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;

/// A lattice that moves pixels by some tenths.
constexpr const char* kAir = R"(
[camera]
position = [0, 1.5, 0]
[[medium]]
type = "turbulence"
form = "lattice"
cn2 = 1e-11
outer_scale = 1
inner_scale = 0.02
lattice = [16, 16, 16, 4]
period = [4, 4, 4, 1]
[plate]
distance = 20
)";

eikonal::Settings settings() {
    eikonal::Settings s;
    s.scene_text = kAir;
    s.width = kWidth;
    s.height = kHeight;
    return s;
}

template <class Error>
std::string message_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "nothing thrown";
}

std::vector<float> picture(int channels) {
    std::vector<float> values(kPixels * static_cast<std::size_t>(channels));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.5F + 0.4F * std::sin(0.37F * static_cast<float>(i));
    return values;
}

std::vector<float> warped(const eikonal::Shimmer& shimmer, const std::vector<float>& in, int channels,
                          const eikonal::Frame& frame = {}) {
    std::vector<float> out(in.size());
    shimmer.warp(in, channels, out, 1, frame);
    return out;
}

TEST(Shimmer, MapsAreAFunctionOfTheFrame) {
    const eikonal::Shimmer shimmer(settings());
    const eikonal::Map first = shimmer.map(1), other = shimmer.map(2);
    EXPECT_EQ(first.width, kWidth);
    EXPECT_EQ(first.height, kHeight);
    ASSERT_EQ(first.uv.size(), 2 * kPixels);
    EXPECT_EQ(shimmer.map(1).uv, first.uv);
    eikonal::Settings one_thread = settings();
    one_thread.threads = 1;
    EXPECT_EQ(eikonal::Shimmer(one_thread).map(1).uv, first.uv);
    EXPECT_FALSE(first.error);
    EXPECT_EQ(other.uv.size(), first.uv.size());
}

TEST(Shimmer, TellsWhatToExpect) {
    eikonal::Settings s = settings();
    s.rms = 0.75;
    s.state_errors = true;
    const eikonal::Shimmer shimmer(s);
    EXPECT_NEAR(shimmer.expected().shift_rms, 0.75, 1e-9);
    EXPECT_GT(shimmer.expected().focusing, 0);
    EXPECT_EQ(shimmer.models(), std::vector<std::string>{"first-order"});
    EXPECT_FALSE(shimmer.notes().empty());
    const eikonal::Map map = shimmer.map(1);
    ASSERT_TRUE(map.error);
    EXPECT_GT(map.error->samples, 0);
    EXPECT_LE(map.error->p50, map.error->p95);
}

TEST(Shimmer, DepthComesAsAMap) {
    eikonal::Settings s = settings();
    const eikonal::Map even = eikonal::Shimmer(s).map(1);
    s.depth_map = true;
    s.far = 20;
    const eikonal::Shimmer shimmer(s);
    std::vector<float> depth(kPixels, 20);
    EXPECT_EQ(shimmer.map(1, {depth, {}}).uv, even.uv);
    depth.assign(kPixels, 0);  // background
    EXPECT_EQ(shimmer.map(1, {depth, {}}).uv, even.uv);
    depth.assign(kPixels, 5);
    EXPECT_NE(shimmer.map(1, {depth, {}}).uv, even.uv);
    EXPECT_EQ(message_of<eikonal::UserError>([&] { shimmer.map(1); }),
              "`depth`: frame 1 comes with 0 values, and the picture has 48 x 32 pixels");
    depth[7] = -1;
    EXPECT_EQ(message_of<eikonal::FrameError>([&] {
                  shimmer.map(1, {depth, {}});
              }),
              "frame 1: 1 of the depth values is negative; depth must be positive");
}

// Any number of channels moves alike. Alpha is a channel like the others.
TEST(Shimmer, ChannelsMoveAlike) {
    const eikonal::Shimmer shimmer(settings());
    const std::vector<float> grey = picture(1), one = warped(shimmer, grey, 1);
    EXPECT_NE(one, grey);
    for (const int channels : {2, 3, 4, 6}) {
        std::vector<float> many;
        for (const float v : grey) many.insert(many.end(), static_cast<std::size_t>(channels), v);
        const std::vector<float> out = warped(shimmer, many, channels);
        for (std::size_t i = 0; i < out.size(); ++i)
            ASSERT_EQ(out[i], one[i / static_cast<std::size_t>(channels)]) << channels;
    }
}

TEST(Shimmer, WithoutStrengthNothingChanges) {
    eikonal::Settings s = settings();
    s.gain = 0;
    std::vector<float> in = picture(3);
    in[4] = std::nanf("");
    const std::vector<float> out = warped(eikonal::Shimmer(s), in, 3);
    for (std::size_t i = 0; i < in.size(); ++i) ASSERT_TRUE(in[i] == out[i] || i == 4);
    EXPECT_TRUE(std::isnan(out[4]));
}

TEST(Shimmer, ShutterTellsItsProgress) {
    eikonal::Settings s = settings();
    s.shutter = 0.5;
    s.samples = 3;
    std::vector<int> told;
    warped(eikonal::Shimmer(s), picture(3), 3, {{}, [&](int done, int of) { told.insert(told.end(), {done, of}); }});
    EXPECT_EQ(told, (std::vector<int>{1, 3, 2, 3, 3, 3}));
}

TEST(Shimmer, StopsOnRequest) {
    std::stop_source stop;
    eikonal::Settings s = settings();
    s.stop = stop.get_token();
    const eikonal::Shimmer shimmer(s);
    shimmer.map(1);
    stop.request_stop();
    EXPECT_EQ(message_of<eikonal::FrameError>([&] { shimmer.map(1); }), "interrupted");
}

TEST(Shimmer, RefusesWhatCannotBe) {
    const auto refusal = [](const std::function<void(eikonal::Settings&)>& change) {
        eikonal::Settings s = settings();
        change(s);
        return message_of<eikonal::UserError>([&] { eikonal::Shimmer shimmer(s); });
    };
    EXPECT_EQ(refusal([](auto& s) { s.width = 0; }), "`width`: 0 must be from 1 to 65535");
    EXPECT_EQ(refusal([](auto& s) { s.preset = "gentle"; }),
              "`scene`, `scene_text` and `preset` contradict each other; give one of them");
    EXPECT_EQ(refusal([](auto& s) { s.filter = "cubik"; }),
              "`filter`: 'cubik' is none of bilinear|cubic|lanczos3|area; did you mean 'cubic'?");
    EXPECT_EQ(refusal([](auto& s) { s.set = {"medium.0.cn2=-1"}; }),
              "`set` medium.0.cn2=-1: medium.0.cn2: value -1, must be >= 0 (Cn² [m^-2/3])");
    EXPECT_EQ(refusal([](auto& s) { s.gain = std::nan(""); }), "`gain`: nan must be 0 or more");
    EXPECT_EQ(refusal([](auto& s) {
                  s.scene_text = "";
                  s.preset = "hotroad";
              }),
              "`preset` hotroad: no such preset; did you mean 'hot-road'?");
    EXPECT_EQ(message_of<eikonal::UserError>([] { warped(eikonal::Shimmer(settings()), picture(1), 3); }),
              "warp: 1536 values in and 1536 out are no pictures of 48 x 32 pixels of 3 channels");
}

TEST(Shimmer, NamesItsPresetsAndVersion) {
    const std::vector<std::string> names = eikonal::preset_names();
    EXPECT_NE(std::find(names.begin(), names.end(), "hot-road"), names.end());
    EXPECT_FALSE(eikonal::version().empty());
}

}  // namespace
