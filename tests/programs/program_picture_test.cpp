// The properties of pictures that are kept, and the maps that are written in addition.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "tests/programs/program_run.h"

namespace program_test {
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;

class PictureTest : public Program {
  protected:
    PictureTest() { air(); }
    void warp(const std::string& in, const std::string& out, Words more = {}) const {
        more.insert(more.begin(), {"warp", in, "-o", out, "--scene", "air.toml", "--overwrite"});
        silent(run(std::move(more)));
    }
    void still(const std::string& in, const std::string& out) const { warp(in, out, {"--set", "medium.0.cn2=0"}); }
    /// Stored pixels of a part, as bytes.
    std::string stored(const std::string& name, int part = 0) const {
        ImageSpec hints;
        hints["oiio:UnassociatedAlpha"] = 1;
        const auto input = OIIO::ImageInput::open(path(name).string(), &hints);
        if (!input || !input->seek_subimage(part, 0)) return "unreadable";
        std::string pixels(input->spec().image_bytes(true), '\0');
        EXPECT_TRUE(input->read_image(part, 0, 0, input->spec().nchannels, TypeDesc::UNKNOWN, pixels.data()));
        return pixels;
    }
    static float code(int x, int y, int c) { return static_cast<float>((x * 31 + y * 17 + c * 101) % 253) / 255.0f; }
    /// Half colour with alpha, float Z, whole-numbered id; overscan, tiles, metadata.
    void make_rich(const std::string& name) const {
        ImageSpec spec(kWidth, kHeight, 6, TypeDesc::HALF);
        spec.channelnames = {"R", "G", "B", "A", "Z", "id"};
        spec.channelformats = {TypeDesc::HALF, TypeDesc::HALF,  TypeDesc::HALF,
                               TypeDesc::HALF, TypeDesc::FLOAT, TypeDesc::UINT32};
        spec.alpha_channel = 3;
        spec.z_channel = 4;
        spec.x = -4;
        spec.y = 2;
        spec.full_x = 0;
        spec.full_y = 0;
        spec.full_width = 56;
        spec.full_height = 52;
        spec.tile_width = spec.tile_height = 16;
        spec.attribute("compression", "piz");
        spec.attribute("PixelAspectRatio", 2.0f);
        spec.attribute("owner", "somebody");
        const int rate[2] = {24000, 1001};
        spec.attribute("FramesPerSecond", TypeDesc(TypeDesc::INT, TypeDesc::VEC2, TypeDesc::RATIONAL), rate);
        const unsigned time[2] = {0x01020304, 0};
        spec.attribute("smpte:TimeCode", OIIO::TypeTimeCode, time);
        std::string pixels;
        const auto put = [&](const auto& value) { pixels.append(reinterpret_cast<const char*>(&value), sizeof value); };
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                for (int c = 0; c < 4; ++c) put(half_of(code(x, y, c)));
                put(3.0f + code(x, y, 4));
                put(static_cast<std::uint32_t>(100000 + 64 * y + x));
            }
        const auto output = OIIO::ImageOutput::create(path(name).string());
        ASSERT_TRUE(output->open(path(name).string(), spec) &&
                    output->write_tiles(-4, 60, 2, 50, 0, 1, TypeDesc::UNKNOWN, pixels.data()) && output->close())
            << output->geterror();
    }
    static std::uint16_t half_of(float v) {
        std::uint16_t bits = 0;
        OIIO::convert_types(TypeDesc::FLOAT, &v, TypeDesc::HALF, &bits, 1);
        return bits;
    }
};

