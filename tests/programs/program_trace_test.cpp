/// Black-box tests of `eikonal-trace`: exit statuses, one-line messages that name what is wrong, and what it writes.
/// Length: all commands of one program, which share scenes and files.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/programs/program_run.h"

namespace program_test {
namespace {

class Trace : public Program {
  protected:
    Ended trace(Words words) const {
        words.insert(words.begin(), EIKONAL_TRACE_PROGRAM);
        return tool(std::move(words));
    }
    Ended render(Words words) const {
        words.insert(words.begin(), "render");
        return trace(std::move(words));
    }
    /// Expects this status and one line that has all the fragments.
    void refuses(const Ended& ended, int status, std::initializer_list<std::string> fragments) const {
        EXPECT_EQ(ended.status, status) << ended.err;
        EXPECT_EQ(ended.lines().size(), 1u) << ended.err;
        EXPECT_TRUE(ended.err.starts_with("eikonal-trace: ")) << ended.err;
        for (const std::string& fragment : fragments)
            EXPECT_NE(ended.err.find(fragment), std::string::npos) << "no \"" << fragment << "\" in: " << ended.err;
        EXPECT_EQ(ended.out, "");
    }
    /// Writes a scene of a wall, and `more` in front of it.
    void wall(const std::string& more = "") const {
        write_text("scene.toml", "[camera]\nresolution = [32, 24]\n" + more +
                                     "\n[[object]]\nname = \"wall\"\nshape = \"quad\"\norigin = [0, 0, -20]\n"
                                     "normal = [0, 0, 1]\nsize = [50, 50]\n");
    }
};

const std::string kSurface = "[[medium]]\ntype = \"surface\"\norigin = [0, -1, 0]\nsurface_temperature = 330\n";
const std::string kBlob =
    "[[medium]]\ntype = \"blobs\"\nblob = [{center = [0, 0, -5], sigma = 0.5, temperature = 900}]\n";

TEST_F(Trace, RendersEveryChannel) {
    wall(kBlob);
    const Ended ended = render({"scene.toml", "-o", "a.exr", "--samples", "1", "--magnification"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(names(), (Words{"a.exr", "scene.toml"}));
    const Pixels picture = read("a.exr");
    for (const char* name : {"R", "G", "B", "A", "Z", "length", "u", "v", "id", "steps", "error", "magnification"})
        EXPECT_NE(std::find(picture.spec.channelnames.begin(), picture.spec.channelnames.end(), name),
                  picture.spec.channelnames.end())
            << name;
    for (const float value : picture.values) ASSERT_TRUE(std::isfinite(value));
    EXPECT_NE(ended.err.find("folded"), std::string::npos);
}

TEST_F(Trace, HelpAndVersion) {
    for (const Words& words : {Words{"--help"}, {"render", "--help"}, {"path", "--help"}, {"--version"}}) {
        const Ended ended = trace(words);
        EXPECT_EQ(ended.status, 0) << ended.err;
        EXPECT_EQ(ended.err, "");
        EXPECT_NE(ended.out.find("eikonal-trace"), std::string::npos);
    }
    refuses(trace({}), 2, {"subcommand"});
}

TEST_F(Trace, WrongWordsAreNamed) {
    wall(kSurface);
    refuses(render({"scene.toml", "-o", "a.exr", "--integrator", "adaptiv"}), 2,
            {"--integrator", "adaptiv", "first-order", "did you mean"});
    refuses(render({"scene.toml", "-o", "a.png"}), 2, {"a.png", ".exr"});
    refuses(render({"scene.toml"}), 2, {"--output"});
    refuses(render({"none.toml", "-o", "a.exr"}), 2, {"none.toml"});
    refuses(render({"scene.toml", "-o", "a.exr", "--samples", "0"}), 2, {"--samples"});
    refuses(render({"scene.toml", "-o", "a.exr", "--tolerance", "nan"}), 2, {"--tolerance"});
    refuses(render({"scene.toml", "-o", "a.exr", "--frames", "1-3"}), 2, {"a.exr", "####"});
    refuses(render({"scene.toml", "-o", "a.exr", "--straight", "--magnification"}), 2, {"--straight"});
    refuses(render({"scene.toml", "-o", "a.exr", "--magnification", "--integrator", "first-order"}), 2,
            {"--magnification", "first-order", "adaptive"});
    refuses(render({"scene.toml", "-o", "a.exr", "--set", "camera.resolutio=[2,2]"}), 2, {"resolutio"});
    EXPECT_EQ(names(), Words{"scene.toml"});
}

TEST_F(Trace, ScenesThatCannotBeRenderedSayWhy) {
    write_text("scene.toml", "[camera]\nresolution = [32, 24]\n");
    refuses(render({"scene.toml", "-o", "a.exr"}), 2, {"scene.toml", "[[object]]"});
    const auto object = [&](const std::string& text) { write_text("scene.toml", "[[object]]\n" + text); };
    object("shape = \"mesh\"\nfile = \"none.obj\"\n");
    refuses(render({"scene.toml", "-o", "a.exr"}), 2, {"scene.toml:3: object.0.file: ", "none.obj"});
    refuses(render({"scene.toml", "-o", "a.exr", "--set", "object.0.file=other.obj"}), 2,
            {"eikonal-trace: --set object.0.file=other.obj: object.0.file: ", "other.obj"});
    refuses(render({"scene.toml", "-o", "a.exr", "--set", "object.0.shape=plane", "--set", "object.0.file=", "--set",
                    "object.0.texture=missing.png"}),
            2, {"eikonal-trace: --set object.0.texture=missing.png: object.0.texture: "});
    object("shape = \"mesh\"\nfile = \"bad.obj\"\n");
    for (const char* text :
         {"", "rubbish\n", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"}) {
        write_text("bad.obj", text);
        refuses(render({"scene.toml", "-o", "a.exr"}), 2, {"scene.toml:3: object.0.file: ", "bad.obj"});
    }
    write_text("bad.obj", "mtllib bad.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
    write_text("bad.mtl", "newmtl m\nmap_Kd gone.png\n");
    refuses(render({"scene.toml", "-o", "a.exr"}), 2, {"scene.toml:3: object.0.file: ", "gone.png"});
    object("texture = \"none.png\"\n");
    refuses(render({"scene.toml", "-o", "a.exr"}), 2, {"scene.toml:2: object.0.texture: ", "none.png"});
    write_text("bad.png", "no picture");
    object("texture = \"bad.png\"\n[background]\nimage = \"worse.png\"\n");
    refuses(render({"scene.toml", "-o", "a.exr"}), 2, {"scene.toml:2: object.0.texture: ", "bad.png"});
    refuses(render({"scene.toml", "-o", "a.exr", "--set", "object.0.texture="}), 2,
            {"scene.toml:4: background.image: ", "worse.png"});
    for (const char* integrator : {"layers", "mirror"}) {
        wall(kBlob);
        refuses(render({"scene.toml", "-o", "a.exr", "--integrator", integrator}), 2, {"surface"});
    }
    EXPECT_FALSE(fs::exists(path("a.exr")));
}

TEST_F(Trace, DegenerateTrianglesAreLeftOut) {
    write_text("mesh.obj", "v -9 -9 -5\nv 9 -9 -5\nv 0 9 -5\nv 0 0 -5\nf 1 2 3\nf 1 1 2\nf 4 4 4\n");
    write_text("scene.toml", "[camera]\nresolution = [32, 24]\n[[object]]\nshape = \"mesh\"\nfile = \"mesh.obj\"\n");
    EXPECT_EQ(render({"scene.toml", "-o", "a.exr", "--samples", "1"}).status, 0);
    const Pixels picture = read("a.exr");
    EXPECT_NEAR(picture.at(16, 12, picture.channel("Z")), 5, 1e-5);
}

TEST_F(Trace, ACameraWithinASphereIsPointedOut) {
    write_text("scene.toml",
               "[camera]\nresolution = [32, 24]\n[[object]]\nname = \"dome\"\nshape = \"sphere\"\nradius = 30\n");
    const Ended ended = render({"scene.toml", "-o", "a.exr", "--samples", "1"});
    EXPECT_EQ(ended.status, 0);
    EXPECT_NE(ended.err.find("warning: the camera is inside object.0 \"dome\""), std::string::npos) << ended.err;
}

TEST_F(Trace, ACameraBelowAHeatedSurfaceIsRefused) {
    wall("position = [0, -3, 0]\n" + kSurface);
    refuses(render({"scene.toml", "-o", "a.exr"}), 2, {"eikonal-trace: scene.toml:6: medium.0.origin", "2 m below"});
    // The camera may be there if rays are straight, or if the surface is not heated.
    EXPECT_EQ(render({"scene.toml", "-o", "a.exr", "--straight", "--samples", "1"}).status, 0);
    EXPECT_EQ(
        render({"scene.toml", "-o", "b.exr", "--samples", "1", "--set", "medium.0.surface_temperature=293.15"}).status,
        0);
}

// Some errors show only when a scene is used. Both programs report them with their place, like errors of the reader.
TEST_F(Trace, BothProgramsNameThePlaceOfWhatIsWrong) {
    const auto both = [&](const std::string& more, const Words& settings, const std::string& place,
                          const std::string& what) {
        wall(more);
        Words words{"scene.toml", "-o", "a.exr"};
        for (const std::string& setting : settings) words.insert(words.end(), {"--set", setting});
        refuses(render(words), 2, {"eikonal-trace: " + place + ": " + what});
        words.insert(words.begin(), "--scene");
        words.insert(words.begin(), "map");
        refused(run(words), 2, {"eikonal: " + place + ": " + what});
    };
    const std::string many =
        "[[medium]]\ntype = \"blobs\"\nsource = [{rate = 1, lifetime = 5},\n{rate = 1e6, lifetime = 100}]\n";
    both(many, {}, "scene.toml:6", "medium.0.source.1.rate = ");
    both(many, {"medium.0.source.1.rate=2e6"}, "--set medium.0.source.1.rate=2e6", "medium.0.source.1.rate = ");
    // For keys that are left out, the place is that of the table.
    both("[[medium]]\ntype = \"surface\"\n", {"camera.position=[0,-2,0]"}, "scene.toml:3", "medium.0.origin: ");
    both(kSurface, {"camera.position=[0,-2,0]"}, "scene.toml:5", "medium.0.origin: ");
    both(kSurface, {"medium.0.origin=[0,7,0]"}, "--set medium.0.origin=[0,7,0]", "medium.0.origin: ");
}

TEST_F(Trace, RaysThatGetNowhereAreToldAndCostLittle) {
    wall("[[medium]]\ntype = \"profile\"\nprofile = \"rod\"\ng = 1e6\n");
    const Words large{"--set", "camera.resolution=[1920,1080]"};
    Words words{"scene.toml", "-o", "a.exr", "--explain"};
    words.insert(words.end(), large.begin(), large.end());
    const auto start = std::chrono::steady_clock::now();
    const Ended explained = render(words);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    EXPECT_EQ(explained.status, 0) << explained.err;
    EXPECT_LT(took.count(), 60);  // hours, if nothing stopped it
    EXPECT_NE(explained.out.find("tried have a way to go that takes more than"), std::string::npos) << explained.out;
    // An unknown displacement is not reported as zero.
    EXPECT_NE(explained.out.find("displacement: unknown, none of the "), std::string::npos) << explained.out;
    EXPECT_EQ(explained.out.find("0 px"), std::string::npos) << explained.out;
    EXPECT_EQ(names(), Words{"scene.toml"});
    const Ended rendered = render({"scene.toml", "-o", "a.exr", "--samples", "1", "--set", "camera.resolution=[4,3]"});
    EXPECT_EQ(rendered.status, 0) << rendered.err;
    EXPECT_NE(rendered.err.find("rays tried are on a way that may use up their 100000 steps"), std::string::npos)
        << rendered.err;
    EXPECT_NE(rendered.err.find(" of 12 pixels hold rays that the step budget ended"), std::string::npos)
        << rendered.err;
    // Air of absurd strength. Rays that are trapped in it are ended long before their budget.
    wall(
        "[[medium]]\ntype = \"turbulence\"\nform = \"lattice\"\nlattice = [32, 32, 32, 4]\n"
        "period = [1, 1, 1, 1]\nouter_scale = 0.5\ncn2 = 1e12\n");
    const Ended absurd = render({"scene.toml", "-o", "c.exr", "--samples", "4", "--set", "camera.resolution=[8,6]"});
    EXPECT_NE(absurd.err.find("of 64 rays tried go round"), std::string::npos) << absurd.err;
    EXPECT_NE(absurd.err.find("of 48 pixels hold rays that go round"), std::string::npos) << absurd.err;
    const Pixels lost = read("c.exr");
    double steps = 0;
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 8; ++x) steps += lost.at(x, y, lost.channel("steps")) / 48.0;
    EXPECT_LT(steps, 100000 / 4);
    // Usual air is rendered without any message.
    wall(kSurface);
    const Ended usual = render({"scene.toml", "-o", "b.exr", "--samples", "1"});
    EXPECT_EQ(usual.err.find("warning"), std::string::npos) << usual.err;
}

TEST_F(Trace, RaysThatHaveAWayToGoAreNotWarnedOf) {
    const std::string fine =
        "[[medium]]\ntype = \"turbulence\"\nform = \"lattice\"\nlattice = [32, 32, 32, 4]\n"
        "period = [0.2, 0.2, 0.2, 1]\nouter_scale = 0.1\ncn2 = 1e-13\n";
    wall(fine);
    const Words few{"--samples", "1", "--set", "camera.resolution=[8,6]", "--overwrite"};
    const auto with = [&](Words words) {
        words.insert(words.end(), few.begin(), few.end());
        return render(words);
    };
    const Ended ended = with({"scene.toml", "-o", "a.exr"});
    EXPECT_EQ(ended.err.find("warning"), std::string::npos) << ended.err;
    const Pixels picture = read("a.exr");
    EXPECT_GT(picture.at(4, 3, picture.channel("steps")), 2000) << "too short a way for this test";
    // If the rays cannot end within the budget, it is named before and after the run.
    const Ended cut = with({"scene.toml", "-o", "a.exr", "--step-budget", "2100"});
    EXPECT_NE(cut.err.find("warning: 64 of 64 rays tried are on a way that may use up their 2100 steps"),
              std::string::npos)
        << cut.err;
    EXPECT_NE(cut.err.find("48 of 48 pixels hold rays that the step budget ended (id -3"), std::string::npos)
        << cut.err;
}

TEST_F(Trace, ACameraWithinAClosedMeshIsPointedOut) {
    write_text("box.obj",
               "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
               "f 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    write_text("scene.toml",
               "[camera]\nresolution = [8, 6]\nposition = [0, 0, 0]\n[[object]]\nshape = \"mesh\"\n"
               "name = \"box\"\nfile = \"box.obj\"\n");
    const auto said = [&](const std::string& position) {
        const Ended ended = render({"scene.toml", "-o", "a.exr", "--overwrite", "--samples", "1", "--set", position});
        EXPECT_EQ(ended.status, 0) << ended.err;
        return ended.err.find("warning: the camera is inside object.0 \"box\"") != std::string::npos;
    };
    EXPECT_TRUE(said("camera.position=[0, 0, 0]"));
    EXPECT_TRUE(said("camera.position=[0.9, -0.3, 0.5]"));
    EXPECT_FALSE(said("camera.position=[0, 0, 3]"));
    // A closed box whose faces have corners of their own.
    std::string corners;
    const int box[6][4] = {{1, 2, 3, 4}, {5, 6, 7, 8}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 4, 8, 7}, {4, 1, 5, 8}};
    for (const auto& face : box) {
        for (const int k : face)
            corners += std::string("v ") + (k % 4 < 2 ? "-" : "") + "1 " + ((k - 1) % 4 < 2 ? "-1 " : "1 ") +
                       (k < 5 ? "-1\n" : "1\n");
        corners += "f -4 -3 -2 -1\n";
    }
    write_text("box.obj", corners);
    EXPECT_TRUE(said("camera.position=[0.9, -0.3, 0.5]"));
    // The same with a separate sheet beside the box.
    write_text("box.obj", corners + "v -9 -9 -9\nv 9 -9 -9\nv 9 9 -9\nf -3 -2 -1\n");
    EXPECT_TRUE(said("camera.position=[0.9, -0.3, 0.5]"));
    EXPECT_FALSE(said("camera.position=[0, 0, -8.9999]"));
    // A face is missing, so the box is not closed, although most rays out of it cross a face.
    write_text("box.obj",
               "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
               "f 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 4 1 5 8\n");
    for (const char* place : {"[0, 0, 0]", "[-0.9, 0, 0]", "[-0.99, 0.99, 0.99]", "[0.9, 0, 0]"})
        EXPECT_FALSE(said(std::string("camera.position=") + place)) << place;
    // The same, two-sided.
    write_text("box.obj", bytes("box.obj") + "f 4 3 2 1\nf 8 7 6 5\nf 5 6 2 1\nf 7 8 4 3\nf 8 5 1 4\n");
    EXPECT_FALSE(said("camera.position=[-0.9, 0, 0]"));
}

TEST_F(Trace, RaysWithoutIndexAreReportedAndBlack) {
    wall("[[medium]]\ntype = \"profile\"\nprofile = \"linear\"\nn0 = 1\nslope = -0.5\ncenter = [0, -2, 0]\n");
    const Ended ended = render({"scene.toml", "-o", "a.exr", "--samples", "1"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_NE(ended.err.find("n <= 0"), std::string::npos) << ended.err;
    for (const float value : read("a.exr").values) ASSERT_FALSE(std::isnan(value));
    wall("[[medium]]\ntype = \"profile\"\nprofile = \"fish-eye\"\n");
    const Ended few = render({"scene.toml", "-o", "b.exr", "--samples", "1", "--step-budget", "10"});
    EXPECT_EQ(few.status, 0) << few.err;
    EXPECT_NE(few.err.find("--step-budget"), std::string::npos) << few.err;
}

TEST_F(Trace, FinishedFramesAreKeptAndSequencesWritten) {
    wall(kBlob);
    const Words sequence{"scene.toml", "-o", "f.####.exr", "--frames", "1-3,7", "--samples", "1"};
    EXPECT_EQ(render(sequence).status, 0);
    EXPECT_EQ(names(), (Words{"f.0001.exr", "f.0002.exr", "f.0003.exr", "f.0007.exr", "scene.toml"}));
    write_text("f.0002.exr", "kept");
    const Ended again = render(sequence);
    EXPECT_EQ(again.status, 0);
    EXPECT_NE(again.err.find("--overwrite"), std::string::npos);
    EXPECT_EQ(bytes("f.0002.exr"), "kept");
    Words anew = sequence;
    anew.push_back("--overwrite");
    EXPECT_EQ(render(anew).status, 0);
    EXPECT_NE(bytes("f.0002.exr"), "kept");
}

TEST_F(Trace, SameBytesForAnyNumberOfThreads) {
    wall(kBlob);
    for (const char* n : {"1", "2", "5"})
        EXPECT_EQ(render({"scene.toml", "-o", std::string(n) + ".exr", "--threads", n, "--samples", "4"}).status, 0);
    EXPECT_EQ(bytes("1.exr"), bytes("2.exr"));
    EXPECT_EQ(bytes("1.exr"), bytes("5.exr"));
}

// At a key of the path, the frame is that of a still camera at that key.
TEST_F(Trace, AMovingCameraIsAStillOneInEachFrame) {
    const auto scene = [&](const std::string& name, const std::string& camera) {
        write_text(name, "[camera]\nresolution = [32, 24]\n" + camera + "\n" + kBlob +
                             "[[object]]\nshape = \"plane\"\norigin = [0, 0, -20]\nnormal = [0.2, 0, 1]\n");
    };
    const std::string last = "49 1 0.5 0.25 10 20 30\n";
    write_text("moves.chan", "1 0 1 2 0 0 0\n25 0.5 0 -1 0 0 0\n" + last);
    write_text("last.chan", last);
    scene("moves.toml", "path = \"moves.chan\"");
    EXPECT_EQ(render({"moves.toml", "-o", "m.####.exr", "--frames", "1-49x24", "--samples", "4"}).status, 0);
    const std::pair<std::string, std::string> still[] = {{"0001", "position = [0, 1, 2]\nlook_at = [0, 1, 1]"},
                                                         {"0025", "position = [0.5, 0, -1]\nlook_at = [0.5, 0, -3]"},
                                                         {"0049", "path = \"last.chan\""}};
    for (const auto& [frame, camera] : still) {
        scene("still.toml", camera);
        EXPECT_EQ(render({"still.toml", "-o", frame + ".exr", "--frames", frame, "--samples", "4"}).status, 0);
        EXPECT_EQ(bytes("m." + frame + ".exr"), bytes(frame + ".exr")) << frame;
    }
    EXPECT_NE(bytes("0001.exr"), bytes("0025.exr"));
}

TEST_F(Trace, OutputThatCannotBeWrittenFailsTheFrame) {
    wall(kBlob);
    refuses(render({"scene.toml", "-o", "none/a.exr"}), 1, {"none", "frame 1"});
    refuses(trace({"path", "scene.toml", "--origin", "0,0,0", "--direction", "0,0,-1", "--length", "5", "-o",
                   "none/a.csv"}),
            1, {"none"});
}

/// Whether a process handles SIGINT itself.
bool catches_interrupts(pid_t process) {
    std::ifstream status("/proc/" + std::to_string(process) + "/status");
    const std::string key = "SigCgt:";
    for (std::string line; std::getline(status, line);)
        if (line.starts_with(key)) return (std::stoull(line.substr(key.size()), nullptr, 16) >> (SIGINT - 1)) & 1;
    return false;
}

TEST_F(Trace, AnInterruptLeavesNothingUnfinished) {
    wall(kBlob);
    const auto interrupt = [&](Words words) {
        words.insert(words.begin(), {EIKONAL_TRACE_PROGRAM, "render", "scene.toml", "-o", "a.exr"});
        const pid_t process = start_tool(words);
        for (int i = 0; i < 2000 && !catches_interrupts(process); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        std::this_thread::sleep_for(std::chrono::milliseconds(700));  // until rays are under way
        ::kill(process, SIGINT);
        const auto signalled = std::chrono::steady_clock::now();
        const Ended ended = finish(process);
        const std::chrono::duration<double> went_on = std::chrono::steady_clock::now() - signalled;
        EXPECT_EQ(ended.status, 1) << "not killed by the signal itself";
        EXPECT_EQ(ended.lines().back(), "eikonal-trace: frame 1: interrupted; the same command goes on");
        EXPECT_LT(went_on.count(), 3);
        EXPECT_EQ(names(), Words{"scene.toml"});
    };
    interrupt({"--samples", "256", "--set", "camera.resolution=[640,480]"});
    // The rays take hours. The stop comes within the first one.
    wall("[[medium]]\ntype = \"profile\"\nprofile = \"rod\"\ng = 1e6\n");
    interrupt({"--samples", "1", "--step-budget", "1000000000", "--tolerance", "1e-6"});
    // The same for the rays of the sun, before the first tile.
    wall(kBlob + "[light]\n");
    interrupt({"--samples", "1", "--light-rays", "2048", "--tolerance", "1e-9"});
}

// n² = 1 + z (PHYSICS.md#closed-forms). A ray that starts along x at z = 0 has x = u and z = u²/4.
TEST_F(Trace, PathIsTheParabola) {
    write_text("scene.toml",
               "[[medium]]\ntype = \"profile\"\nprofile = \"linear-squared\"\nslope = 1\naxis = [0, 0, 1]\n");
    const Words words{"path", "scene.toml", "--origin", "0,0,0", "--direction", "3,0,0", "--length", "4"};
    const Ended printed = trace(words);
    EXPECT_EQ(printed.status, 0) << printed.err;
    std::istringstream lines(printed.out);
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "u,x,y,z,px,py,pz");
    int rows = 0;
    double u = 0;
    while (std::getline(lines, line)) {
        ++rows;
        double v[7];
        ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf", v, v + 1, v + 2, v + 3, v + 4, v + 5, v + 6),
                  7);
        u = v[0];
        EXPECT_NEAR(v[1], u, 1e-9);
        EXPECT_NEAR(v[2], 0, 1e-9);
        EXPECT_NEAR(v[3], v[1] * v[1] / 4, 1e-9);
        EXPECT_NEAR(v[4], 1, 1e-9);
        EXPECT_NEAR(v[6], u / 2, 1e-9);
    }
    EXPECT_GT(rows, 10);
    EXPECT_NEAR(u, 4, 1e-12);
    Words file = words;
    file.insert(file.end(), {"-o", "ray.csv"});
    const Ended written = trace(file);
    EXPECT_EQ(written.status, 0);
    EXPECT_EQ(written.out, "");
    EXPECT_EQ(bytes("ray.csv"), printed.out);
    // The length of the last row is the one asked for, wherever the medium ends.
    write_text("lens.toml", "[[medium]]\ntype = \"profile\"\nprofile = \"luneburg\"\n");
    for (const std::string length : {"7", "1.1339745962155614", "1.1339745962156", "1.13397459622", "1.2"}) {
        const Ended ended =
            trace({"path", "lens.toml", "--origin=-2,0.5,0", "--direction", "1,0,0", "--length", length});
        EXPECT_EQ(ended.out.substr(ended.out.rfind('\n', ended.out.size() - 2) + 1).rfind(length + ",", 0), 0u)
            << ended.out;
    }
    Words wrong = words;
    wrong[5] = "0,0,0";
    refuses(trace(wrong), 2, {"--direction", "zero"});
    wrong[5] = "1,2";
    refuses(trace(wrong), 2, {"--direction", "X,Y,Z"});
}

}  // namespace
}  // namespace program_test
