// Footage, depth maps and mattes that are missing, damaged or do not fit: status 1 with the file and the reason, or 2
// where the options are at fault; the frames before stay whole.

#include <cmath>
#include <limits>

#include "tests/program_run.h"

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
    refused(warp("none.exr", "out.exr"), 1, {"none.exr", "no such file"});
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
            refused(warp(name, out), 1, {name});
            EXPECT_FALSE(fs::exists(path(out)));
        }
    }
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

    // the first frame is the bad one; a frame of another size
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
    refused(with("none.exr"), 1, {"frame 1", "none.exr", "does not exist"});
    refused(with(":Z"), 2, {"in.exr", "'Z'", "R, G, B"});
    refused(with("in.png:R"), 2, {"in.png", "integers", "--depth-range"});
    refused(with("in.png"), 2, {"in.png", "FILE:CHANNEL"});
    refused(with("in.png:R", {"--depth-range", "3,3"}), 2, {"--depth-range"});
    refused(with("in.png:R", {"--depth-range", "0,3", "--depth-type", "inverse"}), 2, {"--depth-range", "positive"});
    refused(with("air.mov"), 2, {"--depth", "movie"});
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
    silent(with("odd.exr"));
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