TEST_F(PictureTest, ZeroDisplacementKeepsEveryBit) {
    make_rich("rich.exr");
    struct Kind {
        const char* name;
        int channels;
        TypeDesc type;
    };
    for (const Kind& k : {Kind{"a.png", 3, TypeDesc::UINT8},
                          {"b.png", 4, TypeDesc::UINT8},
                          {"c.png", 4, TypeDesc::UINT16},
                          {"d.png", 1, TypeDesc::UINT8},
                          {"e.tif", 3, TypeDesc::UINT16},
                          {"f.tif", 4, TypeDesc::FLOAT},
                          {"g.exr", 3, TypeDesc::FLOAT},
                          {"h.tga", 4, TypeDesc::UINT8}})
        paint(k.name, ImageSpec(kWidth, kHeight, k.channels, k.type), code);
    for (const char* name : {"rich.exr", "a.png", "b.png", "c.png", "d.png", "e.tif", "f.tif", "g.exr", "h.tga"}) {
        SCOPED_TRACE(name);
        const std::string out = std::string("out.") + name;
        still(name, out);
        EXPECT_EQ(read(out).spec.format, read(name).spec.format);
        EXPECT_EQ(stored(out), stored(name));
    }
    plate("p.jpg");
    still("p.jpg", "p.png");
    EXPECT_EQ(stored("p.png"), stored("p.jpg"));
    silent(run({"warp", "b.png", "-o", "gain.png", "--gain", "0"}));
    EXPECT_EQ(stored("gain.png"), stored("b.png"));
    warp("b.png", "nothing.png", {"--set", "optics.exaggeration=0"});
    EXPECT_EQ(stored("nothing.png"), stored("b.png"));
}

// A photograph taken upright comes out upright in every format. A viewer shows it so, and the air applies to that view.
TEST_F(PictureTest, PhotographsAreTurnedUpright) {
    ImageSpec turned(kHeight, kWidth, 3, TypeDesc::UINT8);
    turned.attribute("Orientation", 6);
    paint("turned.tif", turned, [](int x, int y, int c) { return code(kWidth - 1 - y, x, c); });
    paint("upright.tif", ImageSpec(kWidth, kHeight, 3, TypeDesc::UINT8), code);
    plate("p.png");
    silent(tool({"oiiotool", "p.png", "--attrib:type=int", "Orientation", "8", "-o", "p.jpg"}));
    silent(tool({"oiiotool", "p.jpg", "--reorient", "-o", "shown.png"}));
    still("p.jpg", "still.png");
    EXPECT_EQ(read("still.png").spec.width, kHeight);
    EXPECT_EQ(stored("still.png"), stored("shown.png"));
    for (const char* out : {"out.tif", "out.png", "out.exr"}) {
        SCOPED_TRACE(out);
        still("turned.tif", out);
        const std::string unmoved = stored(out);
        still("upright.tif", out);
        EXPECT_EQ(unmoved, stored(out));
        warp("turned.tif", out, {"--ground", "1.5,40%", "--displacement", "a.exr"});
        const std::string moved = stored(out);
        EXPECT_EQ(read(out).spec.get_int_attribute("Orientation", 1), 1);
        warp("upright.tif", out, {"--ground", "1.5,40%", "--displacement", "b.exr"});
        EXPECT_EQ(moved, stored(out));
        EXPECT_NE(moved, unmoved);
        EXPECT_EQ(stored("a.exr"), stored("b.exr"));
    }
}

// The frame number of a file given alone is the number in its name, where sequences have it. A farm may thus be given
// single files.
TEST_F(PictureTest, AFileOfASequenceGivenAlone) {
    plate("p.1002.exr");
    plate("IMG_1234.exr");
    plate("p.12.exr");
    const auto one = [&](const std::string& in, Words more = {}) {
        more.insert(more.begin(), {"warp", in, "-o", "o.exr", "--scene", "air.toml", "--overwrite"});
        return run(std::move(more));
    };
    warp("p.####.exr", "s.####.exr");
    const Ended alone = one("p.1002.exr");
    EXPECT_EQ(alone.lines(), Words{"eikonal: 'p.1002.exr' gets the air of frame 1002, as its name says; --frames names "
                                   "another"});
    EXPECT_EQ(stored("o.exr"), stored("s.1002.exr"));
    silent(one("p.1002.exr", {"--frames", "1"}));
    const std::string first = stored("o.exr");
    EXPECT_NE(first, stored("s.1002.exr"));
    const Ended photograph = one("IMG_1234.exr");
    EXPECT_EQ(photograph.lines(), Words{"eikonal: 'IMG_1234.exr' gets the air of frame 1, as a still; --frames 1234 if "
                                        "it is that of a sequence"});
    EXPECT_EQ(stored("o.exr"), first);
    silent(one("p.12.exr"));
    EXPECT_EQ(stored("o.exr"), first);
    refused(one("none.1002.exr"), 1, {"frame 1002", "none.1002.exr"});
}

