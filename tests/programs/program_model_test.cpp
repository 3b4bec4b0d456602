// --model auto, --tolerance, and the error that every run states of its maps.

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/programs/program_run.h"

namespace program_test {
namespace {

class ModelTest : public Program {
  protected:
    ModelTest() { air(); }
    nlohmann::json report(Words more, Ended* how = nullptr) const {
        Words words{"map", "--scene", "air.toml", "-o", "m.####.exr", "--overwrite", "--report", "r.json"};
        words.insert(words.end(), more.begin(), more.end());
        const Ended ended = run(words);
        EXPECT_EQ(ended.status, 0) << ended.err;
        if (how != nullptr) *how = ended;
        return nlohmann::json::parse(bytes("r.json"));
    }
    static double p95(const nlohmann::json& report) { return report["frames"][0]["stated_error_px"]["p95"]; }
};

TEST_F(ModelTest, EveryModelStatesItsError) {
    double last = 1e9;
    for (const char* model : {"table", "first-order", "second-order"}) {
        const nlohmann::json r = report({"--model", model});
        const auto& stated = r["frames"][0]["stated_error_px"];
        EXPECT_GE(stated["samples"], 64);
        EXPECT_LE(stated["p50"], stated["p95"]);
        EXPECT_LE(stated["p95"], stated["max"]);
        EXPECT_LT(p95(r), last) << model;
        last = p95(r);
        EXPECT_FALSE(r.contains("model_choice"));
    }
}

TEST_F(ModelTest, AutoTakesTheCheapestWithinTheTolerance) {
    Ended how;
    const nlohmann::json loose = report({"--model", "auto", "--tolerance", "100"}, &how);
    silent(how);
    EXPECT_EQ(loose["model_choice"]["model"], "table");
    EXPECT_EQ(loose["tolerance_px"], 100);
    // A tolerance alone also asks for a choice.
    const double coarse = loose["model_choice"]["p95_px"];
    const nlohmann::json fine = report({"--tolerance", std::to_string(coarse / 20)});
    EXPECT_NE(fine["model_choice"]["model"], "table");
    EXPECT_LE(double{fine["model_choice"]["p95_px"]}, coarse / 20);
    EXPECT_EQ(fine["model_choice"]["tried"][0]["model"], "table");
    EXPECT_EQ(report({"--model", "auto"})["tolerance_px"], 0.1);
}

TEST_F(ModelTest, VerboseTellsChoiceAndError) {
    const Ended ended =
        run({"map", "--scene", "air.toml", "-o", "m.exr", "--model", "auto", "--tolerance", "100", "--verbose"});
    EXPECT_NE(ended.err.find("auto: model table"), std::string::npos) << ended.err;
    EXPECT_NE(ended.err.find("stated error: 95 of 100"), std::string::npos) << ended.err;
}

// Any chunk of a shot makes the same choice and the same bytes.
TEST_F(ModelTest, ChunksAgreeOnTheChoice) {
    const Words choice{"--tolerance", "0.02"};
    const nlohmann::json all = report({"--tolerance", "0.02", "--frames", "1-6"});
    const std::string fifth = bytes("m.0005.exr");
    for (const char* threads : {"1", "2"}) {
        const nlohmann::json one = report({"--tolerance", "0.02", "--frames", "5", "--threads", threads});
        EXPECT_EQ(one["model_choice"], all["model_choice"]);
        EXPECT_EQ(bytes("m.0005.exr"), fifth);
        EXPECT_EQ(one["frames"][0]["stated_error_px"], all["frames"][4]["stated_error_px"]);
    }
}

TEST_F(ModelTest, SaysThatNoModelSuffices) {
    Ended how;
    const nlohmann::json r = report({"--tolerance", "1e-12", "--gain", "50"}, &how);
    EXPECT_EQ(r["model_choice"]["within_tolerance"], false);
    ASSERT_GE(how.lines().size(), 1U);
    EXPECT_NE(how.err.find("--tolerance 1e-12: no model stays within it"), std::string::npos) << how.err;
    EXPECT_NE(how.err.find("eikonal-trace render"), std::string::npos);
}

// A model that the user asked for is kept, and frames beyond the tolerance are reported.
TEST_F(ModelTest, WarnsOfANamedModelBeyondTheTolerance) {
    Ended how;
    const nlohmann::json r = report({"--model", "table", "--tolerance", "1e-9"}, &how);
    EXPECT_EQ(r["models"][0], "table");
    EXPECT_NE(how.err.find("--tolerance 1e-09: 1 of 1 frames go beyond it, frame 1 by most"), std::string::npos)
        << how.err;
}

// The report names what would help: a dearer model if one suffices, the tracer if none does, nothing if no model is
// used.
TEST_F(ModelTest, NamesWhatSuffices) {
    Ended how;
    const double coarse = p95(report({"--model", "table"}));
    report({"--model", "table", "--tolerance", std::to_string(0.9 * coarse)}, &how);
    EXPECT_NE(how.err.find("; --model "), std::string::npos) << how.err;
    EXPECT_NE(how.err.find(" should keep within it"), std::string::npos) << how.err;
    EXPECT_EQ(how.err.find("eikonal-trace"), std::string::npos) << how.err;
    const nlohmann::json none = report({"--model", "second-order", "--tolerance", "1e-12"}, &how);
    EXPECT_NE(how.err.find("; eikonal-trace render follows the rays truly"), std::string::npos) << how.err;
    EXPECT_EQ(none["warnings"].size(), 1U) << none["warnings"];
    write_text("hot.toml",
               "[camera]\nresolution = [64, 48]\nposition = [0, 1.5, 0]\nhorizontal_fov = 0.5\n"
               "look_at = [0, 1.5, -1]\n[[medium]]\ntype = \"surface\"\ndropoff = 1\n");
    const Ended surface = run({"map", "--scene", "hot.toml", "-o", "h.exr", "--tolerance", "1e-12"});
    EXPECT_EQ(surface.status, 0) << surface.err;
    EXPECT_NE(surface.err.find("no medium of this scene takes a model"), std::string::npos) << surface.err;
    EXPECT_EQ(surface.err.find(" is used"), std::string::npos) << surface.err;
}

TEST_F(ModelTest, ExplainTellsAndWritesNothing) {
    plate("in.png");
    const Words before = names();
    const Ended ended = run({"warp", "in.png", "-o", "out.png", "--scene", "air.toml", "--explain"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    for (const char* line : {"picture: 64 x 48", "frames 1 to make", "medium.0: model first-order",
                             "px rms expected at 30 m", "error: 95 of 100 of 64", "time: about", "memory: about"})
        EXPECT_NE(ended.out.find(line), std::string::npos) << line << " in " << ended.out;
    EXPECT_EQ(names(), before);
    // the frame's own depth, and the error that its run states
    const Words varied{"map", "--scene", "air.toml", "-o", "d.exr", "--ground", "1.5,45%"};
    Words explain = varied, told = varied;
    explain.push_back("--explain");
    told.push_back("-v");
    const std::string expected = run(explain).out, stated = run(told).err;
    const auto figure = [](const std::string& text, const std::string& words) {
        const auto at = text.find(words);
        return at == std::string::npos ? "nothing"
                                       : text.substr(at + words.size(), text.find(" px", at) - at - words.size());
    };
    EXPECT_EQ(figure(expected, "of frame 1 are off by "), figure(stated, "sampled pixels are off by "));
    const Ended nothing = run({"map", "-o", "m.exr", "--scene", "air.toml", "--set", "medium.0.cn2=0", "--explain"});
    EXPECT_EQ(nothing.status, 0) << nothing.err;
    EXPECT_NE(nothing.out.find("medium.0: left out, its strength is zero"), std::string::npos) << nothing.out;
    refused(run({"map", "-o", "m.exr", "--scene", "none.toml", "--explain"}), 2, {"none.toml"});
}

TEST_F(ModelTest, RefusesImpossibleTolerances) {
    for (const char* wrong : {"0", "-1", "nan", "much"})
        refused(run({"map", "--scene", "air.toml", "-o", "m.exr", "--tolerance", wrong}), 2, {"--tolerance", wrong});
}

}  // namespace
}  // namespace program_test
