/// Movies in and out: codes and streams are kept, and errors name the movie.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include "noise/base/error.h"
#include "tests/warp/image/movie_fixture.h"
#include "warp/image/movie_frame.h"
#include "warp/image/movie_reader.h"
#include "warp/image/movie_writer.h"

namespace eikonal {
namespace {

TEST_F(Movie, LosslessFamiliesKeepEveryCode) {
    for (const std::string pixel_format :
         {"yuv420p", "yuv422p10le", "yuv444p12le", "yuv411p", "yuv410p", "yuv440p", "gray", "gray10le", "gbrp",
          "gbrp12le", "yuva420p", "gbrap", "bgr0", "rgb48le"}) {
        const fs::path source = test_picture("-c:v ffv1 -pix_fmt " + pixel_format, "in.mkv", 3);
        EXPECT_TRUE(pass_through(source, file("out.mkv")).empty()) << pixel_format;
        EXPECT_EQ(picture_md5(source).size(), 37U);
        const std::string as = " -pix_fmt " + std::string(pixel_format == "bgr0" ? "gbrp" : pixel_format) + " -f md5 -";
        const auto codes = [&](const fs::path& path) {
            return output_of("ffmpeg -nostdin -v error -i '" + path.string() + "' -map 0:v" + as);
        };
        EXPECT_EQ(codes(source), codes(file("out.mkv"))) << pixel_format;
    }
}

// Packed, semi-planar, palette and big-endian samples are read without loss. They are compared with ffmpeg's own
// planes.
TEST_F(Movie, PackedFormatsAreReadExactly) {
    struct Case {
        std::string packed, planar;
    };
    for (const Case& c : {Case{"uyvy422", "yuv422p"},
                          {"yuyv422", "yuv422p"},
                          {"nv12", "yuv420p"},
                          {"rgb24", "gbrp"},
                          {"bgra", "gbrap"},
                          {"pal8", "gbrap"},
                          {"rgb48be", "gbrp16le"},
                          {"ya8", "ya8"},
                          {"gray16be", "gray16le"}}) {
        const fs::path source = test_picture("-c:v rawvideo -pix_fmt " + c.packed, "in.nut", 1);
        const fs::path planes = make("-i '" + source.string() + "' -f rawvideo -pix_fmt " + c.planar, "planes.raw");
        MovieReader reader(source);
        MovieFrame frame;
        ASSERT_TRUE(reader.next(frame)) << c.packed;
        const std::string raw = bytes(planes);
        std::vector<int> order = frame.format.rgb ? std::vector<int>{1, 2, 0, 3} : std::vector<int>{0, 1, 2, 3};
        const std::size_t size = frame.format.depth > 8 ? 2 : 1;
        std::string ours;
        if (c.planar == "ya8") {
            for (std::size_t i = 0; i < frame.planes[0].size(); ++i) {
                ours += static_cast<char>(frame.planes[0][i]);
                ours += static_cast<char>(frame.planes[3][i]);
            }
        } else {
            for (const int plane : order)
                for (const std::uint16_t code : frame.planes[static_cast<std::size_t>(plane)]) {
                    ours += static_cast<char>(code & 255);
                    if (size == 2) ours += static_cast<char>(code >> 8);
                }
        }
        // swscale goes from palettes through Y'CbCr, we do not.
        if (c.packed == "pal8")
            EXPECT_EQ(ours.size(), raw.size());
        else
            EXPECT_TRUE(ours == raw) << c.packed;
    }
}

TEST_F(Movie, AudioIsCopiedAndTagsAreKept) {
    const fs::path source = make(
        "-f lavfi -i testsrc2=size=96x64:rate=30000/1001 -f lavfi -i sine=440 -f lavfi -i sine=880 -map 0 -map 1 -map "
        "2 -t 1 "
        "-c:v libx264 -pix_fmt yuv420p -colorspace bt709 -color_primaries bt709 -color_trc bt709 -color_range tv "
        "-chroma_sample_location left -vf setsar=4/3 -c:a aac -metadata title=Shimmer -metadata:s:a:0 language=fra",
        "in.mp4");
    EXPECT_TRUE(pass_through(source, file("out.mp4")).empty());
    for (const std::string map : {"0:a:0", "0:a:1"})
        EXPECT_EQ(stream_md5(source, map), stream_md5(file("out.mp4"), map));
    const std::string tags =
        "-select_streams v -show_entries "
        "stream=codec_name,pix_fmt,color_range,color_space,color_transfer,color_primaries,chroma_location,nb_frames,"
        "r_frame_rate,avg_frame_rate,sample_aspect_ratio,duration_ts,time_base";
    EXPECT_EQ(probe(source, tags), probe(file("out.mp4"), tags));
    EXPECT_NE(probe(source, tags).find("bt709"), std::string::npos);
    const std::string rest = "-show_entries format_tags=title:stream_tags=language";
    EXPECT_EQ(probe(source, rest), probe(file("out.mp4"), rest));
    const std::string audio = "-select_streams a -show_entries packet=pts_time,dts_time";
    EXPECT_EQ(probe(source, audio), probe(file("out.mp4"), audio));
    EXPECT_EQ(time_stamps(source), time_stamps(file("out.mp4")));

    pass_through(source, file("again.mp4"));
    EXPECT_TRUE(bytes(file("out.mp4")) == bytes(file("again.mp4")));
}

TEST_F(Movie, OtherContainers) {
    const fs::path source =
        make("-f lavfi -i testsrc2=size=96x64:rate=24 -f lavfi -i sine -t 0.5 -c:v libx264 -pix_fmt yuv420p -c:a aac",
             "in.mp4");
    const auto codec = [&](const fs::path& path) {
        return probe(path, "-select_streams v -show_entries stream=codec_name -of csv=p=0");
    };
    for (const std::string name : {"out.mkv", "out.mov", "out.avi", "out.ts"}) {
        EXPECT_TRUE(pass_through(source, file(name)).empty()) << name;
        EXPECT_EQ(codec(file(name)).substr(0, 4), "h264") << name;
        EXPECT_EQ(time_stamps(file(name)).size(), 12U) << name;
    }
    const auto warnings = pass_through(source, file("out.webm"));
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("audio stream 1 (aac) is coded again as opus"), std::string::npos) << warnings[0];
    EXPECT_EQ(codec(file("out.webm")).substr(0, 3), "vp9");
}

/// The audible part of a stream with a tone of 440 Hz between silences.
struct Heard {
    double length = 0;        ///< [s]
    double from = 0, to = 0;  ///< of the tone [s]
    double frequency = 0;     ///< [Hz]
    double rms = 0;           ///< of its middle
};

Heard listen(const std::string& samples, double rate) {
    std::vector<float> s(samples.size() / sizeof(float));
    std::memcpy(s.data(), samples.data(), s.size() * sizeof(float));
    Heard heard;
    heard.length = static_cast<double>(s.size()) / rate;
    const auto loud = [](float v) { return std::abs(v) > 0.2F; };
    const auto first = std::find_if(s.begin(), s.end(), loud);
    const auto last = std::find_if(s.rbegin(), s.rend(), loud).base();
    if (first >= last) return heard;
    heard.from = static_cast<double>(first - s.begin()) / rate;
    heard.to = static_cast<double>(last - s.begin()) / rate;
    const auto edge = (last - first) / 8;
    double crossings = 0, power = 0;
    for (auto i = first + edge; i < last - edge; ++i) {
        crossings += i[0] < 0 && i[1] >= 0;
        power += double{*i} * *i;
    }
    const auto count = static_cast<double>(last - first - 2 * edge);
    heard.frequency = crossings * rate / count;
    heard.rms = std::sqrt(power / count);
    return heard;
}

// A tone of known pitch, place and length, through every pair of container and codec that do not go together.
TEST_F(Movie, AudioThatTheContainerCannotHoldIsCodedAgain) {
    constexpr double kRate = 48000, kFrame = 0.032;  // the longest packet: 1024 samples of AAC at 32 kHz
    struct Case {
        std::string source, codec, target, becomes, layout;
        int channels, rate;
    };
    for (const Case& c : {Case{"a.mp4", "aac", "a.webm", "opus", "stereo", 2, 44100},
                          {"b.mkv", "flac", "b.webm", "opus", "5.1", 6, 48000},
                          {"c.mkv", "pcm_s24le", "c.mp4", "aac", "mono", 1, 32000},
                          {"e.mkv", "flac", "e.mov", "aac", "stereo", 2, 48000},
                          {"d.mkv", "pcm_s16le", "d.webm", "opus", "stereo", 2, 96000}}) {
        SCOPED_TRACE(c.target);
        std::string tone;
        for (int i = 0; i < c.channels; ++i) tone += std::string(i ? "|" : "") + "0.5*between(t,0.4,1.3)*sin(880*PI*t)";
        const fs::path source = make("-f lavfi -i testsrc2=size=96x64:rate=24 -f lavfi -i \"aevalsrc='" + tone +
                                         "':s=" + std::to_string(c.rate) + ":c=" + c.layout +
                                         "\" -t 1.7 -c:v libx264 -pix_fmt yuv420p -c:a " + c.codec,
                                     c.source);
        const auto warnings = pass_through(source, file(c.target));
        ASSERT_EQ(warnings.size(), 1U);
        EXPECT_NE(warnings[0].find("is coded again as " + c.becomes), std::string::npos) << warnings[0];
        EXPECT_EQ(probe(file(c.target), "-select_streams a -show_entries stream=codec_name,channels -of csv=p=0"),
                  c.becomes + ',' + std::to_string(c.channels) + '\n');
        const auto samples = [&](const fs::path& path) {
            return output_of("ffmpeg -nostdin -v error -i '" + path.string() +
                             "' -map 0:a -af pan=mono\\|c0=c0 -ar 48000 -f f32le -");
        };
        const Heard before = listen(samples(source), kRate), after = listen(samples(file(c.target)), kRate);
        EXPECT_NEAR(before.frequency, 440, 2);
        EXPECT_NEAR(after.length, before.length, kFrame);
        EXPECT_NEAR(after.from, before.from, 0.003);
        EXPECT_NEAR(after.to, before.to, 0.003);
        EXPECT_NEAR(after.frequency, before.frequency, 2);
        EXPECT_NEAR(after.rms / before.rms, 1, 0.1);
        EXPECT_EQ(time_stamps(file(c.target)).size(), time_stamps(source).size());
        // Picture and sound begin together. The encoder's delay moves neither.
        EXPECT_EQ(time_stamps(file(c.target)).front(), 0);

        pass_through(source, file("again" + c.target));
        EXPECT_TRUE(bytes(file(c.target)) == bytes(file("again" + c.target)));

        // Frames 13 to 36, from 0.5 to 1.5 s. The beginning of the tone is cut off.
        MovieSettings part;
        for (int i = 13; i <= 36; ++i) part.frames.push_back(i);
        pass_through(source, file("part" + c.target), part);
        const Heard piece = listen(samples(file("part" + c.target)), kRate);
        EXPECT_NEAR(piece.length, 1, 2 * kFrame);
        EXPECT_LT(piece.from, 0.003);
        EXPECT_NEAR(piece.to, before.to - 0.5, 0.003);
    }
}

// Two pieces of sound with a gap between them. The second keeps its time.
TEST_F(Movie, GapsOfAudioThatIsCodedAgainBecomeSilence) {
    const fs::path source = make(
        "-f lavfi -i testsrc2=size=96x64:rate=24 -f lavfi -i sine=440:sample_rate=44100 -t 3 -c:v libx264 -pix_fmt "
        "yuv420p -af \"aselect='not(between(t,0.5,2))',volume=6\" -c:a pcm_s16le",
        "in.mkv");
    pass_through(source, file("out.webm"));
    const std::string samples =
        output_of("ffmpeg -nostdin -v error -i '" + file("out.webm").string() + "' -map 0:a -ar 48000 -f f32le -");
    EXPECT_NEAR(listen(samples, 48000).length, 3, 0.032);
    const std::string second = samples.substr(48000 * sizeof(float));
    EXPECT_NEAR(listen(second, 48000).from, 1, 0.03);
}

TEST_F(Movie, AudioIsDroppedWhereThereCanBeNone) {
    const fs::path source =
        make("-f lavfi -i testsrc2=size=96x64:rate=24 -f lavfi -i sine -t 0.2 -c:v libvpx -c:a libopus", "in.webm");
    const auto warnings = pass_through(source, file("out.ivf"));
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("audio stream 1 (opus) is dropped, ivf files hold no audio"), std::string::npos)
        << warnings[0];
}

