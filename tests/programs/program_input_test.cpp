// Footage, depth maps and mattes that are missing, damaged or do not fit. The status is 1 with the file and the reason,
// or 2 if the options are at fault. The frames before stay whole.

#include <sys/stat.h>

#include <cmath>
#include <limits>

#include "tests/programs/program_run.h"

namespace program_test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();

class InputTest : public Program {
  protected:
    InputTest() {
        air();
        plate("in.exr");
        plate("in.png");
        plate("in.jpg");
        plate("in.tif");
    }
    Ended warp(const std::string& input, const std::string& output, Words more = {}) const {
        more.insert(more.begin(), {"warp", input, "-o", output, "--scene", "air.toml"});
        return run(std::move(more));
    }
};

TEST_F(InputTest, FilesThatAreNoPictures) {
    const Words before = names();
    refused(warp("none.exr", "out.exr"), 1, {"frame 1: ", "none.exr", "no such file", "check the name"});
    refused(warp("none.####.exr", "out.####.exr"), 1, {"none.####.exr", "no file"});
    refused(warp("none.mp4", "out.mp4"), 1, {"none.mp4"});
    EXPECT_EQ(names(), before);
    for (const char* type : {"exr", "png", "jpg", "tif", "mp4"}) {
        SCOPED_TRACE(type);
        const std::string name = std::string("bad.") + type, out = std::string("out.") + type;
        write_text(name, "");
        refused(warp(name, out), 1, {name});
        write_text(name, "this is a letter, not a picture, however it may be called\n");
        refused(warp(name, out), 1, {name});
        fs::remove(path(name));
        fs::create_symlink("nowhere", path(name));
        refused(warp(name, out), 1, {name});
        fs::remove(path(name));
        fs::create_directory(path(name));
        refused(warp(name, out), 2, {name, "folder"});
        fs::remove(path(name));
        EXPECT_FALSE(fs::exists(path(out)));
    }
}

