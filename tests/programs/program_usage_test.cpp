// Wrong usage and invalid scenes: status 2, one line that names what is wrong, and no file written. Also the help.

#include <algorithm>

#include "tests/programs/program_run.h"

namespace program_test {
namespace {

class UsageTest : public Program {
  protected:
    UsageTest() {
        plate("in.png");
        air();
    }
    /// Refused with status 2 before anything was made.
    void wrong(Words words, std::initializer_list<std::string> fragments) const {
        const Words before = names();
        refused(run(std::move(words)), 2, fragments);
        EXPECT_EQ(names(), before);
    }
    void wrong_warp(Words more, std::initializer_list<std::string> fragments) const {
        more.insert(more.begin(), {"warp", "in.png", "-o", "out.png"});
        wrong(std::move(more), fragments);
    }
};

TEST_F(UsageTest, HelpAndVersionAreNoErrors) {
    for (const Words& words : std::vector<Words>{
             {"--help"}, {"--version"}, {"warp", "--help"}, {"map", "-h"}, {"field", "--help"}, {"presets"}}) {
        const Ended ended = run(words);
        silent(ended);
        EXPECT_FALSE(ended.out.empty());
        std::size_t longest = 0;
        for (std::size_t at = 0; at < ended.out.size();) {
            const std::size_t end = ended.out.find('\n', at);
            longest = std::max(longest, end - at);
            at = end + 1;
        }
        EXPECT_LE(longest, 120u) << "bytes in a line of " << words.front();
        EXPECT_EQ(ended.out.find("\n\n\n"), std::string::npos);
    }
    EXPECT_NE(run({"warp", "--help"}).out.find("Usage: eikonal warp INPUT -o OUTPUT [options]"), std::string::npos);
    EXPECT_NE(run({"presets"}).out.find("campfire "), std::string::npos);
}

TEST_F(UsageTest, CommandsAndOptions) {
    refused(run({}), 2, {"warp, map, field, presets"});
    refused(run({"wrap"}), 2, {"'wrap'", "did you mean 'warp'"});
    wrong({"warp", "in.png"}, {"--output"});
    wrong({"warp", "-o", "out.png"}, {"INPUT"});
    wrong({"warp", "in.png", "other.png", "-o", "out.png"}, {"other.png"});
    wrong_warp({"--fliter", "cubic"}, {"--fliter", "did you mean '--filter'"});
    wrong_warp({"--filter", "cubik"}, {"--filter", "'cubik'", "bilinear|cubic|lanczos3|area", "did you mean 'cubic'"});
    wrong_warp({"--model", "screns"}, {"--model", "did you mean 'screens'"});
    wrong_warp({"--distance"}, {"--distance", "missing"});
    wrong_warp({"-o", "twice.png"}, {"--output", "more than once"});
    wrong_warp({"--frames", "1", "--frames", "2"}, {"--frames", "more than once"});
    for (const char* text : {"nan", "five", "1e999", "5m"})
        wrong_warp({"--distance", text}, {"--distance", "'" + std::string(text) + "'"});
    wrong_warp({"--distance", "0"}, {"--distance", "from 1e-12"});
    wrong_warp({"--rms", "-1"}, {"--rms", "0 or more"});
    wrong_warp({"--shutter", "2"}, {"--shutter", "from 0 to 1"});
    wrong_warp({"--threads", "0"}, {"--threads", "1 to 1024"});
    wrong_warp({"--seed", "-1"}, {"--seed"});
    wrong_warp({"--seed", "99999999999999999999"}, {"--seed", "from 0 to 18446744073709551615"});
    wrong_warp({"--fov", "180"}, {"--fov", "179.99"});
    EXPECT_NE(run({"warp", "in.png", "-o", "out.png", "--tolerences", "1"}).err.find("did you mean '--tolerance'"),
              std::string::npos);
    wrong_warp({"--ground", "2"}, {"--ground", "HEIGHT,HORIZON"});
    wrong_warp({"--ground", "-2,50%"}, {"--ground", "-2"});
    wrong_warp({"--ground", "1.5,0.45"}, {"--ground", "0.45", "did you mean 45%?"});
    wrong_warp({"--depth-range", "5", "--depth", "in.png"}, {"--depth-range", "NEAR,FAR"});
}

TEST_F(UsageTest, Contradictions) {
    wrong_warp({"--distance", "5", "--ground", "1,50%"}, {"--distance", "--ground"});
    wrong_warp({"--distance", "5", "--depth", "in.png"}, {"--distance", "--depth"});
    wrong_warp({"--scene", "air.toml", "--preset", "gentle"}, {"--scene", "--preset"});
    wrong_warp({"--depth-range", "1,2"}, {"--depth-range", "--depth"});
    wrong_warp({"--depth-type", "inverse"}, {"--depth-type", "--depth"});
    for (const Words& one : {Words{"--distance", "9"}, Words{}}) {
        Words words = one;
        words.insert(words.end(), {"--depth-meeting", "own"});
        wrong_warp(words, {"--depth-meeting", "one distance"});
    }
    wrong_warp({"--codec", "h264"}, {"--codec", "out.png", "movie"});
    wrong_warp({"--quality", "20"}, {"--quality", "out.png", "movie"});
    wrong_warp({"--samples", "4"}, {"--samples", "--shutter"});
    wrong_warp({"--far", "10", "--distance", "20"}, {"--far", "10", "20"});
    wrong_warp({"--scene", "air.toml", "--model", "screens"}, {"--model screens", "form"});
    wrong_warp({"--scene", "air.toml", "--model", "spectral"}, {"--model spectral", "orthographic"});
    wrong({"map", "--scene", "air.toml", "-o", "m.exr", "--depth", ":Z"}, {"--depth :Z", "INPUT"});
    wrong_warp({"--scene", "air.toml", "--set", "medium.0.cn2=0", "--rms", "1"}, {"--rms 1"});
}

TEST_F(UsageTest, FrameLists) {
    for (const char* text : {"", "x", "5-", "1-9x0", "1,,2", "1-2-3", "1-2000000000"}) {
        SCOPED_TRACE(text);
        wrong({"warp", "in.png", "-o", "o.####.png", "--frames", text},
              {"--frames '" + std::string(text) + "'", "1-9x2"});
    }
    wrong({"warp", "in.png", "-o", "o.####.png", "--frames", "1-100000000000"}, {"--frames", "±2147483647"});
    wrong_warp({"--frames", "1-4"}, {"-o", "out.png", "4 frames", "out.####.png"});
    silent(run({"map", "--scene", "air.toml", "-o", "m.####.exr", "--frames", "-2--1,1-5x2,8-4:2,7"}));
    EXPECT_EQ(names(), (Words{"air.toml", "in.png", "m.-0001.exr", "m.-0002.exr", "m.0001.exr", "m.0003.exr",
                              "m.0004.exr", "m.0005.exr", "m.0006.exr", "m.0007.exr", "m.0008.exr"}));
}

TEST_F(UsageTest, SceneFiles) {
    const auto scene = [&](const std::string& text, std::initializer_list<std::string> fragments) {
        write_text("bad.toml", text);
        wrong_warp({"--scene", "bad.toml"}, fragments);
    };
    scene("[camera]\nhorizontal_fow = 5\n", {"bad.toml:2", "horizontal_fow", "did you mean 'horizontal_fov'"});
    scene("\n[[medum]]\n", {"bad.toml:2", "medum", "did you mean 'medium'"});
    scene("[[medium]]\ntype = \"turbulence\"\ncn2 = \"strong\"\n", {"bad.toml:3", "cn2", "number"});
    scene("[[medium]]\ntype = \"turbulense\"\n", {"bad.toml:2", "turbulense", "did you mean 'turbulence'"});
    scene("[[medium]]\ncn2 = 1\n", {"bad.toml:1", "type"});
    scene("[camera\n", {"bad.toml:1"});
    scene("[camera]\nposition = [1, 2]\n", {"bad.toml:2", "position"});
    scene("[[medium]]\ntype = \"turbulence\"\ncn2 = nan\n", {"bad.toml:3", "cn2"});
    scene("[camera]\npath = \"no.chan\"\n", {"no.chan"});
    wrong_warp({"--scene", "none.toml"}, {"none.toml"});
    wrong_warp({"--preset", "gentel"}, {"gentel", "did you mean 'gentle'"});
    wrong_warp({"--set", "medium"}, {"--set medium", "KEY=VALUE"});
    wrong_warp({"--set", "medium.0.cn=1"}, {"--set medium.0.cn=1", "did you mean 'cn2'"});
    wrong_warp({"--set", "medium.0.type=surface"}, {"gentle.toml", "medium.0 of type \"surface\" has no key '"});
    wrong_warp({"--set", "medium.0.cn2=strong"}, {"--set medium.0.cn2=strong", "number"});
    wrong_warp({"--set", "medium.7.cn2=1"}, {"--set medium.7.cn2=1"});
    wrong_warp({"--set", "medium.0.cn2=-1"}, {"--set medium.0.cn2=-1", "cn2"});
}

TEST_F(UsageTest, ImpossibleLatticesAreRefusedBeforeMemoryIsTaken) {
    const auto lattice = [&](const std::string& size, std::initializer_list<std::string> fragments) {
        for (const char* command : {"map", "field"}) {
            const Ended ended =
                run({command, "--scene", "air.toml", "-o", "m.####.exr", "--set", "medium.0.lattice=" + size});
            refused(ended, 2, fragments);
            EXPECT_LT(ended.peak_kb, 1000000);  // the sanitizers alone take 310000
            EXPECT_LT(ended.seconds, 5);
        }
    };
    lattice("[0, 16, 16, 8]", {"lattice", "0"});
    lattice("[16, 1, 16, 8]", {"lattice", "1"});
    lattice("[16, 16, 17, 8]", {"lattice", "17", "16 or 18"});
    lattice("[-4, 16, 16, 8]", {"lattice", "-4"});
    lattice("[16, 16, 16]", {"lattice"});
    lattice("[8192, 8192, 8192, 64]", {"lattice", "GB", "available"});
    lattice("[1000000, 1000000, 1000000, 1000000]", {"lattice", "1000000"});
    refused(run({"field", "--scene", "air.toml", "-o", "f.####.exr", "--set", "medium.0.form=gradient-noise", "--set",
                 "medium.0.lattice=[60000, 60000, 2, 2]"}),
            2, {"slices of 60000 x 60000", "GB", "available", "lattice"});
    wrong({"map", "-o", "m.exr", "--set", "camera.resolution=[65536, 65536]"},
          {"a frame of this size", "GB", "available"});
}

TEST_F(UsageTest, OutputsThatCannotBe) {
    fs::create_directory(path("folder.png"));
    const auto output = [&](const std::string& name, std::initializer_list<std::string> fragments) {
        wrong({"warp", "in.png", "-o", name}, fragments);
    };
    output("out.xyz", {"-o", "out.xyz", "'.xyz'"});
    output("out", {"-o", "'out'"});
    output("out.pbm", {"-o", "out.pbm", "'.pbm'"});
    output("", {"-o", "no file name"});
    output("missing/out.png", {"-o", "'missing'", "does not exist"});
    output("folder.png", {"-o", "folder.png", "is a folder"});
    output("/dev/full", {"-o", "/dev/full", "not a regular file"});
    wrong_warp({"--stmap", "st.png"}, {"--stmap", "st.png", "EXR"});
    wrong_warp({"--displacement", "d.mov"}, {"--displacement", "d.mov", "movie"});
    wrong_warp({"--report", "missing/r.json"}, {"--report", "'missing'"});
    wrong({"map", "-o", "m.png"}, {"-o", "m.png", "EXR"});
    wrong({"warp", "", "-o", "out.png"}, {"INPUT"});
}

TEST_F(UsageTest, OutputEqualToInput) {
    for (const char* n : {"s.0001.png", "s.0002.png", "s.0003.png"}) plate(n);
    fs::create_symlink("in.png", path("link.png"));
    fs::create_symlink(".", path("here"));
    const std::string before = bytes("in.png");
    const auto same = [&](const std::string& input, const std::string& output) {
        wrong({"warp", input, "-o", output, "--overwrite"}, {"the input", "-o", "same file"});
    };
    same("in.png", "in.png");
    same("in.png", "./in.png");
    same("in.png", path("in.png").string());
    same("in.png", "link.png");
    same("link.png", "in.png");
    same("in.png", "here/in.png");
    same("s.####.png", "s.####.png");
    same("s.####.png", "here/s.%04d.png");
    wrong({"warp", "s.####.png", "--frames", "1", "-o", "s.0003.png", "--overwrite"}, {"the input", "same file"});
    EXPECT_EQ(bytes("in.png"), before);

    depth("z.exr", [](int, int) { return 10.f; });
    plate("in.exr");
    wrong({"warp", "in.exr", "--depth", "z.exr", "-o", "z.exr", "--overwrite"}, {"--depth", "-o", "same file"});
    wrong({"warp", "in.exr", "--mask", "z.exr", "-o", "z.exr", "--overwrite"}, {"--mask", "-o", "same file"});
    wrong({"warp", "in.exr", "-o", "o.exr", "--stmap", "in.exr", "--overwrite"}, {"the input", "--stmap", "same file"});
    wrong({"warp", "in.exr", "-o", "o.exr", "--stmap", "./o.exr"}, {"-o", "--stmap", "same file"});
    wrong({"warp", "in.exr", "-o", "o.exr", "--displacement", "m.exr", "--stmap", "m.exr"},
          {"--displacement", "--stmap", "same file"});
    wrong({"warp", "in.exr", "-o", "o.exr", "--scene", "air.toml", "--report", "air.toml"},
          {"the scene", "--report", "same file"});
}

}  // namespace
}  // namespace program_test