TEST_F(Movie, DeepSourcesStayDeep) {
    const fs::path h264 = test_picture(
        "-c:v libx264 -pix_fmt yuv420p10le -colorspace bt2020nc -color_primaries bt2020 -color_trc smpte2084 "
        "-color_range tv",
        "in.mp4");
    const fs::path prores = test_picture("-c:v prores_ks -profile:v 3 -pix_fmt yuv422p10le", "in.mov");
    std::vector<fs::path> sources{h264, prores};
#ifndef EIKONAL_SANITIZED  // libx265 itself leaks
    sources.push_back(test_picture("-c:v libx265 -x265-params log-level=none -pix_fmt yuv420p10le", "hevc.mp4"));
#endif
    const std::string what =
        "-select_streams v -show_entries stream=codec_name,profile,pix_fmt,color_space,color_transfer,color_primaries";
    for (const fs::path& source : sources) {
        const fs::path out = file("out" + source.extension().string());
        EXPECT_TRUE(pass_through(source, out).empty());
        EXPECT_EQ(probe(source, what), probe(out, what)) << source;
        EXPECT_EQ(time_stamps(source).size(), 10U);
    }
}

TEST_F(Movie, VariableRateAndRotation) {
    const fs::path plain = make(
        "-f lavfi -i testsrc2=size=96x64:rate=25 -frames:v 20 -vf \"select='not(mod(n,3))+eq(n,1)'\" -vsync vfr "
        "-c:v libx264 -pix_fmt yuv420p",
        "plain.mp4");
    const fs::path source = make("-i '" + plain.string() + "' -c copy -metadata:s:v rotate=90", "in.mp4");
    const auto stamps = time_stamps(source);
    ASSERT_GE(stamps.size(), 7U);
    EXPECT_NE(stamps[1] - stamps[0], stamps[3] - stamps[2]);
    EXPECT_EQ(MovieReader(source).rotation(), 270);  // this ffmpeg counts anticlockwise
    pass_through(source, file("out.mp4"));
    EXPECT_EQ(time_stamps(file("out.mp4")), stamps);
    EXPECT_EQ(MovieReader(file("out.mp4")).rotation(), 270);
    const std::string length = "-show_entries format=duration";
    EXPECT_EQ(probe(source, length), probe(file("out.mp4"), length));
}

