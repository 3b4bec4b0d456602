/// Pictures in and out: windows, metadata, types and stored bits are kept by every kind of file; colour goes to linear
/// light and back; channels have the right kind; broken files and failed writes are errors.
#include <OpenImageIO/deepdata.h>
#include <OpenImageIO/half.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <cstring>
#include <fstream>
#include <limits>

#include "noise/base/error.h"
#include "tests/warp/image/image_fixture.h"
#include "warp/image/channels.h"
#include "warp/image/picture.h"
#include "warp/image/pixel_codec.h"
#include "warp/image/plane.h"

namespace eikonal {
namespace {

ImageSpec with_metadata(ImageSpec s) {
    s.attribute("PixelAspectRatio", 2.0f);
    s.attribute("Software", "somebody's renderer");
    s.attribute("owner", "show 42");
    const int rate[2] = {24000, 1001};
    s.attribute("FramesPerSecond", TypeDesc(TypeDesc::INT, TypeDesc::VEC2, TypeDesc::RATIONAL), rate);
    const unsigned time_code[2] = {0x01020304, 0};
    s.attribute("smpte:TimeCode", OIIO::TypeTimeCode, time_code);
    const float primaries[8] = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
    s.attribute("chromaticities", TypeDesc(TypeDesc::FLOAT, 8), primaries);
    return s;
}

TEST_F(ImageTest, ExrKeepsEverything) {
    ImageSpec scanline = with_metadata(spec(37, 23, {"R", "G", "B", "A"}, TypeDesc::HALF));
    scanline.attribute("compression", "piz");
    expect_round_trip("scanline.exr", {scanline});

    ImageSpec tiled = with_metadata(spec(70, 50, {"R", "G", "B"}, TypeDesc::FLOAT));
    tiled.tile_width = 32;
    tiled.tile_height = 16;
    tiled.attribute("compression", "zip");
    expect_round_trip("tiled.exr", {tiled});

    ImageSpec overscan = spec(40, 30, {"R", "G", "B", "A"}, TypeDesc::HALF);
    overscan.x = -4;
    overscan.y = -3;
    overscan.full_width = 32;
    overscan.full_height = 24;
    expect_round_trip("overscan.exr", {overscan});
    overscan.x = 10;
    overscan.y = 12;
    overscan.full_x = 2;
    overscan.full_width = 100;
    expect_round_trip("cropped.exr", {overscan});

    ImageSpec mixed = spec(33, 21, {"R", "G", "B", "A", "Z", "object_id"}, TypeDesc::FLOAT);
    mixed.channelformats = {TypeDesc::HALF, TypeDesc::HALF,  TypeDesc::HALF,
                            TypeDesc::HALF, TypeDesc::FLOAT, TypeDesc::UINT32};
    expect_round_trip("mixed.exr", {mixed});

    ImageSpec beauty = spec(20, 12, {"R", "G", "B", "A"}, TypeDesc::HALF);
    beauty.attribute("name", "beauty");
    beauty.attribute("oiio:subimagename", "beauty");
    ImageSpec depth = spec(20, 12, {"Z"}, TypeDesc::FLOAT);
    depth.attribute("name", "depth");
    depth.attribute("oiio:subimagename", "depth");
    depth.attribute("compression", "zips");
    expect_round_trip("parts.exr", {beauty, depth});
}

TEST_F(ImageTest, OtherFormatsKeepCodesAndMetadata) {
    for (const TypeDesc type : {TypeDesc::UINT8, TypeDesc::UINT16}) {
        ImageSpec png = spec(31, 37, {"R", "G", "B", "A"}, type);
        png.attribute("oiio:UnassociatedAlpha", 1);
        png.attribute("ImageDescription", "a plate");
        expect_round_trip("alpha.png", {png});
        expect_round_trip("grey.png", {spec(31, 37, {"Y"}, type)});
        ImageSpec tiff = spec(31, 37, {"R", "G", "B", "A"}, type);
        tiff.attribute("compression", "lzw");
        expect_round_trip("associated.tif", {tiff});
        tiff.attribute("oiio:UnassociatedAlpha", 1);
        tiff.attribute("Artist", "somebody");
        expect_round_trip("unassociated.tif", {tiff});
        expect_round_trip("pages.tif", {tiff, tiff});
    }
    expect_round_trip("float.tif", {spec(31, 37, {"R", "G", "B"}, TypeDesc::FLOAT)});
    ImageSpec tga = spec(31, 37, {"R", "G", "B", "A"}, TypeDesc::UINT8);
    tga.attribute("oiio:UnassociatedAlpha", 1);
    expect_round_trip("alpha.tga", {tga});
    expect_round_trip("plain.bmp", {spec(31, 37, {"R", "G", "B"}, TypeDesc::UINT8)});
    ImageSpec dpx = spec(32, 18, {"R", "G", "B"}, TypeDesc::UINT16);
    dpx.attribute("oiio:BitsPerSample", 10);
    expect_round_trip("ten.dpx", {dpx});
    ImageSpec jpeg = spec(32, 18, {"R", "G", "B"}, TypeDesc::UINT8);
    jpeg.attribute("Orientation", 6);
    expect_round_trip("turned.jpg", {jpeg}, true);
}

TEST_F(ImageTest, MovedPixelsChangeAndOthersKeepTheirBytes) {
    ImageSpec png = spec(31, 37, {"R", "G", "B", "A"}, TypeDesc::UINT8);
    png.attribute("oiio:UnassociatedAlpha", 1);
    for (const ImageSpec& s :
         {png, spec(31, 37, {"R", "G", "B", "A"}, TypeDesc::HALF), spec(31, 37, {"R", "G", "B", "A"}, TypeDesc::FLOAT),
          spec(31, 37, {"R", "G", "B"}, TypeDesc::HALF), spec(31, 37, {"R", "G", "B", "Z"}, TypeDesc::FLOAT),
          spec(31, 37, {"Y"}, TypeDesc::UINT16)}) {
        Part part = part_of(s, s.format == TypeDesc::UINT8 ? "png" : "openexr");
        const auto before = part.pixels;
        ASSERT_EQ(part.groups.size(), 1u);
        LinearImage image = load_group(part, part.groups[0]);
        std::vector<std::uint8_t> moved(image.data.area(), 0);
        for (float& v : image.pixels) v = 0.25f;
        for (std::size_t i = 0; i < moved.size(); i += 3) moved[i] = 1;
        store_group(part, part.groups[0], image, moved);
        const LinearImage after = load_group(part, part.groups[0]);
        const std::size_t stride = part.pixel_bytes();
        for (std::size_t i = 0; i < moved.size(); ++i) {
            if (moved[i] == 0) {
                EXPECT_EQ(std::memcmp(&before[i * stride], &part.pixels[i * stride], stride), 0) << i;
            } else {
                EXPECT_NEAR(after.pixels[4 * i], 0.25f, 0.004f);
            }
        }
    }
}

TEST_F(ImageTest, UnassociatedAlphaIsPremultipliedInLinearLight) {
    ImageSpec s = spec(2, 1, {"R", "G", "B", "A"}, TypeDesc::UINT8);
    s.attribute("oiio:UnassociatedAlpha", 1);
    Part part = part_of(s, "png");
    const std::uint8_t codes[8] = {128, 255, 0, 128, 200, 100, 50, 0};
    std::memcpy(part.pixels.data(), codes, 8);
    const LinearImage image = load_group(part, part.groups.at(0));
    EXPECT_NEAR(image.pixels[0], 0.2158605 * 128 / 255, 1e-6);
    EXPECT_NEAR(image.pixels[1], 128.0 / 255, 1e-6);
    EXPECT_EQ(image.pixels[4], 0) << "invisible";
    store_group(part, part.groups[0], image, std::vector<std::uint8_t>{1, 1});
    EXPECT_EQ(std::memcmp(part.pixels.data(), codes, 4), 0);
    const std::uint8_t nothing[4] = {0, 0, 0, 0};
    EXPECT_EQ(std::memcmp(part.pixels.data() + 4, nothing, 4), 0);
}

TEST_F(ImageTest, NonFiniteColourBecomesFinite) {
    for (const TypeDesc type : {TypeDesc::HALF, TypeDesc::FLOAT}) {
        for (const auto& names :
             {std::vector<std::string>{"R", "G", "B", "A"}, std::vector<std::string>{"R", "G", "B"}}) {
            Part part = part_of(spec(2, 1, names, type));
            const float values[3] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                                     -std::numeric_limits<float>::infinity()};
            const std::size_t bytes = type.size();
            for (std::size_t c = 0; c < 3; ++c) {
                const half h(values[c]);
                if (type == TypeDesc::HALF)
                    std::memcpy(part.pixels.data() + c * bytes, &h, bytes);
                else
                    std::memcpy(part.pixels.data() + c * bytes, &values[c], bytes);
            }
            const LinearImage image = load_group(part, part.groups.at(0));
            EXPECT_EQ(image.pixels[0], 0);
            EXPECT_EQ(image.pixels[1], kLargestHalf);
            EXPECT_EQ(image.pixels[2], -kLargestHalf);
        }
    }
}

TEST_F(ImageTest, ChannelKinds) {
    ImageSpec s = spec(2, 2,
                       {"R",
                        "G",
                        "B",
                        "A",
                        "Z",
                        "diffuse.R",
                        "diffuse.G",
                        "diffuse.B",
                        "N.X",
                        "N.Y",
                        "N.Z",
                        "mask.A",
                        "uCryptoObject00.R",
                        "ObjectID.R",
                        "sss.B",
                        "sss.G",
                        "sss.R",
                        "sss.A",
                        "motionVector.R",
                        "ids",
                        "forward.u",
                        "rim.Y",
                        "P.Y",
                        "P.X",
                        "depth.Y",
                        "solid.R"},
                       TypeDesc::FLOAT);
    s.channelformats.assign(26, TypeDesc::HALF);
    s.channelformats[25] = TypeDesc::UINT32;
    const Part part = part_of(s);
    std::string kinds;
    for (const ChannelKind kind : part.kinds)
        kinds += kind == ChannelKind::Colour ? 'C' : kind == ChannelKind::Alpha ? 'A' : 'D';
    EXPECT_EQ(kinds, "CCCADCCCDDDDDDCCCADDDCDDDD");
    ASSERT_EQ(part.groups.size(), 4u);
    EXPECT_EQ(part.groups[0].alpha, 3);
    EXPECT_EQ(part.groups[1].layer, "diffuse");
    EXPECT_EQ(part.groups[1].alpha, -1);
    EXPECT_EQ(part.groups[2].channel, (std::array<int, 4>{16, 15, 14, -1})) << "R, G, B whatever the file's order";
    EXPECT_EQ(part.groups[2].alpha, 17);
    EXPECT_EQ(part.groups[3].count, 1);

    ImageSpec named = spec(2, 2, {"R", "G", "B"}, TypeDesc::HALF);
    named.attribute("name", "normals");
    EXPECT_TRUE(part_of(named).groups.empty()) << "a part's name counts for channels without a layer";
    ImageSpec crypto = spec(2, 2, {"pile00.R", "pile00.G"}, TypeDesc::FLOAT);
    crypto.attribute("cryptomatte/abc1234/name", "pile");
    EXPECT_TRUE(part_of(crypto).groups.empty());
    EXPECT_EQ(part_of(spec(2, 2, {"A"}, TypeDesc::HALF)).groups.at(0).count, 0);
}

TEST_F(ImageTest, DataMovesByteByByte) {
    ImageSpec s = spec(5, 4, {"R", "Z", "object_id", "G", "B", "mask"}, TypeDesc::FLOAT);
    s.channelformats = {TypeDesc::HALF, TypeDesc::FLOAT, TypeDesc::UINT32,
                        TypeDesc::HALF, TypeDesc::HALF,  TypeDesc::HALF};
    const Part source = part_of(s);
    Part target = source;
    const DataMover mover(source);
    ASSERT_FALSE(mover.empty());
    mover.copy(source, 7, target, 2);
    mover.clear(target, 3);
    const std::size_t stride = source.pixel_bytes();  // 16
    const auto same = [&](std::size_t a, std::size_t b, std::size_t offset, std::size_t bytes) {
        return std::memcmp(&source.pixels[a * stride + offset], &target.pixels[b * stride + offset], bytes) == 0;
    };
    EXPECT_TRUE(same(2, 2, 0, 2) && same(7, 2, 2, 8) && same(2, 2, 10, 4) && same(7, 2, 14, 2));
    EXPECT_FALSE(same(2, 2, 2, 8));
    EXPECT_TRUE(same(3, 3, 0, 2) && same(3, 3, 10, 4));
    EXPECT_EQ(target.pixels[3 * stride + 4], std::byte{0});
    EXPECT_TRUE(DataMover(part_of(spec(2, 2, {"R", "G", "B"}, TypeDesc::HALF))).empty());
}

TEST_F(ImageTest, NewPicturesAndOtherFormats) {
    LinearImage image{{-1, 0, 6, 4}, {0, 0, 4, 4}, 1, std::vector<float>(4 * 24, 0.5f)};
    for (const char* name : {"a.exr", "a.png", "a.tif", "a.dpx", "a.jpg", "a.tga", "a.hdr", "a.bmp", "a.webp"}) {
        SCOPED_TRACE(name);
        const Picture made = picture_from_linear(image, folder / name, true, 10);
        write_picture(folder / name, made);
        const Picture read = read_picture(folder / name);
        const Part& part = read.parts.at(0);
        EXPECT_EQ(display_window(part), image.display);
        EXPECT_EQ(data_window(part), read.format == "openexr" ? image.data : image.display);
        const LinearImage back = load_group(part, part.groups.at(0));
        const bool alpha = part.groups[0].alpha >= 0;
        const double tolerance = read.format == "jpeg" || read.format == "webp" ? 0.02 : 0.004;
        EXPECT_NEAR(back.pixels[0], 0.5, tolerance);
        EXPECT_NEAR(back.pixels[3], alpha ? 0.5 : 1, 0.004);
    }
    EXPECT_EQ(picture_from_linear(image, "a.png", false, 8).parts[0].spec.format, TypeDesc::UINT8);
    EXPECT_EQ(picture_from_linear(image, "a.png", false, 10).parts[0].spec.format, TypeDesc::UINT16);
    EXPECT_EQ(picture_from_linear(image, "a.exr", false, 8).parts[0].spec.format, TypeDesc::HALF);
    EXPECT_THROW(picture_from_linear(image, "a.nothing", false, 8), FrameError);
    EXPECT_THROW(write_picture(folder / "a.nothing", picture_from_linear(image, "a.exr", false, 8)), FrameError);

    ImageSpec layered = with_metadata(spec(6, 4, {"R", "G", "B", "A", "Z"}, TypeDesc::HALF));
    Picture exr{{part_of(layered)}, "openexr"};
    EXPECT_EQ(picture_for_format(exr, "b.exr").parts[0].pixels, exr.parts[0].pixels);
    const Picture png = picture_for_format(exr, "b.png");
    EXPECT_EQ(png.parts[0].spec.nchannels, 4);
    EXPECT_EQ(png.parts[0].spec.get_string_attribute("owner"), "show 42");
    EXPECT_EQ(png.parts[0].transfer, Transfer::SRGB);
    Picture depth{{part_of(spec(2, 2, {"Z"}, TypeDesc::FLOAT))}, "openexr"};
    EXPECT_THROW(picture_for_format(depth, "b.png"), FrameError);
}

TEST_F(ImageTest, FloatExr) {
    const std::vector<std::string> names = {"u", "v"};
    std::vector<float> values(2 * 12);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i) * 0.1f;
    const std::vector<Attribute> attributes = {{"period", 2.5}, {"model", "spectral"}};
    write_float_exr(folder / "map.exr", {-1, -1, 4, 3}, {0, 0, 2, 2}, names, values, attributes);
    const Picture picture = read_picture(folder / "map.exr");
    const Part& part = picture.parts.at(0);
    EXPECT_EQ(part.spec.channelnames, names);
    EXPECT_EQ(part.spec.get_string_attribute("compression"), "zip");
    EXPECT_EQ(part.spec.get_float_attribute("period"), 2.5f);
    EXPECT_EQ(part.spec.get_string_attribute("model"), "spectral");
    EXPECT_EQ(data_window(part), (PixelWindow{-1, -1, 4, 3}));
    ASSERT_EQ(part.pixels.size(), values.size() * 4);
    EXPECT_EQ(std::memcmp(part.pixels.data(), values.data(), part.pixels.size()), 0);
    EXPECT_TRUE(part.groups.empty());
}

