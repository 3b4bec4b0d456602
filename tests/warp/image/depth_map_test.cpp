/// Depth from pictures: types, ranges, windows, channels, mattes and errors.
#include "warp/image/depth_map.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "noise/base/error.h"
#include "tests/warp/image/image_fixture.h"
#include "warp/image/channels.h"
#include "warp/image/picture.h"
#include "warp/image/pixel_codec.h"

namespace eikonal {
namespace {

class DepthTest : public ImageTest {
  protected:
    const PixelWindow window{0, 0, 4, 1};

    static Picture picture(const std::vector<float>& values, TypeDesc type, std::vector<std::string> names = {"Z"}) {
        Part part = part_of(spec(static_cast<int>(values.size() / names.size()), 1, names, type));
        encode_values(static_cast<TypeDesc::BASETYPE>(type.basetype), values.data(), 1, part.pixels.data(), type.size(),
                      values.size());
        return {{part}, "openexr"};
    }
    std::vector<float> metres(const Picture& p, const DepthOptions& options) const {
        return depth_from_picture(p, "d.exr", options, window, window).metres;
    }
    using Metres = std::vector<float>;
    static constexpr float kInf = std::numeric_limits<float>::infinity();
    static constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
};

TEST_F(DepthTest, Types) {
    DepthOptions options;
    options.far = 500;
    // NaN has no exact code in encode_values (it is colour's), hence set by hand.
    Picture z = picture({2, kInf, 0, 1e10f}, TypeDesc::FLOAT);
    EXPECT_EQ(metres(z, options), Metres({2, 500, 500, 500}));
    std::memcpy(z.parts[0].pixels.data() + 4, &kNan, 4);
    EXPECT_EQ(metres(z, options), Metres({2, 500, 500, 500}));
    options.type = DepthType::Ray;
    EXPECT_TRUE(depth_from_picture(z, "d.exr", options, window, window).along_ray);
    options.type = DepthType::Inverse;
    EXPECT_EQ(metres(picture({2, 0.5f, 0, 1e-12f}, TypeDesc::FLOAT), options), Metres({0.5f, 2, 500, 500}));
}

TEST_F(DepthTest, Ranges) {
    DepthOptions options;
    options.far = 500;
    options.range = {{10, 110}};
    EXPECT_EQ(metres(picture({0, 1, 0.5f, 0.25f}, TypeDesc::FLOAT), options), Metres({10, 110, 60, 35}));
    EXPECT_EQ(metres(picture({0, 1, 0.2f, 0.6f}, TypeDesc::UINT8), options), Metres({10, 110, 30, 70}));
    options.type = DepthType::Inverse;
    options.range = {{1, 4}};
    EXPECT_EQ(metres(picture({0, 1, 1.0f / 3, 0.2f}, TypeDesc::UINT8), options), Metres({500, 1, 2, 2.5f}));
    EXPECT_EQ(metres(picture({0, 1, 1.0f / 3, 0.2f}, TypeDesc::UINT16), options), Metres({500, 1, 2, 2.5f}));
}

TEST_F(DepthTest, Errors) {
    DepthOptions options;
    const auto message = [&](const Picture& p) { return message_of([&] { metres(p, options); }); };
    EXPECT_NE(message(picture({0.5f, 1, 1, 1}, TypeDesc::UINT8)).find("`depth_range` NEAR,FAR"), std::string::npos);
    EXPECT_THROW(metres(picture({0.5f, 1, 1, 1}, TypeDesc::UINT16), options), UserError);
    EXPECT_NE(message(picture({-1, 2, -kInf, 1}, TypeDesc::FLOAT)).find("2 negative"), std::string::npos);
    EXPECT_NE(message(picture({0, 0, 0, 0}, TypeDesc::FLOAT)).find("only zeros"), std::string::npos);
    EXPECT_NE(message(picture({1, 2, 3}, TypeDesc::FLOAT)).find("3x1 pixels, the picture 4x1"), std::string::npos);
    options.channel = "depth.Q";
    EXPECT_NE(message(picture({1, 2, 3, 4}, TypeDesc::FLOAT)).find("no channel 'depth.Q'; it has Z"),
              std::string::npos);
    options.channel.clear();
    options.type = DepthType::Inverse;
    for (const auto& range : {std::array<double, 2>{0, 1}, {2, 2}, {-1, 3}, {1, std::nan("")}}) {
        options.range = range;
        EXPECT_THROW(check_depth_options(options), UserError);
    }
}

TEST_F(DepthTest, FindsItsChannelAndWindow) {
    DepthOptions options;
    const Metres values = {1, 2, 3, 4};
    EXPECT_EQ(metres(picture(values, TypeDesc::FLOAT, {"whatever"}), options), values);
    EXPECT_EQ(metres(picture({1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4}, TypeDesc::FLOAT, {"R", "G", "B"}), options), values);
    EXPECT_THROW(metres(picture({1, 1, 5, 2, 2, 2, 3, 3, 3, 4, 4, 4}, TypeDesc::FLOAT, {"R", "G", "B"}), options),
                 UserError);
    EXPECT_EQ(metres(picture({9, 1, 9, 2, 9, 3, 9, 4}, TypeDesc::FLOAT, {"A", "Depth"}), options), values);
    options.channel = "z";
    EXPECT_EQ(metres(picture(values, TypeDesc::FLOAT), options), values) << "case does not matter";
    options.channel = "far.Z";
    Picture parts = picture({9, 9, 9, 9}, TypeDesc::FLOAT);
    parts.parts.push_back(picture(values, TypeDesc::FLOAT).parts[0]);
    parts.parts[1].spec.attribute("name", "far");
    EXPECT_EQ(metres(parts, options), values);

    // Footage with overscan, depth without: what the map lacks is background.
    options = {};
    options.far = 77;
    const PixelWindow overscan{-1, -1, 6, 2};
    EXPECT_EQ(depth_from_picture(picture(values, TypeDesc::FLOAT), "d", options, overscan, window).metres,
              Metres({77, 77, 77, 77, 77, 77, 77, 1, 2, 3, 4, 77}));
    const float nan = std::nanf("");
    EXPECT_THROW(depth_from_picture(picture({nan, 0, nan, 0}, TypeDesc::FLOAT), "d", options, overscan, window),
                 FrameError);
}

TEST_F(DepthTest, MatteFromAFile) {
    Picture matte = picture({1, 0.5f, 1, 2, 1, -1, 1, 0}, TypeDesc::FLOAT, {"R", "A"});
    write_picture(folder / "m.exr", matte);
    EXPECT_EQ(read_matte(folder / "m.exr", "", window, window), Metres({0.5f, 1, 0, 0}));
    EXPECT_EQ(read_matte(folder / "m.exr", "R", window, window), Metres({1, 1, 1, 1}));
}

}  // namespace
}  // namespace eikonal
