// A frame depends on the scene, the input and its number alone. It has the same bytes for any threads, chunks and
// order, and the same cost at any place of the shot.

#include <algorithm>

#include "tests/programs/program_run.h"

namespace program_test {
namespace {

class DeterminismTest : public Program {
  protected:
    DeterminismTest() {
        air();
        for (int f = 1; f <= 4; ++f) plate("in.000" + std::to_string(f) + ".exr");
    }
    /// Makes frames into files that begin with `prefix`, in one call for each list.
    void make(const std::string& prefix, const Words& lists, const Words& more = {}) const {
        for (const std::string& list : lists) {
            Words words{"warp",         "in.####.exr",
                        "-o",           prefix + ".####.exr",
                        "--stmap",      prefix + "st.####.exr",
                        "--scene",      "air.toml",
                        "--frames",     list,
                        "--shutter",    "0.5",
                        "--samples",    "2",
                        "--dispersion", "1"};
            words.insert(words.end(), more.begin(), more.end());
            silent(run(words));
        }
    }
    void expect_same(const std::string& a, const std::string& b) const {
        for (const char* kind : {".000", "st.000"})
            for (int f = 1; f <= 4; ++f)
                EXPECT_TRUE(bytes(a + kind + std::to_string(f) + ".exr") ==
                            bytes(b + kind + std::to_string(f) + ".exr"))
                    << a << b << f;
    }
};

TEST_F(DeterminismTest, AnyThreadsChunksAndOrder) {
    make("a", {"1-4"}, {"--threads", "1"});
    make("b", {"1-4"}, {"--threads", "2"});
    make("c", {"1-2", "3-4"});
    make("d", {"4,3,2,1"}, {"--threads", "5"});
    expect_same("a", "b");
    expect_same("a", "c");
    expect_same("a", "d");
    EXPECT_NE(bytes("a.0001.exr"), bytes("a.0002.exr"));
}

TEST_F(DeterminismTest, EveryFormOfAir) {
    for (const char* form : {"screens", "gradient-noise", "lattice"}) {
        const Words common{"map",
                           "--scene",
                           "air.toml",
                           "--set",
                           std::string("medium.0.form=") + form,
                           "--set",
                           "medium.0.lattice=",
                           "--set",
                           "medium.0.period=",
                           "--set",
                           "medium.0.outer_scale=0.6",
                           "--distance",
                           "10",
                           "--set",
                           "camera.resolution=[32, 24]"};
        Words a = common, b = common;
        a.insert(a.end(), {"-o", "a.####.exr", "--frames", "7-8", "--threads", "1", "--overwrite"});
        b.insert(b.end(), {"-o", "b.####.exr", "--frames", "8,7", "--threads", "2", "--overwrite"});
        EXPECT_EQ(run(a).status, 0);
        EXPECT_EQ(run(b).status, 0);
        for (const char* f : {"7", "8"})
            EXPECT_EQ(bytes(std::string("a.000") + f + ".exr"), bytes(std::string("b.000") + f + ".exr")) << form;
        EXPECT_GT(rms(read("a.0007.exr")), 0) << form;
    }
}

TEST_F(DeterminismTest, Movies) {
    for (const char* threads : {"1", "2"})
        silent(run({"warp", "in.####.exr", "-o", std::string("m") + threads + ".mp4", "--scene", "air.toml",
                    "--threads", threads}));
    EXPECT_EQ(bytes("m1.mp4"), bytes("m2.mp4"));
}

TEST_F(DeterminismTest, RandomAccess) {
    const auto map = [&](const std::string& out, const std::string& frames) {
        const Ended ended = run({"map", "--preset", "gentle", "--set", "camera.resolution=[64, 48]", "-o",
                                 out + ".####.exr", "--frames", frames, "--overwrite"});
        silent(ended);
        return ended.seconds;
    };
    map("chunk", "4999-5001");
    map("alone", "5000");
    EXPECT_EQ(bytes("alone.5000.exr"), bytes("chunk.5000.exr"));
    std::vector<double> ratios;
    for (int i = 0; i < 7; ++i) ratios.push_back(map("alone", "5000") / map("alone", "1"));
    std::sort(ratios.begin(), ratios.end());
    EXPECT_LT(ratios[3], 1.5) << "frame 5000 costs what frame 1 costs";
}

}  // namespace
}  // namespace program_test