TEST_F(PictureTest, PnmIsNamedByWhatItHolds) {
    plate("in.png");
    paint("grey.png", ImageSpec(kWidth, kHeight, 1, TypeDesc::UINT8), code);
    refused(run({"warp", "in.png", "-o", "out.pgm"}), 1, {"frame 1", "out.pgm", "name it .ppm"});
    refused(run({"warp", "grey.png", "-o", "out.ppm"}), 1, {"frame 1", "out.ppm", "name it .pgm"});
    EXPECT_FALSE(fs::exists(path("out.pgm")) || fs::exists(path("out.ppm")));
    still("in.png", "out.ppm");
    still("grey.png", "out.pgm");
    EXPECT_EQ(bytes("out.ppm").substr(0, 2), "P6");
    EXPECT_EQ(bytes("out.pgm").substr(0, 2), "P5");
}

TEST_F(PictureTest, WindowsChannelsMetadataKept) {
    make_rich("in.exr");
    warp("in.exr", "out.exr");
    const ImageSpec a = read("in.exr").spec, b = read("out.exr").spec;
    EXPECT_EQ(b.channelnames, a.channelnames);
    EXPECT_EQ(b.channelformats, a.channelformats);
    for (const auto field :
         {&ImageSpec::x, &ImageSpec::y, &ImageSpec::width, &ImageSpec::height, &ImageSpec::full_x,
          &ImageSpec::full_width, &ImageSpec::full_height, &ImageSpec::tile_width, &ImageSpec::tile_height})
        EXPECT_EQ(b.*field, a.*field);
    for (const char* key : {"compression", "owner", "FramesPerSecond", "smpte:TimeCode", "PixelAspectRatio"})
        EXPECT_EQ(b[key].get<std::string>(), a[key].get<std::string>()) << key;
    EXPECT_EQ(b.find_attribute("DateTime") != nullptr, a.find_attribute("DateTime") != nullptr);
    EXPECT_NE(stored("out.exr"), stored("in.exr"));
}

TEST_F(PictureTest, DataChannelsMoveUnfiltered) {
    make_rich("in.exr");
    warp("in.exr", "out.exr", {"--rms", "3"});
    const Pixels in = read("in.exr"), out = read("out.exr");
    std::set<float> depths, ids;
    int moved = 0;
    for (std::size_t i = 0; i < in.values.size(); i += 6) {
        depths.insert(in.values[i + 4]);
        ids.insert(in.values[i + 5]);
        moved += in.values[i + 5] != out.values[i + 5];
    }
    for (std::size_t i = 0; i < in.values.size(); i += 6) {
        ASSERT_TRUE(depths.contains(out.values[i + 4]));
        ASSERT_TRUE(ids.contains(out.values[i + 5]));
    }
    EXPECT_GT(moved, kWidth * kHeight / 2);
}

TEST_F(PictureTest, AllPartsMoveAlike) {
    plate("a.exr");
    depth("b.exr", [](int x, int y) { return static_cast<float>(1 + x + 100 * y); });
    silent(tool({"oiiotool", "a.exr", "b.exr", "--siappend", "-o", "in.exr"}));
    warp("in.exr", "out.exr", {"--rms", "3"});
    warp("b.exr", "lone.exr", {"--rms", "3"});
    EXPECT_EQ(read("out.exr", 1).spec.channelnames, Words{"Z"});
    EXPECT_EQ(stored("out.exr", 1), stored("lone.exr"));
    EXPECT_NE(stored("out.exr", 1), stored("in.exr", 1));
}

