// The real programs at the ends of every range (noise/README.md, "Extremes"). Each run gives a finite map within
// seconds, or one clear line. The values are judged by extremes_view_test, extremes_media_test and the tests of each
// module.
#include <cmath>
#include <limits>

#include "tests/programs/program_run.h"

namespace program_test {
namespace {

constexpr double kSeconds = 60;  ///< a hang, not a slow machine
constexpr float kInfinity = std::numeric_limits<float>::infinity();

class ExtremesTest : public Program {
  protected:
    Words together(Words words, const Words& more) const {
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }

    /// Runs `map` and expects success, with warnings at most, and maps without NaN or infinity; returns its largest
    /// value.
    double finite(const Words& words) const {
        SCOPED_TRACE(testing::PrintToString(words));
        const Ended ended = run(together({"map", "-o", "m.exr", "--overwrite"}, words));
        EXPECT_EQ(ended.status, 0) << ended.err;
        EXPECT_LT(ended.seconds, kSeconds);
        for (const std::string& line : ended.lines()) EXPECT_TRUE(line.starts_with("eikonal: warning: ")) << line;
        if (ended.status != 0) return 0;
        double largest = 0;
        for (const float v : read("m.exr").values) {
            EXPECT_TRUE(std::isfinite(v));
            largest = std::max(largest, std::abs(double{v}));
        }
        return largest;
    }
    void wrong(const Words& words, int status, std::initializer_list<std::string> fragments) const {
        SCOPED_TRACE(testing::PrintToString(words));
        const Ended ended = run(together({"map", "-o", "n.exr", "--overwrite"}, words));
        refused(ended, status, fragments);
        EXPECT_LT(ended.seconds, kSeconds);
        EXPECT_FALSE(fs::exists(path("n.exr")));
    }
    static Words set(const std::string& file, const std::string& setting) {
        return {"--scene", file, "--set", setting};
    }

