// Scenes of hot blobs and heated surfaces through the real program. Bad values are reported with their key. Frames
// depend on their number alone. Media that bend no light cost and change nothing.

#include <algorithm>

#include "tests/programs/program_run.h"

namespace program_test {
namespace {

const std::string kView = R"([camera]
resolution = [64, 48]
position = [0, 1, 0]
look_at = [0, 1, -1]
horizontal_fov = 20
[plate]
distance = 8
far = 200
)";

/// A line of hot blobs across the view, carried by a turbulent wind.
const std::string kBlobs = R"([[medium]]
type = "blobs"
[[medium.source]]
from = [-0.6, 0.3, -4]
to = [0.6, 0.3, -4]
rate = 20
temperature = 1000
sigma = 0.1
cooling = 0.5
lifetime = 2
[medium.wind]
rms = 0.3
rise = [0, 0.6, 0]
)";

const std::string kSurface = R"([[medium]]
type = "surface"
surface_temperature = 330
dropoff = 0.02
)";

const std::string kTurbulence = R"([[medium]]
type = "turbulence"
form = "lattice"
cn2 = 2e-9
outer_scale = 1
inner_scale = 0.3
lattice = [16, 16, 16, 8]
period = [4, 4, 10, 4]
)";

class MediaTest : public Program {
  protected:
    MediaTest() {
        write_text("blobs.toml", kView + kBlobs);
        write_text("both.toml", kView + kBlobs + kTurbulence);
        write_text("surface.toml", kView + kSurface);
    }
    Ended map(const std::string& scene, const std::string& output, Words more = {}) const {
        more.insert(more.begin(), {"map", "--scene", scene, "-o", output});
        return run(std::move(more));
    }
    /// A scene of these tables is refused with status 2, in one line with the fragments, and nothing is written.
    void wrong(const std::string& tables, std::initializer_list<std::string> fragments) const {
        SCOPED_TRACE(tables);
        write_text("wrong.toml", kView + tables);
        const Words before = names();
        refused(map("wrong.toml", "m.exr"), 2, fragments);
        EXPECT_EQ(names(), before);
    }
};

TEST_F(MediaTest, BadBlobsNameTheirKey) {
    const std::string head = "[[medium]]\ntype = \"blobs\"\n";
    wrong(head + "blob = [{center = [0, 1, -3], temperature = 0}]\n", {"wrong.toml:11:", "temperature", ">= 1 "});
    wrong(head + "blob = [{center = [0, 1, -3], temperature = -5.0}]\n", {"wrong.toml:11:", "temperature", "-5"});
    wrong(head + "blob = [{center = [0, 1, -3], sigma = 0}]\n", {"wrong.toml:11:", "sigma", ">= 1e-06"});
    wrong(head + "blob = [{center = [0, 1, -3], sigma = -0.1}]\n", {"wrong.toml:11:", "sigma", "-0.1"});
    wrong(head + "blob = [{center = [0, nan, -3]}]\n", {"wrong.toml:11:", "center", "nan"});
    wrong(head + "source = [{from = [0, 1, inf]}]\n", {"wrong.toml:11:", "from", "inf"});
    wrong(head + "source = [{rate = -1}]\n", {"wrong.toml:11:", "rate", "-1", ">= 0"});
    wrong(head + "source = [{rate = 20}]\n", {"wrong.toml:11:", "medium.0.source.0: lifetime is missing"});
    wrong(head + "[[medium.source]]\nrate = 20\n", {"wrong.toml:11:", "medium.0.source.0: lifetime is missing"});
    wrong(head + "source = [{lifetime = 0}]\n", {"wrong.toml:11:", "lifetime", ">= 1e-06"});
    wrong(head + "source = [{lifetime = -2}]\n", {"wrong.toml:11:", "lifetime", "-2"});
    wrong(head + "source = [{cooling = -2}]\n", {"wrong.toml:11:", "cooling", "-2"});
    wrong(head + "wind = {rms = -1}\n", {"wrong.toml:11:", "rms", "-1"});
    wrong(head + "wind = {rise = [0, nan, 0]}\n", {"wrong.toml:11:", "rise", "nan"});
    wrong(head + "wind = {outer_scale = 0}\n", {"wrong.toml:11:", "outer_scale", ">= 1e-06"});
    wrong(head + "source = [{temprature = 900}]\n", {"wrong.toml:11:", "temprature", "temperature"});
}

