/// Black-box tests of `eikonal-trace compare`: exit statuses, the files in its folder, and refusals that name what is
/// wrong.
#include <gtest/gtest.h>

#include "tests/programs/program_run.h"

namespace program_test {
namespace {

class Compare : public Program {
  protected:
    Ended compare(Words words) const {
        words.insert(words.begin(), {EIKONAL_TRACE_PROGRAM, "compare"});
        return tool(std::move(words));
    }
    void refuses(const Ended& ended, int status, std::initializer_list<std::string> fragments) const {
        EXPECT_EQ(ended.status, status) << ended.err;
        EXPECT_EQ(ended.lines().size(), 1u) << ended.err;
        EXPECT_TRUE(ended.err.starts_with("eikonal-trace: ")) << ended.err;
        for (const std::string& fragment : fragments)
            EXPECT_NE(ended.err.find(fragment), std::string::npos) << "no \"" << fragment << "\" in: " << ended.err;
    }
    void scene() const {
        write_text("scene.toml",
                   "[camera]\nresolution = [32, 24]\n[plate]\nfar = 20\n"
                   "[[medium]]\ntype = \"blobs\"\nblob = [{center = [0, 1.5, -5], sigma = 0.5, temperature = 900}]\n"
                   "[[object]]\nname = \"wall\"\nshape = \"quad\"\norigin = [0, 0, -20]\nnormal = [0, 0, 1]\n"
                   "size = [50, 50]\n");
    }
    Words files(const std::string& folder) const {
        Words list;
        for (const auto& entry : fs::directory_iterator(path(folder))) list.push_back(entry.path().filename().string());
        std::sort(list.begin(), list.end());
        return list;
    }
};

TEST_F(Compare, LeavesTablesPicturesPlotAndPage) {
    scene();
    const Words words{"scene.toml", "-o", "deep/out", "--samples", "1", "--models", "first-order", "--frames", "1-2"};
    const Ended ended = compare(words);
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(ended.err, "");
    EXPECT_NE(ended.out.find("first-order (default)"), std::string::npos) << ended.out;
    EXPECT_NE(ended.out.find("from frame to frame"), std::string::npos) << ended.out;
    EXPECT_EQ(files("deep/out"),
              (Words{"change-first-order.0002.png", "change-none.0002.png", "error-first-order.0001.png",
                     "error-first-order.0002.png", "error-none.0001.png", "error-none.0002.png", "errors.csv",
                     "errors.txt", "frontier.svg", "index.html", "plate.0001.png", "plate.0002.png", "truth.0001.png",
                     "truth.0002.png", "warp-first-order.0001.png", "warp-first-order.0002.png"}));
    EXPECT_EQ(ended.out.find(bytes("deep/out/errors.txt")), 0u);
    EXPECT_NE(bytes("deep/out/index.html").find("data:image/png;base64,"), std::string::npos);
    const Pixels heat = read("deep/out/error-first-order.0001.png");
    EXPECT_EQ(heat.spec.width, 32);
    EXPECT_GT(heat.spec.height, 24);

    write_text("deep/out/index.html", "kept");
    const Ended again = compare(words);
    EXPECT_EQ(again.status, 0);
    EXPECT_NE(again.err.find("--overwrite"), std::string::npos);
    EXPECT_EQ(bytes("deep/out/index.html"), "kept");
    Words anew = words;
    anew.push_back("--overwrite");
    EXPECT_EQ(compare(anew).status, 0);
    EXPECT_NE(bytes("deep/out/index.html"), "kept");
}

TEST_F(Compare, WrongWordsAreNamed) {
    scene();
    EXPECT_EQ(compare({"--help"}).status, 0);
    refuses(compare({"scene.toml"}), 2, {"--output"});
    refuses(compare({"none.toml", "-o", "out"}), 2, {"none.toml"});
    refuses(compare({"scene.toml", "-o", "out", "--models", "first-ordr"}), 2,
            {"--models", "first-ordr", "first-order"});
    refuses(compare({"scene.toml", "-o", "out", "--models", "screens"}), 2, {"screens", "medium.0"});
    refuses(compare({"scene.toml", "-o", "out", "--integrator", "adaptiv"}), 2, {"--integrator", "adaptiv"});
    refuses(compare({"scene.toml", "-o", "out", "--samples", "0"}), 2, {"--samples"});
    refuses(compare({"scene.toml", "-o", "out", "--frames", "x"}), 2, {"x"});
    refuses(compare({"scene.toml", "-o", "out", "--set", "medium.0.typ=1"}), 2, {"typ"});
    refuses(compare({"scene.toml", "-o", "scene.toml/out"}), 2, {"--output", "scene.toml/out"});
    EXPECT_EQ(names(), Words{"scene.toml"}) << "no folder for what was refused";
    write_text("empty.toml", "");
    refuses(compare({"empty.toml", "-o", "out"}), 2, {"[[object]]"});
}

}  // namespace
}  // namespace program_test