TEST_F(ImageTest, BrokenFilesAreErrors) {
    for (const char* name : {"a.exr", "tiled.exr", "a.png", "a.tif", "a.jpg", "a.tga", "a.dpx", "a.hdr", "a.webp"}) {
        const fs::path path = folder / name;
        ImageSpec s = spec(64, 48, {"R", "G", "B"}, TypeDesc::UINT8);
        if (path.extension() == ".exr") s.set_format(TypeDesc::HALF);
        if (path.extension() == ".hdr") s.set_format(TypeDesc::FLOAT);
        if (std::string_view(name) == "tiled.exr") s.tile_width = s.tile_height = 16;
        write_reference(path, {s});
        EXPECT_NO_THROW(read_picture(path)) << name;
        const auto size = fs::file_size(path);
        for (const auto keep : {size * 95 / 100, size / 2, size / 10, std::uintmax_t{7}, std::uintmax_t{0}}) {
            if (keep > size / 2 && path.extension() == ".tga") continue;  // ends in a thumbnail and a footer
            fs::resize_file(path, keep);
            const std::string message = message_of([&] { read_picture(path); });
            EXPECT_EQ(message.rfind("cannot read '" + path.string() + "': ", 0), 0u)
                << name << " " << keep << ": " << message;
            EXPECT_EQ(message.find('\n'), std::string::npos);
        }
    }
    EXPECT_NE(message_of([&] { read_picture(folder / "none.exr"); }).find("no such file"), std::string::npos);
    EXPECT_NE(message_of([&] { read_picture(folder); }).find("folder"), std::string::npos);
    std::ofstream(folder / "text.exr") << "this is no picture at all, though it has some length";
    EXPECT_THROW(read_picture(folder / "text.exr"), FrameError);
    ImageSpec deep = spec(4, 4, {"R", "A", "Z"}, TypeDesc::FLOAT);
    deep.deep = true;
    {
        auto output = OIIO::ImageOutput::create("deep.exr");
        ASSERT_TRUE(output->open((folder / "deep.exr").string(), deep));
        OIIO::DeepData data;
        data.init(deep);
        ASSERT_TRUE(output->write_deep_image(data));
        output->close();
    }
    EXPECT_NE(message_of([&] { read_picture(folder / "deep.exr"); }).find("deep"), std::string::npos);
}