TEST_F(MediaTest, MillionsOfBlobsAreRefusedAtOnce) {
    wrong("[[medium]]\ntype = \"blobs\"\nsource = [{rate = 1e6, lifetime = 100}]\n",
          {"medium.0.source.0.rate", "1000000", "lower rate or lifetime"});
    EXPECT_LT(map("wrong.toml", "m.exr").peak_kb, 500'000);
}

TEST_F(MediaTest, BadSurfacesNameTheirKey) {
    const std::string head = "[[medium]]\ntype = \"surface\"\n";
    wrong(head + "surface_temperature = 0\n", {"wrong.toml:11:", "surface_temperature", ">= 1 "});
    wrong(head + "dropoff = -0.01\n", {"wrong.toml:11:", "dropoff", "> 0"});
    wrong(head + "normal = [0, 0, 0]\n", {"wrong.toml:11:", "normal", "zero"});
    wrong(head + "origin = [0, nan, 0]\n", {"wrong.toml:11:", "origin", "nan"});
    wrong(head + "origin = [0, 1.5, 0]\n", {"medium.0.origin", "camera", "above"});
    wrong(kSurface + "[[medium]]\ntype = \"profile\"\n", {"wrong.toml:", "profile", "only medium"});
}

TEST_F(MediaTest, ParallelSurfacesAreRefused) {
    wrong(kSurface + kSurface, {"medium.0", "medium.1", "parallel"});
}

TEST_F(MediaTest, CameraThatDivesBelowTheSurface) {
    write_text("dive.chan", "1 0 1 0 0 0 0\n2 0 0.5 0 0 0 0\n3 0 -0.5 0 0 0 0\n");
    std::string scene = kView + kSurface;
    scene.insert(scene.find("[plate]"), "path = \"dive.chan\"\n");
    write_text("dive.toml", scene);
    for (int f = 1; f <= 3; ++f) plate("in.000" + std::to_string(f) + ".png");
    const Ended ended = run({"warp", "in.####.png", "-o", "out.####.png", "--scene", "dive.toml"});
    EXPECT_NE(ended.status, 0);
    EXPECT_NE(ended.err.find("medium.0.origin"), std::string::npos) << ended.err;
    EXPECT_FALSE(fs::exists(path("out.0003.png")));
}

TEST_F(MediaTest, BlobsBendAloneAndBesideTurbulence) {
    silent(map("blobs.toml", "a.exr"));
    silent(map("both.toml", "b.exr"));
    silent(map("both.toml", "t.exr", {"--set", "medium.0.source.0.rate=0"}));
    const Pixels blobs = read("a.exr"), both = read("b.exr"), turbulence = read("t.exr");
    EXPECT_GT(rms(blobs), 0.01);
    EXPECT_GT(rms(turbulence), 0.005);
    for (std::size_t i = 0; i < both.values.size(); ++i)
        ASSERT_NEAR(both.values[i], blobs.values[i] + turbulence.values[i], 1e-4);
}

TEST_F(MediaTest, AFrameIsAFunctionOfItsNumber) {
    for (const std::string scene : {"blobs.toml", "both.toml"}) {
        silent(map(scene, "a.####.exr", {"--frames", "4998-5000", "--threads", "1", "--overwrite"}));
        silent(map(scene, "b.####.exr", {"--frames", "5000", "--threads", "2", "--overwrite"}));
        silent(map(scene, "c.####.exr", {"--frames", "5000,1", "--overwrite"}));
        EXPECT_EQ(bytes("a.5000.exr"), bytes("b.5000.exr")) << scene;
        EXPECT_EQ(bytes("a.5000.exr"), bytes("c.5000.exr")) << scene;
        EXPECT_NE(bytes("a.5000.exr"), bytes("a.4999.exr")) << scene;
    }
    silent(map("blobs.toml", "s.exr", {"--seed", "9"}));
    silent(map("blobs.toml", "d.exr"));
    EXPECT_NE(bytes("s.exr"), bytes("d.exr"));
}

TEST_F(MediaTest, ASurfaceIsTheSameForAnyThreads) {
    silent(map("surface.toml", "a.exr", {"--threads", "1", "--distance", "150"}));
    silent(map("surface.toml", "b.exr", {"--threads", "2", "--distance", "150"}));
    EXPECT_EQ(bytes("a.exr"), bytes("b.exr"));
    EXPECT_GT(rms(read("a.exr")), 0.002);
}

// Every medium has the scene's own temperature. All are left out, and the picture keeps its values.
TEST_F(MediaTest, WhatBendsNothingIsLeftOutAndSaidSo) {
    plate("in.png");
    plate("in.exr");
    write_text("still.toml", kView + R"([optics]
ambient_temperature = 300
[[medium]]
type = "blobs"
blob = [{center = [0, 1, -4], temperature = 300}]
[[medium]]
type = "blobs"
source = [{rate = 0, lifetime = 5}]
[[medium]]
type = "surface"
surface_temperature = 300
[[medium]]
type = "turbulence"
form = "lattice"
cn2 = 1e-22
outer_scale = 1
inner_scale = 0.3
[[medium]]
type = "turbulence"
cn2 = 0
)");
    for (const std::string type : {"png", "exr"}) {
        const Ended ended = run({"warp", "in." + type, "-o", "out." + type, "--scene", "still.toml", "-v"});
        EXPECT_EQ(ended.status, 0) << ended.err;
        for (const std::string note :
             {"medium.0: left out", "medium.1: left out", "medium.2: left out, the surface is at ambient temperature",
              "medium.3: left out, it moves no pixel by more than", "medium.4: left out, its strength is zero"})
            EXPECT_NE(ended.err.find(note), std::string::npos) << note << "\n" << ended.err;
        EXPECT_EQ(read("in." + type).values, read("out." + type).values);
    }
}

TEST_F(MediaTest, FieldWritesBlobsAndSurfaces) {
    silent(run({"field", "--scene", "blobs.toml", "-o", "b.####.exr", "--frame", "30"}));
    silent(run({"field", "--scene", "surface.toml", "-o", "s.####.exr"}));
    const Pixels blobs = read("b.0032.exr"), surface = read("s.0000.exr");
    ASSERT_EQ(blobs.spec.nchannels, 4);
    const auto extremes = [](const Pixels& p) {
        float low = 0, high = 0;
        for (int y = 0; y < p.spec.height; ++y)
            for (int x = 0; x < p.spec.width; ++x) {
                low = std::min(low, p.at(x, y, p.channel("n")));
                high = std::max(high, p.at(x, y, p.channel("n")));
            }
        return std::pair(low, high);
    };
    EXPECT_LT(extremes(blobs).first, -1e-5);  // hot air has less index
    EXPECT_EQ(extremes(blobs).second, 0);
    // n falls from the ambient's to the surface's 2.4e-4 (n0 - 1 = 2.78e-4 at 288 K): -3.1e-5 at 330 K over 293 K
    EXPECT_NEAR(extremes(surface).first, -3.1e-5, 0.2e-5);
    const int bottom = surface.spec.height - 1;
    EXPECT_EQ(surface.at(0, bottom, surface.channel("n")), extremes(surface).first);
    EXPECT_GT(surface.at(0, bottom, surface.channel("F.y")), 0);
}

}  // namespace
}  // namespace program_test