TEST_F(InputTest, TruncatedAnywhere) {
    for (const char* type : {"exr", "png", "jpg", "tif"}) {
        const std::string whole = bytes(std::string("in.") + type), name = std::string("cut.") + type,
                          out = std::string("out.") + type;
        for (const double part : {0.02, 0.5, 0.98}) {
            SCOPED_TRACE(name + " " + std::to_string(part));
            write_text(name, whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
            const bool no_directory = std::string(type) == "tif" && part < 0.1;  // at that point it is no TIFF
            refused(warp(name, out), 1,
                    {"frame 1: ", name, no_directory ? "" : "the file is truncated; copy it again"});
            EXPECT_FALSE(fs::exists(path(out)));
        }
    }
}

// The program would wait for ever for a pipe that nobody writes to.
TEST_F(InputTest, PipesAndDevices) {
    for (const char* name : {"f.exr", "f.mp4", "f.toml", "f.chan"}) ASSERT_EQ(mkfifo(path(name).c_str(), 0600), 0);
    const std::string what = "not a regular file";
    refused(warp("f.exr", "out.exr"), 1, {"frame 1", "f.exr", what});
    refused(warp("f.mp4", "out.mp4"), 1, {"f.mp4", what});
    refused(warp("/dev/zero", "out.exr"), 1, {"/dev/zero", what});
    refused(warp("in.exr", "out.exr", {"--depth", "f.exr"}), 1, {"frame 1", "f.exr", what});
    refused(warp("in.exr", "out.exr", {"--mask", "f.exr"}), 1, {"frame 1", "f.exr", what});
    refused(warp("in.exr", "out.exr", {"--set", "camera.path=f.chan"}), 2, {"f.chan", what});
    refused(run({"warp", "in.exr", "-o", "out.exr", "--scene", "f.toml"}), 2, {"f.toml", what});
    EXPECT_FALSE(fs::exists(path("out.exr")));
}

TEST_F(InputTest, SequencesWithHolesAndBadFrames) {
    for (const int f : {1, 2, 4, 5}) plate("s.000" + std::to_string(f) + ".png");
    refused(warp("s.####.png", "o.####.png"), 1, {"s.####.png", "lacks frame 3", "--skip-bad-frames"});
    EXPECT_FALSE(fs::exists(path("o.0001.png")));
    refused(warp("s.####.png", "o.####.png", {"--frames", "2-4"}), 1, {"lacks frame 3"});
    silent(warp("s.####.png", "o.####.png", {"--frames", "1-5x3"}));
    const Ended skipped = warp("s.####.png", "o.####.png", {"--skip-bad-frames", "--overwrite"});
    EXPECT_EQ(skipped.status, 1);
    for (const int f : {1, 2, 4, 5}) EXPECT_TRUE(fs::exists(path("o.000" + std::to_string(f) + ".png")));

    plate("s.0003.png");
    write_text("s.0004.png", bytes("s.0004.png").substr(0, 500));
    for (const auto& name : names())
        if (name.starts_with("o.")) fs::remove(path(name));
    const Ended stopped = warp("s.####.png", "o.####.png", {"--threads", "1"});
    EXPECT_EQ(stopped.status, 1);
    ASSERT_EQ(stopped.lines().size(), 2u) << stopped.err;
    EXPECT_TRUE(stopped.lines()[0].starts_with("eikonal: frame 4: ")) << stopped.err;
    EXPECT_NE(stopped.err.find("s.0004.png"), std::string::npos);
    EXPECT_TRUE(stopped.lines()[1].starts_with("eikonal: ")) << stopped.err;
    for (const int f : {1, 2, 3}) EXPECT_TRUE(fs::exists(path("o.000" + std::to_string(f) + ".png")));
    EXPECT_FALSE(fs::exists(path("o.0004.png")));
    EXPECT_EQ(warp("s.####.png", "o.####.png", {"--skip-bad-frames"}).status, 1);
    EXPECT_TRUE(fs::exists(path("o.0005.png")));

    // The first frame is the bad one, or a frame has another size.
    write_text("s.0001.png", "");
    EXPECT_EQ(warp("s.####.png", "p.####.png", {"--skip-bad-frames"}).status, 1);
    EXPECT_TRUE(fs::exists(path("p.0005.png")));
    paint("s.0001.png", OIIO::ImageSpec(32, 48, 3, OIIO::TypeDesc::UINT8), [](int, int, int) { return 0.5f; });
    const Ended size = warp("s.####.png", "q.####.png", {"--frames", "2,1", "--threads", "1"});
    EXPECT_EQ(size.status, 1);
    EXPECT_NE(size.err.find("eikonal: frame 1: 's.0001.png' is 32 x 48"), std::string::npos) << size.err;
    EXPECT_TRUE(fs::exists(path("q.0002.png")));
}

TEST_F(InputTest, DepthThatDoesNotFit) {
    const auto with = [&](const std::string& depth_option, Words more = {}) {
        more.insert(more.begin(), {"--depth", depth_option});
        return warp("in.exr", "out.exr", more);
    };
    refused(with("none.exr"), 1, {"frame 1", "depth map", "none.exr", "does not exist; check the name"});
    refused(with(":Z"), 2, {"in.exr", "'Z'", "R, G, B"});
    refused(with("in.png:R"), 2, {"in.png", "integers", "--depth-range"});
    refused(with("in.png"), 2, {"in.png", "FILE:CHANNEL"});
    refused(with("in.png:R", {"--depth-range", "3,3"}), 2, {"--depth-range"});
    refused(with("in.png:R", {"--depth-range", "0,3", "--depth-type", "inverse"}), 2, {"--depth-range", "positive"});
    refused(with("air.mov"), 2, {"--depth", "movie", "depth.%04d.png"});
    refused(warp("in.exr", "out.exr", {"--mask", "air.mov"}), 2, {"--mask", "movie", "mask.%04d.png"});
    refused(warp("in.exr", "out.exr", {"--mask", "none.exr"}), 1, {"frame 1", "none.exr", "exist; check the name"});
    refused(with(""), 2, {"--depth"});
    depth(
        "small.exr", [](int, int) { return 10.f; }, 32);
    refused(with("small.exr"), 1, {"frame 1", "small.exr", "32x48", "64x48"});
    depth("zero.exr", [](int, int) { return 0.f; });
    refused(with("zero.exr"), 1, {"frame 1", "zero.exr", "only zeros"});
    depth("nan.exr", [](int, int) { return kNan; });
    refused(with("nan.exr"), 1, {"frame 1", "nan.exr", "NaN"});
    depth("negative.exr", [](int x, int) { return x == 5 ? -1.f : 10.f; });
    refused(with("negative.exr"), 1, {"frame 1", "negative.exr", "48 negative"});
    write_text("cut.exr", bytes("negative.exr").substr(0, 700));
    refused(with("cut.exr"), 1, {"frame 1", "cut.exr"});
    EXPECT_FALSE(fs::exists(path("out.exr")));
    // some NaN, infinity and zero among depths mean background
    depth("odd.exr", [](int x, int y) { return y != 0 ? 20.f : x < 20 ? kNan : x < 40 ? kInf : 0.f; });
    const Ended odd = with("odd.exr");
    EXPECT_EQ(odd.status, 0);
    EXPECT_EQ(odd.lines().size(), 1u) << odd.err;
    EXPECT_NE(odd.err.find("warning: 'odd.exr': 24 of 3072 pixels are at 0 m and count as background"),
              std::string::npos)
        << odd.err;
    for (const float v : read("out.exr").values) ASSERT_TRUE(std::isfinite(v));
}

TEST_F(InputTest, FewerDepthMapsThanFrames) {
    for (const char* f : {"1", "2", "3"}) plate("s.000" + std::string(f) + ".exr");
    for (const char* f : {"1", "2"}) depth("z.000" + std::string(f) + ".exr", [](int, int) { return 20.f; });
    refused(warp("s.####.exr", "o.####.exr", {"--depth", "z.####.exr"}), 1, {"frame 3", "z.0003.exr", "--frames"});
    EXPECT_FALSE(fs::exists(path("o.0001.exr")));
    silent(warp("s.####.exr", "o.####.exr", {"--depth", "z.####.exr", "--frames", "1-2"}));
    refused(warp("s.####.exr", "p.####.exr", {"--mask", "m.####.exr"}), 1, {"frame 1", "mask", "m.0001.exr"});
    refused(warp("in.exr", "p.exr", {"--mask", "in.exr:Q"}), 2, {"in.exr", "'Q'"});
}

// Frames whose depth map or matte is missing or damaged are bad frames like any other.
TEST_F(InputTest, SkippedCompanions) {
    for (const char* f : {"1", "2", "3", "4"}) plate("s.000" + std::string(f) + ".exr");
    for (const char* f : {"2", "4"})
        depth("z.000" + std::string(f) + ".exr",
              [](int x, int y) { return 0.5f + 0.3f * std::sin(static_cast<float>(x * y)); });
    write_text("z.0003.exr", bytes("z.0002.exr").substr(0, 700));
    for (const char* companion : {"--depth", "--mask"}) {
        SCOPED_TRACE(companion);
        const Ended ended = warp("s.####.exr", "o.####.exr",
                                 {companion, "z.####.exr", "--skip-bad-frames", "--overwrite", "--threads", "1"});
        EXPECT_EQ(ended.status, 1);
        for (const char* line :
             {"eikonal: frame 1: cannot read 'z.0001.exr': no such file",
              "eikonal: frame 3: cannot read 'z.0003.exr': the file is truncated", "eikonal: 2 of 4 frames done"})
            EXPECT_NE(ended.err.find(line), std::string::npos) << ended.err;
        for (const int f : {1, 2, 3, 4})
            EXPECT_EQ(fs::exists(path("o.000" + std::to_string(f) + ".exr")), f % 2 == 0) << f;
        for (const int f : {2, 4}) fs::remove(path("o.000" + std::to_string(f) + ".exr"));
    }
    const Ended maps =
        run({"map", "-o", "m.####.exr", "--depth", "z.####.exr", "--frames", "1-4", "--skip-bad-frames"});
    EXPECT_EQ(maps.status, 1);
    EXPECT_TRUE(fs::exists(path("m.0002.exr")) && fs::exists(path("m.0004.exr"))) << maps.err;
}

// These are accepted, with a warning once a run.
TEST_F(InputTest, ImplausibleCompanions) {
    const auto warned = [&](Words more, const std::string& text) {
        more.insert(more.end(), {"--overwrite", "--frames", "1-3"});
        const Ended ended = warp("in.exr", "out.####.exr", more);
        EXPECT_EQ(ended.status, 0);
        EXPECT_EQ(ended.lines().size(), 1u) << ended.err;
        EXPECT_NE(ended.err.find("eikonal: warning: " + text), std::string::npos) << ended.err;
    };
    depth("metres.exr", [](int x, int) { return 2.f + static_cast<float>(x); });
    warned({"--depth", "metres.exr", "--depth-range", "5,30"},
           "'metres.exr': channel 'Z' holds values from 2 to 65, but --depth-range is for 0 to 1");
    depth("hdr.exr", [](int x, int y) { return x == 0 && y == 0 ? kNan : x < 9 ? -1.f : 4.f; });
    warned({"--mask", "hdr.exr"}, "'hdr.exr': the mask holds values from -1 to 4 and 1 that are not finite");
    warned({"--set", "medium="}, "the scene has no medium: nothing moves");
    write_text("short.chan", "2 0 1.5 0 0 0 0\n3 0 1.5 0 0 0 0\n");
    warned({"--set", "camera.path=short.chan"}, "'short.chan' holds frames 2 to 3, but frames 1 to 3 are made");
    silent(warp("in.exr", "out.####.exr", {"--set", "camera.path=short.chan", "--overwrite", "--frames", "2-3"}));
    warned({"--ground", "1.5,120%"}, "ground: the horizon, row 57.6, lies below the 48 rows of the picture");
    warned({"--ground", "1e6,50%"}, "ground: 1e+06 m below the camera, it is nowhere in the picture");
    warned({"--set", "medium.0.lattice=[2, 2, 2, 2]"}, "medium.0: moves nothing: of two samples a period");
    silent(warp("in.exr", "out.0001.exr", {"--set", "medium.0.lattice=[2, 2, 2, 2]", "--gain", "0", "--overwrite"}));
    paint("grey.png", OIIO::ImageSpec(kWidth, kHeight, 3, OIIO::TypeDesc::UINT8), [](int, int, int) { return 0.5f; });
    silent(warp("in.exr", "out.exr", {"--mask", "grey.png"}));
    const Ended verbose = warp("in.exr", "out.exr", {"--mask", "grey.png", "--overwrite", "-v"});
    EXPECT_NE(verbose.err.find("mask: channel 'R' of 'grey.png', which has R, G, B"), std::string::npos) << verbose.err;
    refused(warp("in.exr", "p.exr", {"--mask", "in.png"}), 2, {"in.png", "which channel", "R, G, B"});
}

// NaN and infinity stay where nothing moves. Where something moves they become finite, with a warning once a run.
TEST_F(InputTest, PlatesThatAreNotFinite) {
    const auto colour = [](int x, int y, int c) {
        return y == 9 && x == 7 ? kNan : y == 9 && x == 40 && c == 1 ? kInf : 0.5f;
    };
    const OIIO::ImageSpec half(kWidth, kHeight, 3, OIIO::TypeDesc::HALF);
    for (const char* f : {"1", "2"}) paint("s.000" + std::string(f) + ".exr", half, colour);
    paint("right.exr", OIIO::ImageSpec(kWidth, kHeight, 1, OIIO::TypeDesc::HALF),
          [](int x, int, int) { return x < 20 ? 0.0f : 1.0f; });
    const Ended ended = warp("s.####.exr", "o.####.exr", {"--mask", "right.exr"});
    EXPECT_EQ(ended.status, 0);
    EXPECT_EQ(ended.lines().size(), 1u) << ended.err;
    EXPECT_NE(ended.err.find("warning: 's.0001.exr': 4 colour values are NaN or infinite"), std::string::npos)
        << ended.err;
    const Pixels out = read("o.0002.exr");
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) ASSERT_EQ(std::isnan(out.at(x, y, 0)), x == 7 && y == 9) << x << " " << y;
    EXPECT_TRUE(std::isfinite(out.at(40, 9, 1)));
}

TEST_F(InputTest, TinyPictures) {
    for (const auto& [width, height] : {std::pair{1, 1}, {9, 1}}) {
        paint("tiny.exr", OIIO::ImageSpec(width, height, 3, OIIO::TypeDesc::HALF),
              [](int, int, int c) { return 0.25f * static_cast<float>(c); });
        for (const char* edge : {"mirror", "clamp", "wrap", "black"})
            for (const char* filter : {"cubic", "area"}) {
                silent(run({"warp", "tiny.exr", "-o", "t.exr", "--overwrite", "--scene", "air.toml", "--edge", edge,
                            "--filter", filter, "--gain", "100"}));
                for (const float v : read("t.exr").values) ASSERT_TRUE(std::isfinite(v));
            }
    }
}

}  // namespace
}  // namespace program_test