TEST_F(ImageTest, MipMapsKeepTheFullLevel) {
    OIIO::ImageBuf buffer(spec(64, 64, {"R", "G", "B"}, TypeDesc::HALF));
    const fs::path path = folder / "texture.exr";
    ASSERT_TRUE(
        OIIO::ImageBufAlgo::make_texture(OIIO::ImageBufAlgo::MakeTxTexture, buffer, path.string(), ImageSpec()));
    const Picture picture = read_picture(path);
    write_picture(folder / "plain.exr", picture);
    const Picture again = read_picture(folder / "plain.exr");
    EXPECT_EQ(again.parts.at(0).pixels, picture.parts.at(0).pixels);
    EXPECT_EQ(again.parts[0].spec.tile_width, picture.parts[0].spec.tile_width);
}

TEST_F(ImageTest, FailedWritesLeaveNothing) {
    const LinearImage image{{0, 0, 256, 256}, {0, 0, 256, 256}, 1, std::vector<float>(4 * 65536, 0.25f)};
    EXPECT_THROW(write_picture(folder / "missing" / "a.exr", picture_from_linear(image, "a.exr", true, 8)), FrameError);
    // A limit on file sizes stands for a full disk: writes fail half way.
    const auto previous = signal(SIGXFSZ, SIG_IGN);
    rlimit limit{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
    for (const char* name : {"a.exr", "a.png", "a.tif", "a.jpg", "a.tga", "a.dpx", "a.hdr", "a.bmp", "a.webp"}) {
        const Picture picture = picture_from_linear(image, name, true, 16);
        const fs::path path = folder / name;
        rlimit small = limit;
        small.rlim_cur = 200;
        ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
        const std::string message = message_of([&] { write_picture(path, picture); });
        ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
        EXPECT_EQ(message.rfind("cannot write '" + path.string() + "': ", 0), 0u) << name << ": " << message;
        EXPECT_EQ(files(), 0u) << name;
    }
    signal(SIGXFSZ, previous);
}

// ---- depth ------------------------------------------------------------------------------------------------------

}  // namespace
}  // namespace eikonal
