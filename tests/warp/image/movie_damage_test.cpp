/// Movies that are cut off or damaged. Every good frame is read, and every other frame is named in an error.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "noise/base/error.h"
#include "tests/warp/image/movie_fixture.h"
#include "warp/image/movie_frame.h"
#include "warp/image/movie_libav.h"
#include "warp/image/movie_reader.h"

namespace eikonal {
namespace {

/// The result of reading to the end: the numbers of the good frames, and the messages of the others.
struct Reading {
    std::vector<int> good;
    std::vector<std::string> errors;
};
Reading read_all(MovieReader& reader) {
    Reading reading;
    MovieFrame frame;
    for (int guard = 0; guard < 1000; ++guard) {
        const int expected = reader.next_number();
        try {
            if (!reader.next(frame)) return reading;
            reading.good.push_back(frame.number);
            EXPECT_EQ(frame.number, expected);
        } catch (const FrameError& error) {
            reading.errors.push_back(error.what());
            EXPECT_NE(reading.errors.back().find(": frame " + std::to_string(expected) + ":"), std::string::npos)
                << reading.errors.back();
        }
    }
    ADD_FAILURE() << "reading does not end";
    return reading;
}

/// Turns the bits of frame `number`, of `count` of about the same size, in a movie without inter-frame coding.
void damage(const fs::path& movie, std::size_t number, std::size_t count) {
    std::ifstream in(movie, std::ios::binary);
    std::string data{std::istreambuf_iterator<char>(in), {}};
    const std::size_t middle = data.size() * (2 * number - 1) / (2 * count);
    for (std::size_t i = 0; i < 40; ++i) data[middle + i] = static_cast<char>(~data[middle + i]);
    std::ofstream(movie, std::ios::binary) << data;
}

TEST_F(Movie, CutOffMoviesNameTheFrame) {
    for (const std::string options : {"-c:v libx264 -pix_fmt yuv420p -movflags faststart in.mp4", "-c:v ffv1 in.mkv",
                                      "-c:v mpeg4 -q:v 2 in.avi", "-c:v mjpeg in.mov -movflags faststart"}) {
        const bool faststart = options.find("mjpeg") != std::string::npos;
        const std::string name = faststart ? "in.mov" : options.substr(options.rfind(' ') + 1);
        const fs::path source = test_picture(
            faststart ? "-c:v mjpeg -movflags faststart" : options.substr(0, options.rfind(' ')), name, 60);
        fs::resize_file(source, fs::file_size(source) * 3 / 4);
        MovieReader reader(source);
        MovieFrame frame;
        int good = 0;
        std::string message;
        for (bool more = true; more;) {
            message = message_of([&] {
                while ((more = reader.next(frame))) ++good;
            });
            if (!message.empty()) break;
        }
        EXPECT_NE(message.find(source.string() + ": frame "), std::string::npos) << name << " " << message;
        EXPECT_GT(good, 20) << name;
        EXPECT_LT(good, 60) << name;
        for (int guard = 0; guard < 100; ++guard)  // further reading ends
            if (message_of([&] { reader.next(frame); }).empty() && !reader.skip()) break;
        EXPECT_FALSE(reader.skip());
    }
}

TEST_F(Movie, DamagedFrameInTheMiddle) {
    const fs::path source = test_picture("-c:v ffv1 -level 3 -slicecrc 1 -pix_fmt yuv420p", "in.mkv", 30);
    damage(source, 15, 30);
    MovieReader reader(source);
    const Reading reading = read_all(reader);
    EXPECT_EQ(reading.good.size(), 29U);
    EXPECT_EQ(reading.errors.size(), 1U);
    EXPECT_EQ(reading.good.back(), 30);
}

// A transport stream marks a packet as broken. Only that frame is lost, and the movie ends well.
TEST_F(Movie, BrokenPacketInTheMiddleIsOneFrame) {
    constexpr std::size_t kPacket = 188;
    const fs::path source = test_picture("-c:v mpeg2video -g 1 -pix_fmt yuv420p", "in.ts", 30);
    std::string data = bytes(source);
    for (std::size_t at = data.size() / kPacket / 2 * kPacket; at < data.size(); at += kPacket) {
        const bool video = (data[at + 1] & 0x1f) == 1 && data[at + 2] == 0, starts = data[at + 1] & 0x40;
        if (!video || starts) continue;
        data[at + 1] = static_cast<char>(data[at + 1] | 0x80);  // transport error
        break;
    }
    std::ofstream(source, std::ios::binary) << data;
    MovieReader reader(source);
    const Reading reading = read_all(reader);
    EXPECT_EQ(reading.good.size(), 29U);
    ASSERT_EQ(reading.errors.size(), 1U) << reading.errors.back();
    EXPECT_NE(reading.errors[0].find("damaged"), std::string::npos) << reading.errors[0];
    EXPECT_EQ(reading.good.back(), 30);
}

TEST_F(Movie, DamagedFirstFramesAreLikeAnyOthers) {
    const fs::path source = test_picture("-c:v ffv1 -level 3 -slicecrc 1 -pix_fmt yuv420p", "in.mkv", 10);
    damage(source, 1, 10);
    damage(source, 2, 10);
    MovieReader reader(source);
    EXPECT_EQ(reader.format().width, 96);
    const Reading reading = read_all(reader);
    EXPECT_EQ(reading.good, (std::vector<int>{3, 4, 5, 6, 7, 8, 9, 10}));
    EXPECT_EQ(reading.errors.size(), 2U);

    MovieReader skipping(source);
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(skipping.skip());
    EXPECT_EQ(skipping.next_number(), 4);

    for (std::size_t i = 3; i <= 10; ++i) damage(source, i, 10);
    const std::string message = message_of([&] { MovieReader{source}; });
    EXPECT_NE(message.find(": frame 1: "), std::string::npos) << message;
}

TEST_F(Movie, MessagesOfObjectsWithoutAClassAreHarmless) {
    struct {
        const AVClass* what = nullptr;
    } object;
    libav::silence();
    av_log(&object, AV_LOG_ERROR, "a message without a sender\n");
    av_log(nullptr, AV_LOG_ERROR, "another\n");
    EXPECT_EQ(libav::reason(AVERROR(EIO)), "Input/output error (another)");
}

}  // namespace
}  // namespace eikonal
