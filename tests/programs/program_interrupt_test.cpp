// Ctrl-C, SIGTERM and SIGKILL in the middle of a sequence. Finished frames are whole and are not made again.

#include <signal.h>

#include <chrono>
#include <map>
#include <thread>

#include "tests/programs/program_run.h"

namespace program_test {
namespace {

class InterruptTest : public Program {
  protected:
    InterruptTest() {
        air();
        paint("in.exr", OIIO::ImageSpec(160, 120, 3, OIIO::TypeDesc::HALF),
              [](int x, int y, int c) { return static_cast<float>((x * 7 + y * 3 + c) % 11) / 11; });
    }
    static Words command(const std::string& frames, const std::string& output = "o.####.exr") {
        return {"warp", "in.exr", "-o", output, "--scene", "air.toml", "--frames", frames};
    }
    Words finished() const {
        Words found;
        for (const std::string& name : names())
            if (name.starts_with("o.")) found.push_back(name);
        return found;
    }
    int hidden() const {
        int count = 0;
        for (const std::string& name : names()) count += name.starts_with(".");
        return count;
    }
    /// Starts a long run, lets it make some frames and sends the signals.
    Ended interrupt(std::initializer_list<int> signals, const std::string& output = "o.####.exr",
                    bool wait_for_frames = true) const {
        const pid_t process = start(command("1-3000", output));
        for (int i = 0; i < 1000 && (wait_for_frames ? finished().size() < 4 : hidden() == 0); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        for (const int signal : signals) {
            kill(process, signal);
            std::this_thread::sleep_for(std::chrono::milliseconds(3));
        }
        return finish(process);
    }
    /// Every file that exists is readable, and the next run does not change it.
    void check_resumes() const {
        const Words before = finished();
        ASSERT_GE(before.size(), 4u);
        ASSERT_LT(before.size(), 3000u);
        std::map<std::string, fs::file_time_type> times;
        for (const std::string& name : before) {
            EXPECT_EQ(read(name).spec.width, 160);
            times[name] = fs::last_write_time(path(name));
        }
        const std::string last = std::to_string(before.size() + 3);
        const Ended ended = run(command("1-" + last));
        EXPECT_EQ(ended.status, 0) << ended.err;
        EXPECT_EQ(ended.lines().size(), 1u) << ended.err;
        EXPECT_NE(ended.err.find(std::to_string(before.size()) + " frames are already there"), std::string::npos)
            << ended.err;
        for (const auto& [name, time] : times) EXPECT_EQ(fs::last_write_time(path(name)), time) << name;
        EXPECT_EQ(finished().size(), before.size() + 3);
        EXPECT_EQ(hidden(), 0) << "what the killed run began is cleared";
    }
};

TEST_F(InterruptTest, CtrlCEndsAfterTheFramesUnderWay) {
    refused(interrupt({SIGINT}), 1, {"interrupted after", "of 3000 frames", "the same command makes the rest"});
    EXPECT_EQ(hidden(), 0);
    check_resumes();
}

TEST_F(InterruptTest, Terminated) {
    refused(interrupt({SIGTERM}), 1, {"interrupted after", "of 3000 frames"});
    EXPECT_EQ(hidden(), 0);
    check_resumes();
}

TEST_F(InterruptTest, CtrlCAgainAndAgainIsStillAnExitStatus) {
    EXPECT_EQ(interrupt({SIGINT, SIGINT, SIGINT}).status, 1);
    check_resumes();
}

TEST_F(InterruptTest, Killed) {
    EXPECT_EQ(interrupt({SIGKILL}).status, -SIGKILL);
    check_resumes();
}

// A frame in progress may need minutes more, and is given up. The frames before are whole and kept.
TEST_F(InterruptTest, StopsWithinAFrame) {
    const Words slow{"warp",       "in.exr",
                     "-o",         "o.####.exr",
                     "--scene",    "air.toml",
                     "--frames",   "1-2",
                     "--shutter",  "0.5",
                     "--samples",  "1024",
                     "--set",      "medium.0.form=gradient-noise",
                     "--set",      "medium.0.lattice=",
                     "--set",      "medium.0.period=",
                     "--distance", "290",
                     "--far",      "290",
                     "--threads",  "1"};
    for (const int signal : {SIGINT, SIGTERM}) {
        const pid_t process = start(slow);
        std::this_thread::sleep_for(std::chrono::milliseconds(1500));
        kill(process, signal);
        const Ended ended = finish(process);
        EXPECT_LT(ended.seconds, 5);
        refused(ended, 1, {"interrupted", "the same command makes the rest"});
        EXPECT_EQ(finished(), Words{});
        EXPECT_EQ(hidden(), 0);
    }
}

// The tracer stops within a frame, which may take it hours; the frames before are whole and kept.
TEST_F(InterruptTest, TracerStopsWithinAFrame) {
    write_text("scene.toml", "[camera]\nresolution = [1280, 720]\n[[object]]\nshape = \"sphere\"\nradius = 1\n");
    const auto trace = [](const std::string& frames, const std::string& samples) {
        return Words{EIKONAL_TRACE_PROGRAM, "render",   "scene.toml", "-o",        "o.####.exr",
                     "--straight",          "--frames", frames,       "--samples", samples};
    };
    ASSERT_EQ(tool(trace("1-2", "1")).status, 0);
    const std::string first = bytes("o.0001.exr");
    for (const int signal : {SIGINT, SIGTERM}) {
        const pid_t process = start_tool(trace("1-3", "512"));
        std::this_thread::sleep_for(std::chrono::milliseconds(1500));
        kill(process, signal);
        const Ended ended = finish(process);
        EXPECT_EQ(ended.status, 1);
        EXPECT_EQ(ended.lines().back(), "eikonal-trace: frame 3: interrupted; the same command goes on") << ended.err;
        EXPECT_EQ(finished(), (Words{"o.0001.exr", "o.0002.exr"}));
        EXPECT_EQ(hidden(), 0);
    }
    EXPECT_EQ(bytes("o.0001.exr"), first);
}

TEST_F(InterruptTest, MovieLeavesNothing) {
    refused(interrupt({SIGINT}, "o.mp4", false), 1, {"interrupted after", "the movie was not written"});
    EXPECT_EQ(finished(), Words{});
    EXPECT_EQ(hidden(), 0);
    EXPECT_EQ(interrupt({SIGKILL}, "o.mp4", false).status, -SIGKILL);
    EXPECT_EQ(finished(), Words{});
    silent(run(command("1-2", "o.mp4")));
    EXPECT_EQ(finished(), Words{"o.mp4"});
    EXPECT_EQ(hidden(), 0);
}

}  // namespace
}  // namespace program_test