TEST_F(Movie, PartsOfAMovie) {
    const fs::path source =
        make("-f lavfi -i testsrc2=size=96x64:rate=25 -f lavfi -i sine -t 2 -c:v ffv1 -pix_fmt yuv420p -c:a pcm_s16le",
             "in.mkv");
    MovieSettings middle;
    middle.frames.resize(25);
    std::iota(middle.frames.begin(), middle.frames.end(), 11);
    EXPECT_TRUE(pass_through(source, file("part.mkv"), middle).empty());
    const auto stamps = time_stamps(file("part.mkv"));
    ASSERT_EQ(stamps.size(), 25U);
    EXPECT_EQ(stamps.front(), 0);
    const double sound =
        std::stod(probe(file("part.mkv"), "-select_streams a -show_entries format=duration -of csv=p=0"));
    EXPECT_NEAR(sound, 1.0, 0.06);

    MovieSettings gaps;
    gaps.frames = {1, 3, 5};
    const auto warnings = pass_through(source, file("gaps.mkv"), gaps);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("gaps"), std::string::npos);
    EXPECT_EQ(time_stamps(file("gaps.mkv")), (std::vector<std::int64_t>{0, 40, 80}));

    MovieReader reader(source);
    EXPECT_EQ(reader.frame_count(), 50);
    MovieFrame frame;
    for (int i = 0; i < 9; ++i) EXPECT_TRUE(reader.skip());
    EXPECT_EQ(reader.next_number(), 10);
    ASSERT_TRUE(reader.next(frame));
    EXPECT_EQ(frame.number, 10);
    EXPECT_EQ(frame.pts, 360);
}

