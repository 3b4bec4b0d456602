/// Frames of movies as codes and as linear light. Still pixels keep their codes, and unchanged light gives the same
/// codes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "warp/image/movie_frame.h"
#include "warp/image/movie_writer.h"

namespace eikonal {
namespace {

MovieFrame noise_frame(const MovieFormat& format, unsigned seed) {
    MovieFrame frame;
    frame.format = format;
    std::mt19937 random(seed);
    for (int plane = 0; plane < 4; ++plane) {
        if (!format.has_plane(plane)) continue;
        auto& codes = frame.planes[static_cast<std::size_t>(plane)];
        codes.resize(static_cast<std::size_t>(format.plane_width(plane) * format.plane_height(plane)));
        // Codes are around the middle, so that R'G'B' stays in gamut. PQ and HLG cannot bring back values far outside.
        const bool colour = !format.rgb && (plane == 1 || plane == 2);
        const auto largest = (1u << format.depth) - 1;
        for (auto& code : codes)
            code = static_cast<std::uint16_t>(colour ? largest * 3 / 8 + random() % (largest / 4)
                                                     : largest * 3 / 10 + random() % (largest * 4 / 10));
        if (plane == 3)
            for (auto& code : codes) code = static_cast<std::uint16_t>(std::max<unsigned>(code, largest / 2));
    }
    return frame;
}

MovieFormat small_format(int depth) {
    MovieFormat format;
    format.width = 38;
    format.height = 24;
    format.depth = depth;
    return format;
}

int largest_difference(const MovieFrame& a, const MovieFrame& b) {
    int largest = 0;
    for (std::size_t plane = 0; plane < 4; ++plane)
        for (std::size_t i = 0; i < a.planes[plane].size(); ++i)
            largest = std::max(largest, std::abs(int{a.planes[plane][i]} - int{b.planes[plane][i]}));
    return largest;
}

/// Codes after load and store of every pixel.
MovieFrame there_and_back(const MovieFrame& frame) {
    const LinearImage image = load_frame(frame);
    MovieFrame result = frame;
    for (auto& plane : result.planes) std::fill(plane.begin(), plane.end(), std::uint16_t{1});
    store_frame(result, image, std::vector<std::uint8_t>(image.data.area(), 1));
    return result;
}

// Every family, depth, transfer and siting: linear light leads back to the codes, chroma included.
TEST(MovieFrame, CodesReturn) {
    for (const int transfer : {1, 2, 4, 8, 13, 16, 18})
        for (const int depth : {8, 10, 12}) {
            std::vector<MovieFormat> formats(8, small_format(depth));
            formats[0].gray = true;
            formats[1].rgb = true;
            formats[2].rgb = formats[2].alpha = true;
            formats[4].log2_chroma_w = 1;
            formats[5].log2_chroma_w = formats[5].log2_chroma_h = 1;
            formats[6].log2_chroma_w = 2;
            formats[7].log2_chroma_h = 1;
            for (MovieFormat format : formats)
                for (int siting = 0; siting <= (format.log2_chroma_h == 1 ? 6 : 0); ++siting)
                    for (const CodeRange range : {CodeRange::Limited, CodeRange::Full}) {
                        format.transfer = transfer;
                        format.siting = static_cast<ChromaSiting>(siting);
                        format.range = range;
                        const MovieFrame frame = noise_frame(format, 7);
                        ASSERT_LE(largest_difference(frame, there_and_back(frame)), depth < 12 ? 0 : 1)
                            << "transfer " << transfer << " depth " << depth << " rgb " << format.rgb << " chroma "
                            << format.log2_chroma_w << format.log2_chroma_h << " siting " << siting;
                    }
        }
}

TEST(MovieFrame, KnownColours) {
    MovieFormat format = small_format(8);
    format.width = format.height = 4;
    format.log2_chroma_w = format.log2_chroma_h = 1;
    format.matrix = 1;
    format.range = CodeRange::Limited;
    MovieFrame frame = noise_frame(format, 1);
    const auto fill = [&](int y, int cb, int cr) {
        std::fill(frame.planes[0].begin(), frame.planes[0].end(), static_cast<std::uint16_t>(y));
        std::fill(frame.planes[1].begin(), frame.planes[1].end(), static_cast<std::uint16_t>(cb));
        std::fill(frame.planes[2].begin(), frame.planes[2].end(), static_cast<std::uint16_t>(cr));
        const LinearImage image = load_frame(frame);
        return std::array<float, 4>{image.pixels[20], image.pixels[21], image.pixels[22], image.pixels[23]};
    };
    EXPECT_EQ(fill(16, 128, 128), (std::array<float, 4>{0, 0, 0, 1}));
    for (int lane = 0; lane < 4; ++lane) EXPECT_NEAR(fill(235, 128, 128)[static_cast<std::size_t>(lane)], 1, 1e-5);
    // BT.709's own red, as its bars code it.
    const auto red = fill(63, 102, 240);
    EXPECT_NEAR(red[0], 1, 0.02);
    EXPECT_NEAR(red[1], 0, 0.005);
    EXPECT_NEAR(red[2], 0, 0.005);
    format.matrix = 5;
    frame.format = format;
    const auto red601 = fill(81, 90, 240);
    EXPECT_NEAR(red601[0], 1, 0.02);
    EXPECT_NEAR(red601[1], 0, 0.005);
    // Mid-grey of BT.709: V = 0.5 is 0.2597 of linear light.
    format.depth = 10;
    frame.format = format;
    EXPECT_NEAR(fill(64 + 438, 512, 512)[1], 0.2597, 1e-4);
}

// Only what moved is written, and a chroma sample only with a moved pixel in its cell.
TEST(MovieFrame, StillCodesStay) {
    MovieFormat format = small_format(8);
    format.log2_chroma_w = format.log2_chroma_h = 1;
    const MovieFrame original = noise_frame(format, 3);
    LinearImage image = load_frame(original);
    for (float& value : image.pixels) value = 0.5F;
    std::vector<std::uint8_t> moved(image.data.area(), 0);
    const int mx = 11, my = 6;
    moved[static_cast<std::size_t>(my * format.width + mx)] = 1;
    MovieFrame frame = original;
    store_frame(frame, image, moved);
    for (int plane = 0; plane < 3; ++plane) {
        const int shift = plane == 0 ? 0 : 1;
        const int width = format.plane_width(plane);
        const auto p = static_cast<std::size_t>(plane);
        for (int i = 0; i < static_cast<int>(frame.planes[p].size()); ++i) {
            const bool here = i % width == mx >> shift && i / width == my >> shift;
            const auto k = static_cast<std::size_t>(i);
            if (here) continue;
            ASSERT_EQ(frame.planes[p][k], original.planes[p][k]) << plane << " " << i;
        }
    }
    EXPECT_NE(frame.planes[0][static_cast<std::size_t>(my * format.width + mx)],
              original.planes[0][static_cast<std::size_t>(my * format.width + mx)]);
    EXPECT_EQ(frame.planes[1][static_cast<std::size_t>((my >> 1) * 19 + (mx >> 1))], 128);
}

TEST(MovieFrame, NotANumberAndOutOfRangeAreClipped) {
    MovieFormat format = small_format(10);
    format.log2_chroma_w = format.log2_chroma_h = 1;
    MovieFrame frame = noise_frame(format, 3);
    LinearImage image = load_frame(frame);
    const std::array<float, 4> bad{std::nanf(""), INFINITY, -INFINITY, 1e30F};
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = bad[(i / 4) % 4];
    store_frame(frame, image, std::vector<std::uint8_t>(image.data.area(), 1));
    for (const auto& plane : frame.planes)
        for (const auto code : plane) ASSERT_LE(code, 1023);
}

TEST(MovieFrame, PictureWithWindows) {
    LinearImage image;
    image.display = {0, 0, 8, 4};
    image.data = {-2, 1, 6, 2};  // overscan on the left, missing on the right and above
    image.pixels.assign(image.data.area() * 4, 1.0F);
    const MovieFormat format = sequence_format("a.mov", 8, 4, 16);
    EXPECT_EQ(format.depth, 10);
    EXPECT_EQ(sequence_format("a.mp4", 8, 4, 16).depth, 8);
    EXPECT_EQ(sequence_format("a.mov", 7, 4, 8).log2_chroma_w, 0);
    const MovieFrame frame = frame_from_linear(image, format);
    EXPECT_EQ(frame.planes[0][8 * 1 + 3], 940);
    EXPECT_EQ(frame.planes[0][8 * 1 + 4], 64);
    EXPECT_EQ(frame.planes[0][3], 64);
    EXPECT_EQ(frame.planes[1][0], 512);
}

}  // namespace
}  // namespace eikonal