TEST_F(PictureTest, MaskedPixelsKeepTheirBits) {
    paint("in.png", ImageSpec(kWidth, kHeight, 3, TypeDesc::UINT8), code);
    paint("mask.png", ImageSpec(kWidth, kHeight, 1, TypeDesc::UINT8),
          [](int x, int, int) { return x < 32 ? 0.0f : 1.0f; });
    warp("in.png", "out.png", {"--mask", "mask.png", "--rms", "3"});
    const Pixels in = read("in.png"), out = read("out.png");
    int moved = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (int c = 0; c < 3; ++c) {
                if (x < 32) {
                    ASSERT_EQ(in.at(x, y, c), out.at(x, y, c));
                } else
                    moved += in.at(x, y, c) != out.at(x, y, c);
            }
    EXPECT_GT(moved, 3 * 32 * kHeight / 2);
}

TEST_F(PictureTest, MapsFollowTheContract) {
    plate("in.exr");
    warp("in.exr", "out.exr", {"--rms", "2", "--stmap", "st.exr", "--displacement", "uv.exr"});
    silent(run({"map", "--scene", "air.toml", "--rms", "2", "-o", "map.exr"}));
    EXPECT_EQ(stored("map.exr"), stored("uv.exr")) << "map writes what warp uses";
    const Pixels st = read("st.exr"), uv = read("uv.exr");
    EXPECT_EQ(st.spec.get_string_attribute("compression"), "zip");
    EXPECT_EQ(st.spec.format, TypeDesc::FLOAT);
    EXPECT_EQ(uv.spec.format, TypeDesc::FLOAT);
    const int u = uv.channel("u"), v = uv.channel("v");
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            ASSERT_NEAR(st.at(x, y, 0), (x + uv.at(x, y, u) + 0.5) / kWidth, 1e-6);
            ASSERT_NEAR(st.at(x, y, 1), 1 - (y + uv.at(x, y, v) + 0.5) / kHeight, 1e-6);
            ASSERT_EQ(st.at(x, y, 2), 1);
        }
}

// The camera looks at the display window, whatever the origin of that window in the file.
TEST_F(PictureTest, AirDoesNotDependOnWhereTheDisplayWindowLies) {
    ImageSpec spec(kWidth, kHeight, 3, TypeDesc::FLOAT);
    paint("here.exr", spec, code);
    spec.x = spec.full_x = 1000;
    spec.y = spec.full_y = -500;
    paint("there.exr", spec, code);
    const Words ground{"--ground", "1.5,40%", "--rms", "0.5", "--displacement", "uv.exr", "--overwrite"};
    warp("here.exr", "out.exr", ground);
    const Pixels here = read("uv.exr");
    warp("there.exr", "out.exr", ground);
    EXPECT_GT(rms(here), 0.01);
    EXPECT_EQ(read("uv.exr").values, here.values);
}

// OpenImageIO knows both of our interpolating filters by name; its t points down, hence flip_t. The contrast is low,
// where our limit on the rings of highlights (resample.h) does not act.
TEST_F(PictureTest, OiiotoolMakesOurPictureOfOurStMap) {
    constexpr float kTolerance = 1e-5f;
    paint("in.exr", ImageSpec(kWidth, kHeight, 3, TypeDesc::FLOAT),
          [](int x, int y, int c) { return 0.5f + 0.2f * code(x, y, c); });
    for (const auto& [our, their] : {std::pair{"cubic", "catmull-rom"}, {"bilinear", "triangle"}}) {
        warp("in.exr", "out.exr", {"--rms", "1", "--stmap", "st.exr", "--filter", our});
        silent(tool({"oiiotool", "in.exr", "st.exr", std::string("--st_warp:flip_t=1:filter=") + their, "-d", "float",
                     "-o", "theirs.exr"}));
        const Pixels ours = read("out.exr"), theirs = read("theirs.exr"), in = read("in.exr");
        double largest = 0, moved = 0;
        for (int y = 8; y < kHeight - 8; ++y)
            for (int x = 8; x < kWidth - 8; ++x)
                for (int c = 0; c < 3; ++c) {
                    largest = std::max(largest, std::abs(double{ours.at(x, y, c)} - theirs.at(x, y, c)));
                    moved = std::max(moved, std::abs(double{ours.at(x, y, c)} - in.at(x, y, c)));
                }
        EXPECT_LT(largest, kTolerance) << our;
        EXPECT_GT(moved, 0.05);
    }
}

}  // namespace
}  // namespace program_test