TEST_F(Movie, MadeFromPictures) {
    const MovieFormat format = sequence_format("a.mp4", 64, 48, 8, 2.0);
    LinearImage image;
    image.data = image.display = {0, 0, 64, 48};
    image.pixels.assign(image.data.area() * 4, 0.25F);
    for (const std::string name : {"a.mp4", "b.mp4"}) {
        MovieWriter writer(file(name), format, {24000, 1001});
        for (int i = 0; i < 7; ++i) writer.write(frame_from_linear(image, format));
        EXPECT_FALSE(fs::exists(file(name)));
        writer.finish();
    }
    EXPECT_TRUE(bytes(file("a.mp4")) == bytes(file("b.mp4")));
    EXPECT_EQ(probe(file("a.mp4"),
                    "-show_entries stream=codec_name,pix_fmt,color_range,color_space,sample_aspect_ratio,"
                    "r_frame_rate,nb_frames -of csv=p=0"),
              "h264,2:1,yuv420p,tv,bt709,24000/1001,7\n");
    EXPECT_TRUE(message_of([&] { MovieWriter(file("c.mp4"), format, {0, 1}); }).ends_with("give a positive one"));
    MovieSettings settings;
    settings.codec = "divx";
    EXPECT_NE(message_of([&] {
                  MovieWriter(file("c.mp4"), format, {24, 1}, settings);
              }).find("allowed: h264"),
              std::string::npos);
    EXPECT_THROW(MovieWriter(file("c.xyz"), format, {24, 1}), UserError);
}

