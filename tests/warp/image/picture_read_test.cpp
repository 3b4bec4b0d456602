// Reading pictures: turned upright as Exif says; whether a file is whole, without reading it all.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <functional>

#include "noise/base/error.h"
#include "warp/image/orientation.h"
#include "warp/image/picture.h"

namespace eikonal {
namespace {
namespace fs = std::filesystem;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

class PictureReadTest : public testing::Test {
  protected:
    PictureReadTest() {
        std::string name = (fs::temp_directory_path() / "eikonal-read-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
        folder = name;
    }
    ~PictureReadTest() override { fs::remove_all(folder); }

    /// Grey pictures, one a part, whose codes are code(x, y).
    using Code = std::function<std::uint8_t(int x, int y)>;
    fs::path write(const std::string& name, const std::vector<ImageSpec>& specs, const Code& code) const {
        const fs::path path = folder / name;
        const auto output = OIIO::ImageOutput::create(path.string());
        const bool announced = specs.size() > 1 && !output->supports("appendsubimage");
        for (std::size_t i = 0; i < specs.size(); ++i) {
            const ImageSpec& spec = specs[i];
            std::vector<std::uint8_t> pixels;
            for (int y = 0; y < spec.height; ++y)
                for (int x = 0; x < spec.width; ++x) pixels.push_back(code(x, y));
            EXPECT_TRUE(i > 0       ? output->open(path.string(), spec, OIIO::ImageOutput::AppendSubimage)
                        : announced ? output->open(path.string(), static_cast<int>(specs.size()), specs.data())
                                    : output->open(path.string(), spec));
            EXPECT_TRUE(output->write_image(TypeDesc::UINT8, pixels.data())) << output->geterror();
        }
        EXPECT_TRUE(output->close()) << output->geterror();
        return path;
    }

    fs::path folder;
};

// Where the visual top left corner lies among the stored pixels of a 5 x 3 picture, and the steps along the visual row
// and column, from the words of Exif ("the 0th row is the visual right-hand side, the 0th column the visual top" …).
struct Way {
    int orientation, x, y, right_x, right_y, down_x, down_y;
};

TEST_F(PictureReadTest, TurnedUprightAsExifSays) {
    constexpr int kWide = 5, kHigh = 3;
    const auto code = [](int x, int y) { return static_cast<std::uint8_t>(10 * y + x); };
    for (const Way& way : {Way{1, 0, 0, 1, 0, 0, 1},      // row 0 is the top, column 0 the left side
                           Way{2, 4, 0, -1, 0, 0, 1},     // top, right
                           Way{3, 4, 2, -1, 0, 0, -1},    // bottom, right
                           Way{4, 0, 2, 1, 0, 0, -1},     // bottom, left
                           Way{5, 0, 0, 0, 1, 1, 0},      // left, top
                           Way{6, 0, 2, 0, -1, 1, 0},     // right, top
                           Way{7, 4, 2, 0, -1, -1, 0},    // right, bottom
                           Way{8, 4, 0, 0, 1, -1, 0}}) {  // left, bottom
        SCOPED_TRACE(way.orientation);
        ImageSpec spec(kWide, kHigh, 1, TypeDesc::UINT8);
        spec.attribute("Orientation", way.orientation);
        const fs::path file = write("o.tif", {spec}, code);
        const Picture picture = read_picture(file);
        const Part& part = picture.parts.front();
        const bool lies = way.orientation > 4;
        ASSERT_EQ(data_window(part), (PixelWindow{0, 0, lies ? kHigh : kWide, lies ? kWide : kHigh}));
        EXPECT_EQ(display_window(part), data_window(part));
        EXPECT_EQ(data_window(read_picture_header(file).parts.front()), data_window(part));
        EXPECT_EQ(part.spec.get_int_attribute("Orientation"), 1);
        for (int y = 0; y < part.spec.height; ++y)
            for (int x = 0; x < part.spec.width; ++x) {
                const auto stored =
                    static_cast<std::uint8_t>(part.pixels[static_cast<std::size_t>(y * part.spec.width + x)]);
                EXPECT_EQ(stored,
                          code(way.x + x * way.right_x + y * way.down_x, way.y + x * way.right_y + y * way.down_y))
                    << x << " " << y;
            }
    }
}

// The window's place on its display turns too. Four quarter turns give the picture back.
TEST_F(PictureReadTest, WindowsTurnWithTheirPixels) {
    Part part;
    part.spec = ImageSpec(4, 2, 1, TypeDesc::UINT8);
    part.spec.x = 3;
    part.spec.y = 1;
    part.spec.full_x = 1;
    part.spec.full_y = 0;
    part.spec.full_width = 10;
    part.spec.full_height = 6;
    part.spec.attribute("PixelAspectRatio", 2.0f);
    part.spec.attribute("XResolution", 300.0f);
    part.spec.attribute("YResolution", 150.0f);
    for (int i = 0; i < 8; ++i) part.pixels.push_back(static_cast<std::byte>(i));
    Part turned = part;
    const auto turn = [&](int orientation) {
        turned.spec.attribute("Orientation", orientation);
        turn_upright(turned);
    };
    turn(6);
    EXPECT_EQ(display_window(turned), (PixelWindow{0, 1, 6, 10}));
    EXPECT_EQ(data_window(turned), (PixelWindow{3, 3, 2, 4}));  // two columns are free on the left, three on the right
    EXPECT_EQ(pixel_aspect(turned), 0.5);
    EXPECT_EQ(turned.spec.get_float_attribute("XResolution"), 150.0f);
    EXPECT_EQ(turned.spec.get_float_attribute("YResolution"), 300.0f);
    EXPECT_EQ(turned.pixels[0], part.pixels[4]);
    for (int quarter = 1; quarter < 4; ++quarter) turn(6);
    EXPECT_EQ(data_window(turned), data_window(part));
    EXPECT_EQ(display_window(turned), display_window(part));
    EXPECT_EQ(turned.pixels, part.pixels);
    for (const int undone_by_itself : {2, 3, 4, 5, 7}) {
        turn(undone_by_itself);
        EXPECT_NE(turned.pixels, part.pixels);
        turn(undone_by_itself);
        EXPECT_EQ(turned.pixels, part.pixels);
    }
}

TEST_F(PictureReadTest, OrientationOfFilmFormatsIsCarriedAlone) {
    ImageSpec spec(4, 2, 1, TypeDesc::HALF);
    spec.attribute("Orientation", 6);
    const Part part = read_picture(write("o.exr", {spec}, [](int x, int) { return x; })).parts.front();
    EXPECT_EQ(data_window(part), (PixelWindow{0, 0, 4, 2}));
    EXPECT_EQ(part.spec.get_int_attribute("Orientation"), 6);
}

// PFM holds linear light, although the library calls it otherwise.
TEST_F(PictureReadTest, FloatsOfPfmAreLinear) {
    const fs::path path = folder / "a.pfm";
    std::ofstream file(path, std::ios::binary);
    file << "PF\n4 2\n-1.0\n";
    for (int i = 0; i < 8; ++i)
        for (const float v : {0.1F, 0.5F, 300.0F}) file.write(reinterpret_cast<const char*>(&v), sizeof v);
    file.close();
    const Picture picture = read_picture(path);
    EXPECT_EQ(picture.parts.front().transfer, Transfer::Linear);
}

TEST_F(PictureReadTest, EndsTellWhatIsTruncated) {
    const auto noise = [](int x, int y) { return static_cast<std::uint8_t>((x * 7919 + y * 104729) % 251); };
    ImageSpec plain(120, 90, 1, TypeDesc::UINT8), half(120, 90, 1, TypeDesc::HALF), tiled = half, backwards = half;
    tiled.tile_width = tiled.tile_height = 32;
    backwards.attribute("openexr:lineOrder", "decreasingY");
    half.attribute("oiio:subimagename", "one");
    ImageSpec other = half;
    other.attribute("oiio:subimagename", "two");
    const std::vector<std::pair<std::string, std::vector<ImageSpec>>> files{
        {"a.exr", {half}},  {"b.exr", {tiled}}, {"c.exr", {backwards}}, {"d.exr", {half, other}}, {"e.tif", {plain}},
        {"f.png", {plain}}, {"g.jpg", {plain}}, {"h.dpx", {plain}},     {"i.bmp", {plain}},       {"j.pgm", {plain}}};
    for (const auto& [name, specs] : files) {
        SCOPED_TRACE(name);
        const fs::path whole = write(name, specs, noise), cut = folder / ("cut" + whole.extension().string());
        const Picture ends = read_picture_ends(whole);
        ASSERT_EQ(ends.parts.size(), specs.size());
        EXPECT_TRUE(ends.parts.front().pixels.empty());
        EXPECT_EQ(data_window(ends.parts.front()), (PixelWindow{0, 0, 120, 90}));
        for (const double part : {0.1, 0.6, 0.9, 0.99}) {
            fs::copy_file(whole, cut, fs::copy_options::overwrite_existing);
            fs::resize_file(cut, static_cast<std::uintmax_t>(part * static_cast<double>(fs::file_size(whole))));
            EXPECT_THROW(read_picture_ends(cut), FrameError) << part;
        }
    }
}

}  // namespace
}  // namespace eikonal