    static std::string scene(const std::string& medium, const std::string& size = "[16, 12]") {
        return "[camera]\nresolution = " + size +
               "\nhorizontal_fov = 5\n[plate]\ndistance = 30\nfar = 30\n[[medium]]\n" + medium;
    }
    /// air.toml of every form, and hot.toml, road.toml.
    void scenes(const std::string& size = "[16, 12]") const {
        const std::string air = "type = \"turbulence\"\ncn2 = 1e-11\nouter_scale = 1\ninner_scale = 0.3\n";
        write_text("screens.toml", scene(air, size));
        write_text("noise.toml", scene(air + "form = \"gradient-noise\"\n", size));
        write_text("lattice.toml",
                   scene(air + "form = \"lattice\"\nlattice = [16, 16, 16, 4]\nperiod = [4, 4, 40, 4]\n", size));
        write_text("blobs.toml", scene("type = \"blobs\"\nblob = [{center = [0.05, 1.5, -5]}]\n", size));
        write_text(
            "source.toml",
            scene("type = \"blobs\"\nsource = [{from = [-1, 1.5, -5], to = [1, 1.5, -5], lifetime = 5}]\n", size));
        write_text("surface.toml", scene("type = \"surface\"\norigin = [0, 1, 0]\n", size));
    }
    inline static const Words kAir{"screens.toml", "noise.toml", "lattice.toml"};
    inline static const Words kAll{"screens.toml", "noise.toml", "lattice.toml", "blobs.toml", "surface.toml"};
};

TEST_F(ExtremesTest, Turbulence) {
    scenes();
    for (const std::string& file : kAir) {
        for (const char* cn2 : {"0", "5e-324"}) EXPECT_EQ(finite(set(file, std::string("medium.0.cn2=") + cn2)), 0);
        EXPECT_GT(finite(set(file, "medium.0.cn2=1e-6")), 0.1);
        wrong(set(file, "medium.0.cn2=1e12"), 2, {"medium.0", "px rms", "1e+06 px", "lower its cn2"});
        wrong(set(file, "medium.0.cn2=-1e-15"), 2, {"medium.0.cn2", "-1e-15", ">= 0"});
        for (const char* alpha : {"0", "5e-324", "1e12"}) {
            EXPECT_GT(finite(together(set(file, std::string("medium.0.alpha=") + alpha), {"--frames", "7"})), 1e-3);
        }
        wrong(set(file, "medium.0.alpha=1e13"), 2, {"medium.0.alpha", "<= 1000000000000"});
        wrong(set(file, "medium.0.inner_scale=2"), 2, {"medium.0.outer_scale", "value 1", "must be > inner_scale, 2"});
        wrong(set(file, "medium.0.inner_scale=nan"), 2, {"medium.0.inner_scale", "finite"});
        EXPECT_GT(finite(set(file, "medium.0.velocity=[1e12, 1e12, 1e12]")), 1e-3);
        EXPECT_GE(finite(set(file, "medium.0.falloff.length=1e-12")), 0);
        EXPECT_EQ(finite(set(file, "optics.exaggeration=0")), 0);
    }
    for (const char* scale : {"1e-12", "0.999999"}) {
        EXPECT_GT(finite(set("screens.toml", std::string("medium.0.inner_scale=") + scale)), 1e-4);
        EXPECT_GT(finite(set("lattice.toml", std::string("medium.0.inner_scale=") + scale)), 1e-4);
    }
    wrong(set("noise.toml", "medium.0.inner_scale=1e-12"), 2, {"steps a ray", "at most 20000", "inner_scale"});
    EXPECT_GT(finite(set("screens.toml", "medium.0.outer_scale=1e12")), 1e-3);
    for (const char* file : {"screens.toml", "lattice.toml"}) {
        const Words paper = together(set(file, "medium.0.spectrum=paper"), {"--set", "medium.0.cn2="});
        EXPECT_GT(finite(together(paper, {"--set", "medium.0.lowest_wavenumber=0"})), 0);
        wrong(together(paper, {"--set", "medium.0.lowest_wavenumber=1e12"}), 2,
              {"lowest_wavenumber = 1e+12", "lower it"});
    }
    write_text("sparse.toml", scene("type = \"turbulence\"\nform = \"lattice\"\ncn2 = 1e-8\nlattice = [2, 2, 2, 2]\n"));
    EXPECT_GE(finite({"--scene", "sparse.toml"}), 0);
}

TEST_F(ExtremesTest, HotAir) {
    scenes();
    for (const char* kelvin : {"1", "1e5"}) {
        const std::string T = kelvin;
        EXPECT_GT(finite(set("blobs.toml", "medium.0.blob.0.temperature=" + T)), 0.01) << T;
        EXPECT_GE(finite(set("surface.toml", "medium.0.surface_temperature=" + T)), 0) << T;
        for (const char* file : {"blobs.toml", "surface.toml"})
            EXPECT_GE(finite(set(file, "optics.ambient_temperature=" + T)), 0);
    }
    for (const char* kelvin : {"0.5", "1e10"}) {
        const std::string T = kelvin;
        wrong(set("blobs.toml", "medium.0.blob.0.temperature=" + T), 2,
              {"blob.0.temperature", ">= 1 and <= 1000000000"});
        wrong(set("surface.toml", "medium.0.surface_temperature=" + T), 2,
              {"surface_temperature", ">= 1 and <= 1000000000"});
        wrong(set("surface.toml", "optics.ambient_temperature=" + T), 2,
              {"ambient_temperature", ">= 1 and <= 1000000000"});
    }
    for (const char* sigma : {"1e-6", "1", "1e9"})
        for (const Words& more : {Words{}, Words{"--model", "second-order"}})
            EXPECT_GE(finite(together(set("blobs.toml", std::string("medium.0.blob.0.sigma=") + sigma), more)), 0);
    wrong(set("blobs.toml", "medium.0.blob.0.sigma=1e-7"), 2, {"sigma", ">= 1e-06 and <= 1000000000"});
    wrong(set("surface.toml", "optics.exaggeration=1e12"), 2, {"medium.0", "not positive", "exaggeration"});
    for (const char* dropoff : {"1e-12", "1e12"})
        EXPECT_GE(finite(set("surface.toml", std::string("medium.0.dropoff=") + dropoff)), 0);

    EXPECT_GT(finite(together(set("source.toml", "time.fps=1"), {"--frames", "1000000000"})), 1e-3);
    wrong(together(set("source.toml", "time.fps=1"), {"--frames", "2000000000"}), 1,
          {"frame 2000000000", "medium.0", "±1e+09 s", "first_frame"});
}

TEST_F(ExtremesTest, DistancesAndLenses) {
    scenes();
    for (const std::string& file : kAll) {
        const bool stepped = file == "noise.toml" || file == "lattice.toml";
        for (const char* metres : {"1e-12", "1e-6", "1e9"}) {
            const Words words{"--scene", file, "--distance", metres, "--far", metres};
            if (stepped && std::stod(metres) > 1)
                wrong(words, 2, {"medium.0", "steps a ray", "at most 20000", "form=\"screens\""});
            else
                EXPECT_GE(finite(words), 0);
        }
        for (const char* fov : {"0.0001", "179", "179.99"}) {
            const Words words{"--scene", file, "--fov", fov};
            if (stepped && (fov == std::string("179.99") || (file == "noise.toml" && fov == std::string("179"))))
                wrong(words, 2, {"medium.0", "steps a ray"});
            else
                EXPECT_GE(finite(words), 0);
        }
        EXPECT_GE(finite(together(set(file, "camera.horizontal_fov="),
                                  {"--set", "camera.projection=orthographic", "--set", "camera.width=1e12"})),
                  0);
        wrong({"--scene", file, "--fov", "180"}, 2, {"--fov", "180", "179.99"});
    }
    for (const char* metres : {"0", "-1", "1e-320", "1e300"})
        wrong({"--scene", "screens.toml", "--distance", metres}, 2, {"--distance", metres, "from 1e-12 to 1e+12 m"});
    for (const char* metres : {"nan", "inf"})
        wrong({"--scene", "screens.toml", "--distance", metres}, 2, {"--distance", "not a number"});
    wrong({"--scene", "screens.toml", "--ground", "1e-300,50%"}, 2, {"--ground", "height", "from 1e-12"});
    for (const char* gain : {"1e15", "1e300"}) {
        for (const auto& [scene, option] : {std::pair{"screens.toml", "--gain"}, std::pair{"blobs.toml", "--rms"}}) {
            const Ended ended = run({"map", "-o", "m.exr", "--overwrite", "--scene", scene, option, gain});
            EXPECT_EQ(ended.status, 1) << ended.err;
            ASSERT_EQ(ended.lines().size(), 2U) << ended.err;
            EXPECT_NE(ended.lines()[0].find("rays fold, and the picture tears"), std::string::npos) << ended.err;
            for (const char* fragment : {"frame 1", "1e+06 px", option})
                EXPECT_NE(ended.lines()[1].find(fragment), std::string::npos) << ended.err;
        }
    }
    EXPECT_EQ(finite({"--scene", "screens.toml", "--gain", "0"}), 0);
    // A path longer than the lattice's period gives a warning.
    EXPECT_GT(finite({"--scene", "lattice.toml", "--distance", "400", "--far", "400"}), 1e-3);
}

TEST_F(ExtremesTest, Pictures) {
    for (const char* size : {"[1, 1]", "[16384, 1]", "[1, 512]"}) {
        scenes(size);
        for (const std::string& file : kAll) EXPECT_GE(finite({"--scene", file, "--distance", "3", "--far", "3"}), 0);
    }
    scenes("[1, 16384]");
    for (const char* file : {"screens.toml", "blobs.toml", "surface.toml"}) EXPECT_GE(finite({"--scene", file}), 0);
    wrong({"--scene", "lattice.toml"}, 2, {"medium.0", "steps a ray"});  // 179.97 degrees high
    wrong(set("screens.toml", "camera.resolution=[0, 1]"), 2, {"resolution", ">= 1 and <= 65536"});
}

TEST_F(ExtremesTest, DepthMaps) {
    scenes("[64, 48]");
    for (const std::string& file : kAll)
        for (const char* type : {"z", "ray", "inverse"}) {
            depth("z.exr", [](int x, int y) {
                const float values[] = {0,  1e-45f, 1e-38f, 1e-6f,     5,
                                        30, 1e9f,   3e38f,  kInfinity, std::numeric_limits<float>::quiet_NaN()};
                return values[(7 * x + y) % 10];
            });
            const Words words{"--scene", file, "--depth", "z.exr", "--depth-type", type, "--far", "30"};
            EXPECT_GE(finite(words), 0);
            EXPECT_GE(finite(together(words, {"--depth-meeting", "own"})), 0);
        }
    for (const float bad : {-1.0f, -1e-40f, -kInfinity}) {
        depth("z.exr", [&](int x, int) { return x == 3 ? bad : 5; });
        wrong({"--scene", "screens.toml", "--depth", "z.exr"}, 1, {"frame 1", "z.exr", "negative depth"});
    }
    for (const float none : {0.0f, std::numeric_limits<float>::quiet_NaN()}) {
        depth("z.exr", [&](int, int) { return none; });
        wrong({"--scene", "screens.toml", "--depth", "z.exr"}, 1, {"frame 1", "z.exr", "holds no depth"});
    }
    // The map has depths beyond every setting.
    depth("z.exr", [](int x, int) { return x < 2 ? 5000 : 5; });
    const Words words{"map", "--scene", "screens.toml", "--set", "plate=", "--depth", "z.exr", "-o", "f.exr"};
    const Ended told = run(words);
    EXPECT_EQ(told.status, 0);
    ASSERT_EQ(told.lines().size(), 1) << told.err;
    for (const char* part : {"warning: depth reaches 5000 m", "default --far 1000 m; medium.0: its thin screens end"})
        EXPECT_NE(told.err.find(part), std::string::npos) << told.err;
    silent(run(together(words, {"--overwrite", "--far", "1000"})));
    depth("z.exr", [](int x, int) { return x < 2 ? 5e5F : 5; });
    wrong({"--scene", "lattice.toml", "--set", "plate={far=5}", "--depth", "z.exr"}, 1,
          {"frame 1", "medium.0: depth reaches 500000 m", "at most 20000", "shorter --far"});
    depth("z.exr", [](int x, int) { return x < 2 ? 20 : 5; });
    silent(run({"map", "--scene", "lattice.toml", "--set", "plate={far=5}", "--depth", "z.exr", "-o", "g.exr"}));
}

// A camera zooms out until its corner rays are too long, and in until a medium that was too weak to see is visible.
TEST_F(ExtremesTest, Zooms) {
    scenes();
    write_text("zoom.chan", "1 0 1.5 0 0 0 0 5\n2 0 1.5 0 0 0 0 179.9\n3 0 1.5 0 0 0 0 1e-4\n");
    const Words zoom = set("lattice.toml", "camera.path=zoom.chan");
    EXPECT_GE(finite(together(zoom, {"--frames", "1"})), 0);
    wrong(together(zoom, {"--frames", "2"}), 1, {"frame 2", "medium.0", "zoomed out", "at most 20000"});
    EXPECT_GT(finite(together(zoom, {"--frames", "3", "--set", "medium.0.cn2=1e-18"})), 1e-3);
}

TEST_F(ExtremesTest, Tracer) {
    scenes("[4, 3]");
    const std::string wall = "[[object]]\nshape = \"plane\"\norigin = [0, 0, -20]\nnormal = [0, 0, 1]\n";
    const auto trace = [&](const std::string& file, const std::string& setting) {
        SCOPED_TRACE(file + " " + setting);
        write_text("traced.toml", bytes(file) + wall);
        const Ended ended =
            tool({EIKONAL_TRACE_PROGRAM, "render", "traced.toml", "-o", "t.exr", "--overwrite", "--set", setting});
        EXPECT_LT(ended.seconds, kSeconds);
        if (ended.status == 0) {
            const Pixels pixels = read("t.exr");
            for (const char* name : {"R", "G", "B", "u", "v"})
                for (int y = 0; y < 3; ++y)
                    for (int x = 0; x < 4; ++x)
                        EXPECT_TRUE(std::isfinite(pixels.at(x, y, pixels.channel(name)))) << name;
        } else {
            EXPECT_EQ(ended.status, 2) << ended.err;
            EXPECT_EQ(ended.lines().size(), 1) << ended.err;
        }
        return ended.status;
    };
    for (const std::string& file : kAll) {
        EXPECT_EQ(trace(file, "camera.horizontal_fov=0.0001"), 0);
        if (file == "noise.toml") continue;  // slow
        EXPECT_EQ(trace(file, "camera.horizontal_fov=179"), 0);
    }
    for (const char* kelvin : {"1", "1e5"}) {
        EXPECT_EQ(trace("blobs.toml", std::string("medium.0.blob.0.temperature=") + kelvin), 0);
        EXPECT_EQ(trace("surface.toml", std::string("medium.0.surface_temperature=") + kelvin), 0);
    }
    for (const char* sigma : {"1e-6", "1e9"})
        EXPECT_EQ(trace("blobs.toml", std::string("medium.0.blob.0.sigma=") + sigma), 0);
    EXPECT_EQ(trace("lattice.toml", "medium.0.alpha=1e12"), 0);
    EXPECT_EQ(trace("screens.toml", "medium.0.cn2=5e-324"), 0);
    EXPECT_EQ(trace("screens.toml", "medium.0.inner_scale=2"), 2);
}

}  // namespace
}  // namespace program_test