TEST_F(Movie, OddSizes) {
    const fs::path vp9 = test_picture("-vf format=gbrp,crop=95:63,format=yuv420p -c:v libvpx-vp9", "in.webm", 3);
    EXPECT_TRUE(pass_through(vp9, file("same.webm")).empty());
    const auto warnings = pass_through(vp9, file("out.mp4"), [] {
        MovieSettings settings;
        settings.codec = "h264";
        return settings;
    }());
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("even sizes only, not 95x63"), std::string::npos) << warnings[0];
    EXPECT_EQ(probe(file("out.mp4"), "-show_entries stream=width,height,pix_fmt -of csv=p=0"), "95,63,yuv444p\n");
}

TEST_F(Movie, BadFiles) {
    const auto open = [](const fs::path& path) { return message_of([&] { MovieReader reader(path); }); };
    EXPECT_NE(open(file("none.mp4")).find("no such movie"), std::string::npos);
    EXPECT_NE(open(folder_).find("not a regular file"), std::string::npos);
    std::ofstream(file("zero.mp4"));
    EXPECT_NE(open(file("zero.mp4")).find("empty"), std::string::npos);
    std::ofstream(file("text.mp4")) << "This is no movie, whatever its name says.\n";
    EXPECT_NE(open(file("text.mp4")).find("cannot be read as a movie"), std::string::npos);
    make("-f lavfi -i sine -t 0.2 -c:a aac", "sound.mp4");
    EXPECT_NE(open(file("sound.mp4")).find("no video stream"), std::string::npos);
    const fs::path source = test_picture("-c:v libx264 -pix_fmt yuv420p", "good.mp4", 30);
    fs::resize_file(source, fs::file_size(source) / 2);  // the index is at the end
    EXPECT_NE(open(source).find("cannot be read as a movie"), std::string::npos);
    for (const std::string& name : left_over()) EXPECT_EQ(open(file(name)).find('\n'), std::string::npos);
}

TEST_F(Movie, WriterFailsCleanly) {
    const fs::path source = test_picture("-c:v ffv1 -pix_fmt yuv420p", "in.mkv", 30);
    MovieReader reader(source);
    EXPECT_NE(message_of([&] { MovieWriter writer(source, reader); }).find("output and input"), std::string::npos);
    EXPECT_THROW(MovieWriter(file("nowhere/out.mkv"), reader), FrameError);
    EXPECT_THROW(MovieWriter(file("out.mkv"), reader).finish(), FrameError);

    // A limit on file sizes stands for a full disk.
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{20000, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    const std::string message = message_of([&] { pass_through(source, file("out.mkv")); });
    setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_NE(message.find("out.mkv: cannot be written"), std::string::npos) << message;
    EXPECT_EQ(left_over(), std::vector<std::string>{"in.mkv"});
}

}  // namespace
}  // namespace eikonal
