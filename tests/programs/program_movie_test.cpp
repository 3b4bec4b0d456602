// Movies in and out: frame count, rate, audio and bit depth; stills, sequences and movies into one another.

#include <nlohmann/json.hpp>

#include "tests/programs/program_run.h"

namespace program_test {
namespace {

class MovieTest : public Program {
  protected:
    MovieTest() { air(); }
    void make_clip(const std::string& name, Words codec) const {
        Words words{"ffmpeg",
                    "-v",
                    "error",
                    "-f",
                    "lavfi",
                    "-i",
                    "testsrc2=size=64x48:rate=30000/1001:duration=0.4",
                    "-f",
                    "lavfi",
                    "-i",
                    "sine=duration=0.4"};
        words.insert(words.end(), codec.begin(), codec.end());
        words.push_back(name);
        silent(tool(words));
    }
    /// Frames, rate and pixel format of the video, and codecs of all streams.
    struct Facts {
        std::string frames, rate, pixels;
        Words codecs;
    };
    Facts facts(const std::string& name) const {
        const Ended probe = tool({"ffprobe", "-v", "error", "-count_frames", "-of", "json", "-show_streams", name});
        Facts facts;
        const auto probed = nlohmann::json::parse(probe.out, nullptr, false);
        if (!probed.contains("streams")) {
            ADD_FAILURE() << name << ": " << probe.err;
            return facts;
        }
        for (const auto& stream : probed["streams"]) {
            facts.codecs.push_back(stream["codec_name"]);
            if (stream["codec_type"] != "video") continue;
            facts.frames = stream["nb_read_frames"];
            facts.rate = stream["r_frame_rate"];
            facts.pixels = stream["pix_fmt"];
        }
        return facts;
    }
    std::string audio(const std::string& name) const {
        return tool({"ffmpeg", "-v", "error", "-i", name, "-map", "0:a", "-c", "copy", "-f", "md5", "-"}).out;
    }
    Ended warp(const std::string& in, const std::string& out, Words more = {}) const {
        more.insert(more.begin(), {"warp", in, "-o", out, "--scene", "air.toml"});
        return run(std::move(more));
    }
};

TEST_F(MovieTest, MovieToMovieKeepsItsFacts) {
    make_clip("a.mp4", {"-c:v", "libx264", "-pix_fmt", "yuv420p", "-c:a", "aac"});
    make_clip("b.mkv", {"-c:v", "ffv1", "-pix_fmt", "yuv422p10le", "-c:a", "flac"});
    make_clip("c.mov",
              {"-c:v", "libx265", "-x265-params", "log-level=none", "-pix_fmt", "yuv420p10le", "-c:a", "pcm_s16le"});
    for (const char* name : {"a.mp4", "b.mkv", "c.mov"}) {
        SCOPED_TRACE(name);
        const std::string out = std::string("out.") + name;
        silent(warp(name, out));
        const Facts before = facts(name), after = facts(out);
        EXPECT_EQ(before.frames, "12");
        EXPECT_EQ(after.frames, before.frames);
        EXPECT_EQ(after.rate, before.rate);
        EXPECT_EQ(after.pixels, before.pixels);
        EXPECT_EQ(after.codecs, before.codecs);
        EXPECT_EQ(audio(out), audio(name));
    }
    const Ended again = warp("a.mp4", "out.a.mp4");
    EXPECT_EQ(again.status, 0);
    EXPECT_NE(again.err.find("already there and kept"), std::string::npos);
}

// An existing movie is kept if it may be the one that is asked for.
TEST_F(MovieTest, MoviesThatAreThere) {
    make_clip("a.mp4", {"-c:v", "libx264", "-pix_fmt", "yuv420p", "-c:a", "aac"});
    for (const char* name : {"o.mp4", "o.mkv"}) {
        SCOPED_TRACE(name);
        const std::string out = name;
        silent(warp("a.mp4", out));
        const std::string whole = bytes(out);
        refused(warp("a.mp4", out, {"--frames", "3-6"}), 2, {"-o", out, "12 frames", "the 4 that", "--overwrite"});
        EXPECT_EQ(warp("a.mp4", out).lines(),
                  Words{"eikonal: '" + out + "' is already there and kept (12 frames); --overwrite makes it anew"});
        plate("in.png");
        paint("big.png", OIIO::ImageSpec(128, 48, 3, OIIO::TypeDesc::UINT8), [](int, int, int) { return 0.5f; });
        refused(warp("big.png", out, {"--frames", "1-12"}), 2, {"-o", out, "64 x 48", "128 x 48", "--overwrite"});
        EXPECT_EQ(bytes(out), whole);
        for (const std::string& damage : {whole.substr(0, whole.size() * 6 / 10), std::string("this is a letter")}) {
            write_text(out, damage);
            EXPECT_EQ(warp("a.mp4", out).lines(), Words{"eikonal: '" + out + "' is damaged and made anew"});
            EXPECT_EQ(bytes(out), whole);
        }
    }
}

TEST_F(MovieTest, OggTakesTheora) {
    make_clip("a.mp4", {"-c:v", "libx264", "-pix_fmt", "yuv420p", "-an"});
    silent(warp("a.mp4", "b.ogv"));
    EXPECT_EQ(facts("b.ogv").codecs, Words{"theora"});
    EXPECT_NE(warp("a.mp4", "b.ogv").err.find("already there and kept (about 12 frames);"), std::string::npos);
    const Ended fewer = warp("a.mp4", "b.ogv", {"--frames", "1-6"});
    EXPECT_EQ(fewer.status, 2);
    EXPECT_NE(fewer.err.find("already there with about 12 frames, not the 6"), std::string::npos) << fewer.err;
}

// A transport stream states no length. The number of frames is known at the end only.
TEST_F(MovieTest, TransportStreams) {
    make_clip("a.ts", {"-c:v", "mpeg2video", "-c:a", "mp2"});
    const Ended ended = warp("a.ts", "b.ts", {"--progress", "plain"});
    EXPECT_EQ(ended.status, 0);
    ASSERT_EQ(ended.lines().size(), 1u) << ended.err;
    EXPECT_TRUE(ended.err.starts_with("12 frames, ")) << ended.err;
    EXPECT_EQ(facts("b.ts").frames, "12");
    EXPECT_EQ(facts("b.ts").codecs, facts("a.ts").codecs);
    EXPECT_NE(warp("a.ts", "b.ts").err.find("kept (12 frames)"), std::string::npos);
    silent(warp("a.ts", "some.mkv", {"--frames", "1-6"}));
    EXPECT_EQ(warp("a.ts", "some.mkv").status, 2) << "it has 6 of 12 frames";
}

TEST_F(MovieTest, FieldOrderIsKept) {
    for (const auto& [name, codec] : {std::pair{"a.mp4", "libx264"}, {"b.mkv", "mpeg2video"}, {"c.mov", "prores_ks"}}) {
        SCOPED_TRACE(name);
        make_clip(name,
                  {"-vf", "interlace=scan=tff", "-c:v", codec, "-flags", "+ildct", "-x264-params", "tff=1", "-an"});
        const std::string out = std::string("o.") + name;
        const Ended ended = warp(name, out);
        EXPECT_EQ(ended.status, 0);
        EXPECT_NE(ended.err.find("is interlaced"), std::string::npos) << ended.err;
        const auto fields = [&](const std::string& file) {
            return tool({"ffprobe", "-v", "error", "-show_entries",
                         "stream=codec_name,field_order:frame=interlaced_frame,top_field_first", "-of", "csv", file})
                .out;
        };
        EXPECT_EQ(fields(out), fields(name));
        EXPECT_NE(fields(out).find("frame,1,1"), std::string::npos) << fields(out);
    }
}

// In such a file ffmpeg begins the video when the padding of the sound is over, and states the time when it ends.
TEST_F(MovieTest, MatroskaWhoseVideoBeginsLater) {
    silent(tool({"ffmpeg", "-v", "error", "-f", "lavfi", "-i", "testsrc2=size=64x48:rate=24:duration=2", "-f", "lavfi",
                 "-i", "sine=duration=2", "-c:v", "libx264", "-c:a", "aac", "late.mkv"}));
    silent(warp("late.mkv", "out.mkv"));
    EXPECT_EQ(facts("out.mkv").frames, "48");
}

TEST_F(MovieTest, PartsOfAMovie) {
    make_clip("a.mp4", {"-c:v", "libx264", "-pix_fmt", "yuv420p", "-c:a", "aac"});
    silent(warp("a.mp4", "part.mp4", {"--frames", "3-6"}));
    EXPECT_EQ(facts("part.mp4").frames, "4");
    refused(warp("a.mp4", "p.mp4", {"--frames", "3-60"}), 2, {"--frames 3-60", "1 to 12"});
    refused(warp("a.mp4", "p.mp4", {"--frames", "0-2"}), 2, {"--frames 0-2", "1 to 12"});
    silent(warp("a.mp4", "s.####.png", {"--frames", "2,5"}));
    EXPECT_TRUE(fs::exists(path("s.0002.png")) && fs::exists(path("s.0005.png")) && !fs::exists(path("s.0003.png")));
    // the same frame whether or not others are made
    silent(warp("a.mp4", "t.####.png"));
    EXPECT_EQ(bytes("s.0005.png"), bytes("t.0005.png"));
}

TEST_F(MovieTest, StillsAndSequences) {
    plate("in.png");
    silent(warp("in.png", "still.mp4", {"--frames", "1-6"}));
    EXPECT_EQ(facts("still.mp4").frames, "6");
    EXPECT_EQ(facts("still.mp4").rate, "24/1");
    silent(warp("still.mp4", "s.####.png"));
    silent(warp("s.####.png", "back.mkv", {"--set", "time.fps=30"}));
    EXPECT_EQ(facts("back.mkv").frames, "6");
    EXPECT_EQ(facts("back.mkv").rate, "30/1");
    plate("in.exr");
    silent(warp("in.exr", "deep.mov", {"--frames", "1-2"}));
    EXPECT_EQ(facts("deep.mov").pixels, "yuv420p10le") << "float pictures are not cut to 8 bits";
}

// The first frame gives the size of a movie. Its damage counts no more than that of any other frame.
TEST_F(MovieTest, DamagedFirstFrame) {
    make_clip("a.mkv", {"-c:v", "ffv1", "-level", "3", "-slicecrc", "1", "-pix_fmt", "yuv420p", "-an"});
    std::string data = bytes("a.mkv");
    const std::size_t first = data.find("\x1f\x43\xb6\x75") + 200;  // within Matroska's first cluster
    for (std::size_t i = first; i < first + 40; ++i) data[i] = static_cast<char>(~data[i]);
    write_text("a.mkv", data);
    const Ended stopped = warp("a.mkv", "b.mkv");
    EXPECT_EQ(stopped.status, 1);
    EXPECT_NE(stopped.err.find("frame 1: "), std::string::npos) << stopped.err;
    EXPECT_NE(stopped.err.find("--skip-bad-frames"), std::string::npos) << stopped.err;
    EXPECT_FALSE(fs::exists(path("b.mkv")));
    for (const char* out : {"b.mkv", "s.####.png"}) {
        const Ended skipped = warp("a.mkv", out, {"--skip-bad-frames"});
        EXPECT_EQ(skipped.status, 1);
        EXPECT_NE(skipped.err.find("11 of 12 frames done"), std::string::npos) << skipped.err;
    }
    EXPECT_EQ(facts("b.mkv").frames, "11");
    EXPECT_TRUE(fs::exists(path("s.0002.png")) && fs::exists(path("s.0012.png")) && !fs::exists(path("s.0001.png")));
}

TEST_F(MovieTest, Refusals) {
    make_clip("a.mp4", {"-c:v", "libx264", "-pix_fmt", "yuv420p", "-c:a", "aac"});
    fs::create_symlink("a.mp4", path("link.mp4"));
    const std::string before = bytes("a.mp4");
    for (const char* out : {"a.mp4", "./a.mp4", "link.mp4"})
        refused(warp("a.mp4", out, {"--overwrite"}), 2, {"the input", "-o", "same file"});
    refused(warp("link.mp4", "a.mp4", {"--overwrite"}), 2, {"same file"});
    EXPECT_EQ(bytes("a.mp4"), before);
    refused(warp("a.mp4", "b.mp4", {"--depth", ":Z"}), 2, {"--depth :Z", "movie"});
    refused(warp("a.mp4", "b.mp4", {"--codec", "divx9"}), 2, {"--codec", "divx9", "h264"});
    refused(warp("a.mp4", "b.mp4", {"--codec", "prores"}), 2, {"--codec prores", ".mp4 holds h264", ".mov"});
    refused(warp("a.mp4", "b.mp4", {"--quality", "60"}), 2, {"--quality", "60", "h264", "0 (best) to 51"});
    refused(warp("a.mp4", "b.mkv", {"--quality", "3", "--codec", "ffv1"}), 2, {"--quality", "ffv1", "lossless"});
    write_text("cut.mp4", before.substr(0, before.size() / 2));
    EXPECT_EQ(warp("cut.mp4", "b.mp4").status, 1);
    make_clip("c.mkv", {"-c:v", "libx264", "-pix_fmt", "yuv420p", "-c:a", "aac"});
    const std::string whole = bytes("c.mkv");
    write_text("cut.mkv", whole.substr(0, whole.size() * 6 / 10));
    EXPECT_EQ(warp("cut.mkv", "b.mkv").status, 1);
    const Ended skipped = warp("cut.mkv", "s.####.png", {"--skip-bad-frames"});
    EXPECT_EQ(skipped.status, 1);
    EXPECT_EQ(skipped.lines().size(), 2u) << skipped.err;
    EXPECT_TRUE(skipped.err.starts_with("eikonal: frames ")) << "one line for all that is missing: " << skipped.err;
    EXPECT_NE(skipped.lines()[0].find("cut off"), std::string::npos) << skipped.err;
    EXPECT_FALSE(fs::exists(path("b.mp4")) || fs::exists(path("b.mkv")));
}

}  // namespace
}  // namespace program_test
