// The files after a run: full disks, finished frames, reports, progress, fields.

#include <nlohmann/json.hpp>

#include "tests/programs/program_run.h"

namespace program_test {
namespace {

class OutputTest : public Program {
  protected:
    OutputTest() {
        air();
        plate("in.exr");
    }
    Words made(const std::string& prefix) const {
        Words found;
        for (const std::string& name : names())
            if (name.starts_with(prefix) || name.starts_with(".")) found.push_back(name);
        return found;
    }
};

// A limit on the size of files stands for the full disk: any user may set it, and the write fails alike.
TEST_F(OutputTest, FullDisk) {
    constexpr long kRoom = 2000;
    plate("in.png");
    for (const char* out : {"o.exr", "o.tif", "o.dpx", "o.tga"}) {
        SCOPED_TRACE(out);
        refused(run({"warp", "in.exr", "-o", out}, kRoom), 1, {"frame 1", out, "File too large"});
        EXPECT_EQ(made("o."), Words{}) << "nothing half written, no temporaries";
    }
    refused(run({"map", "--scene", "air.toml", "-o", "o.exr"}, kRoom), 1, {"frame 1", "o.exr"});
    refused(run({"field", "--scene", "air.toml", "-o", "o.####.exr"}, kRoom), 1, {"o.0000.exr"});
    const Ended movie = run({"warp", "in.exr", "-o", "o.mp4", "--frames", "1-30"}, kRoom);
    EXPECT_EQ(movie.status, 1) << movie.err;
    EXPECT_NE(movie.err.find("o.mp4"), std::string::npos) << movie.err;
    EXPECT_EQ(made("o."), Words{});
}

TEST_F(OutputTest, FinishedFramesAreKept) {
    const Words all{"warp", "in.exr", "-o", "o.####.exr", "--scene", "air.toml", "--stmap", "st.####.exr"};
    Words first = all, both = all, anew = all;
    first.insert(first.end(), {"--frames", "1-2"});
    both.insert(both.end(), {"--frames", "1-3"});
    silent(run(first));
    const auto time = fs::last_write_time(path("o.0001.exr"));
    fs::remove(path("st.0002.exr"));
    const Ended second = run(both);
    EXPECT_EQ(second.status, 0);
    EXPECT_EQ(second.lines().size(), 1u) << second.err;
    EXPECT_NE(second.err.find("eikonal: 1 frame is already there"), std::string::npos) << second.err;
    EXPECT_EQ(fs::last_write_time(path("o.0001.exr")), time);
    EXPECT_TRUE(fs::exists(path("o.0003.exr")));
    EXPECT_TRUE(fs::exists(path("st.0002.exr"))) << "a frame is finished when its maps are, too";
    anew.insert(anew.end(), {"--frames", "1", "--overwrite"});
    silent(run(anew));
    EXPECT_NE(fs::last_write_time(path("o.0001.exr")), time);
}

// An existing file with the name of an output is kept if it is whole, made anew if it is not, and refused if it may be
// another picture.
TEST_F(OutputTest, DamagedFramesAreMadeAnewAndOthersRefused) {
    const Words words{"warp", "in.exr", "-o", "o.####.exr", "--scene", "air.toml", "--frames", "1-4"};
    silent(run(words));
    const std::string whole = bytes("o.0002.exr");
    write_text("o.0002.exr", whole.substr(0, whole.size() * 9 / 10));
    write_text("o.0003.exr", "this is no picture");
    const Ended again = run(words);
    EXPECT_EQ(again.status, 0);
    EXPECT_EQ(again.lines(), (Words{"eikonal: 2 frames are already there and kept; --overwrite makes them anew",
                                    "eikonal: 'o.0002.exr' and 1 more are damaged and made anew"}));
    EXPECT_EQ(bytes("o.0002.exr"), whole);
    EXPECT_EQ(run(words).lines(), Words{"eikonal: 4 frames are already there and kept; --overwrite makes them anew"});
    depth(
        "o.0004.exr", [](int, int) { return 1.f; }, 32);
    const std::string precious = bytes("o.0004.exr");
    refused(run(words), 2, {"-o", "o.0004.exr", "32 x 48", "64 x 48", "--overwrite"});
    EXPECT_EQ(bytes("o.0004.exr"), precious);
    Words anew = words;
    anew.push_back("--overwrite");
    silent(run(anew));
    silent(run({"field", "--scene", "air.toml", "-o", "f.####.exr"}));
    EXPECT_NE(
        run({"field", "--scene", "air.toml", "-o", "f.####.exr", "--frame", "7"}).err.find("16 frames are already"),
        std::string::npos)
        << "slices of another frame would be mistaken for this one's";
}

TEST_F(OutputTest, Report) {
    fs::create_directory(path("bad"));
    plate("s.0001.exr");
    write_text("s.0002.exr", "");
    const Words words{"warp",     "s.####.exr", "-o",     "o.####.exr",       "--scene",
                      "air.toml", "--report",   "r.json", "--skip-bad-frames"};
    EXPECT_EQ(run(words).status, 1);
    auto report = nlohmann::json::parse(bytes("r.json"));
    ASSERT_EQ(report["frames"].size(), 2u);
    EXPECT_EQ(report["frames"][0]["status"], "written");
    EXPECT_GT(report["frames"][0]["rms_px"].get<double>(), 0);
    EXPECT_GE(report["frames"][0]["largest_px"].get<double>(), report["frames"][0]["rms_px"].get<double>());
    EXPECT_EQ(report["frames"][1]["status"], "failed");
    EXPECT_NE(report["frames"][1]["error"].get<std::string>().find("s.0002.exr"), std::string::npos);
    EXPECT_EQ(report["models"][0], "first-order");
    plate("s.0002.exr");
    EXPECT_EQ(run(words).status, 0);
    EXPECT_EQ(nlohmann::json::parse(bytes("r.json"))["frames_kept"], 1);
    EXPECT_EQ(run(words).status, 0);
    report = nlohmann::json::parse(bytes("r.json"));
    EXPECT_EQ(report["frames_kept"], 2);
    EXPECT_TRUE(report["frames"].empty());
    // an empty file is no finished frame
    ASSERT_GT(bytes("o.0001.exr").size(), 0U);
    write_text("o.0001.exr", "");
    EXPECT_EQ(run(words).status, 0);
    EXPECT_GT(bytes("o.0001.exr").size(), 0U);
}

TEST_F(OutputTest, Progress) {
    const auto with = [&](const char* style) {
        return run({"warp", "in.exr", "-o", "o.####.exr", "--frames", "1-3", "--overwrite", "--progress", style});
    };
    silent(with("none"));
    EXPECT_NE(with("plain").err.find("3/3 frames"), std::string::npos);
    depth("zero.exr", [](int, int) { return 0.f; });
    const Ended failing = run({"warp", "in.exr", "-o", "z.exr", "--depth", "zero.exr", "--progress", "plain"});
    EXPECT_NE(failing.err.find("0/1 frame, 1 failed"), std::string::npos) << failing.err;
    EXPECT_EQ(with("plain").err.find('\r'), std::string::npos);
    EXPECT_EQ(with("auto").err.find('\r'), std::string::npos) << "no bar where there is no terminal";
    const Ended bar = with("bar");
    EXPECT_NE(bar.err.find("\r"), std::string::npos);
    EXPECT_NE(bar.err.find("3/3 frames"), std::string::npos);
    EXPECT_EQ(bar.err.back(), '\n');
    // script gives the program a terminal
    const Ended terminal =
        tool({"script", "-qec", std::string(EIKONAL_PROGRAM) + " warp in.exr -o o.####.exr --frames 1-3 --overwrite",
              "/dev/null"});
    EXPECT_EQ(terminal.status, 0);
    EXPECT_NE(terminal.out.find("\033[K"), std::string::npos);
}

TEST_F(OutputTest, VerboseSaysWhatIsComputed) {
    const Ended ended = run({"warp", "in.exr", "-o", "o.exr", "--scene", "air.toml", "--verbose"});
    EXPECT_EQ(ended.status, 0);
    EXPECT_GE(ended.lines().size(), 3u);
    for (const std::string& line : ended.lines()) EXPECT_TRUE(line.starts_with("eikonal: ")) << line;
    EXPECT_NE(ended.err.find("first-order"), std::string::npos);
}

TEST_F(OutputTest, FieldSlices) {
    silent(run({"field", "--scene", "air.toml", "-o", "f.####.exr", "--frame", "5"}));
    EXPECT_EQ(made("f.").size(), 16u);
    const Pixels slice = read("f.0003.exr");
    EXPECT_EQ(slice.spec.width, 16);
    EXPECT_EQ(slice.spec.height, 16);
    // OpenEXR sorts channels by name.
    for (const char* name : {"n", "F.x", "F.y", "F.z"}) EXPECT_NO_THROW(slice.channel(name));
    EXPECT_EQ(slice.spec.format, OIIO::TypeDesc::FLOAT);
    const auto number = [&](const char* key) { return slice.spec.get_float_attribute(key, -1); };
    EXPECT_FLOAT_EQ(number("eikonal/period.x"), 4);
    EXPECT_FLOAT_EQ(number("eikonal/period.z"), 40);
    EXPECT_FLOAT_EQ(number("eikonal/period.t"), 4);
    EXPECT_FLOAT_EQ(number("eikonal/spacing.y"), 4.0f / 16);
    EXPECT_FLOAT_EQ(number("eikonal/z"), 3 * 40.0f / 16);
    EXPECT_FLOAT_EQ(number("eikonal/time"), 4.0f / 24);
    // The mean force over a period is zero, that of each row of F.x too: n is periodic.
    double sum = 0, size = 0;
    for (int x = 0; x < 16; ++x) {
        const double f = slice.at(x, 7, slice.channel("F.x"));
        sum += f;
        size += f * f;
    }
    EXPECT_GT(size, 0);
    EXPECT_LT(std::abs(sum / 16), 1e-4 * std::sqrt(size / 16));
    for (const char* form : {"screens", "gradient-noise"}) {
        silent(run({"field", "--scene", "air.toml", "-o", "g.####.exr", "--overwrite", "--set",
                    std::string("medium.0.form=") + form, "--set", "medium.0.lattice=", "--set", "medium.0.period="}));
        EXPECT_GT(rms(read("g.0000.exr")), 0) << form;
    }
    refused(run({"field", "--scene", "air.toml", "-o", "h.####.exr", "--medium", "1"}), 2, {"--medium 1", "1 medium"});
    refused(run({"field", "--scene", "air.toml", "-o", "h.exr"}), 2, {"-o", "h.exr", "h.####.exr"});
}

}  // namespace
}  // namespace program_test
