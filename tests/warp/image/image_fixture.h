/// What the tests of pictures share: a temporary folder, pictures made by OpenImageIO alone, and their comparison.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <functional>

#include "warp/image/channels.h"
#include "warp/image/picture.h"
#include "warp/image/pixel_codec.h"

namespace eikonal {

namespace fs = std::filesystem;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

class ImageTest : public testing::Test {
  protected:
    fs::path folder = fs::temp_directory_path() / ("eikonal-image-test-" + std::to_string(getpid()));
    void SetUp() override {
        fs::remove_all(folder);
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }
    std::size_t files() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
    }

    /// Writes a file with OpenImageIO alone, then the same through read_picture and write_picture, and compares.
    void expect_round_trip(const std::string& name, const std::vector<ImageSpec>& specs, bool lossy = false) {
        SCOPED_TRACE(name);
        const fs::path original = folder / ("in_" + name), copy = folder / ("out_" + name);
        write_reference(original, specs);
        const Picture picture = read_picture(original);
        ASSERT_EQ(picture.parts.size(), specs.size());
        write_picture(copy, picture);
        const Picture again = read_picture(copy);
        ASSERT_EQ(again.parts.size(), specs.size());
        EXPECT_EQ(again.format, picture.format);
        for (std::size_t i = 0; i < specs.size(); ++i) {
            const Part &a = picture.parts[i], &b = again.parts[i];
            expect_same_spec(a.spec, b.spec);
            if (!lossy) {
                EXPECT_EQ(a.pixels, b.pixels) << "part " << i;
            }
        }
    }

    static void expect_same_spec(const ImageSpec& a, const ImageSpec& b) {
        EXPECT_EQ(a.channelnames, b.channelnames);
        EXPECT_EQ(a.format, b.format);
        EXPECT_EQ(a.channelformats, b.channelformats);
        EXPECT_EQ(std::tie(a.x, a.y, a.width, a.height), std::tie(b.x, b.y, b.width, b.height));
        EXPECT_EQ(std::tie(a.full_x, a.full_y, a.full_width, a.full_height),
                  std::tie(b.full_x, b.full_y, b.full_width, b.full_height));
        EXPECT_EQ(std::tie(a.tile_width, a.tile_height), std::tie(b.tile_width, b.tile_height));
        for (const auto& attribute : a.extra_attribs) {
            const OIIO::ParamValue* other = b.find_attribute(attribute.name());
            ASSERT_NE(other, nullptr) << attribute.name();
            EXPECT_EQ(attribute.get_string(), other->get_string()) << attribute.name();
        }
    }

    /// Any bytes that are a valid picture: small values that differ from pixel to pixel and channel to channel.
    static std::vector<std::byte> content(const ImageSpec& spec) {
        std::vector<std::byte> pixels(spec.image_bytes(true));
        const std::size_t stride = spec.pixel_bytes(true);
        std::size_t offset = 0;
        for (int c = 0; c < spec.nchannels; ++c) {
            const TypeDesc type = spec.channelformat(c);
            for (std::size_t i = 0; i < spec.image_pixels(); ++i) {
                std::byte* at = pixels.data() + i * stride + offset;
                const auto code = static_cast<std::uint32_t>(i * 7 + static_cast<std::size_t>(c) * 1001);
                if (type == TypeDesc::UINT32)
                    std::memcpy(at, &code, 4);
                else {
                    const float value = static_cast<float>(code % 997) / 997.0f;
                    encode_values(static_cast<TypeDesc::BASETYPE>(type.basetype), &value, 1, at, stride, 1);
                }
            }
            offset += type.size();
        }
        return pixels;
    }

    static void write_reference(const fs::path& path, const std::vector<ImageSpec>& specs) {
        auto output = OIIO::ImageOutput::create(path.string());
        ASSERT_TRUE(output);
        const bool announced = specs.size() > 1 && !output->supports("appendsubimage");
        for (std::size_t i = 0; i < specs.size(); ++i) {
            ASSERT_TRUE(i > 0       ? output->open(path.string(), specs[i], OIIO::ImageOutput::AppendSubimage)
                        : announced ? output->open(path.string(), static_cast<int>(specs.size()), specs.data())
                                    : output->open(path.string(), specs[i]))
                << output->geterror();
            ASSERT_TRUE(output->write_image(TypeDesc::UNKNOWN, content(specs[i]).data())) << output->geterror();
        }
        ASSERT_TRUE(output->close());
    }

    static ImageSpec spec(int width, int height, std::vector<std::string> names, TypeDesc type) {
        ImageSpec s(width, height, static_cast<int>(names.size()), type);
        s.channelnames = std::move(names);
        s.alpha_channel = s.z_channel = -1;
        for (int c = 0; c < s.nchannels; ++c) {
            if (s.channelnames[static_cast<std::size_t>(c)] == "A") s.alpha_channel = c;
            if (s.channelnames[static_cast<std::size_t>(c)] == "Z") s.z_channel = c;
        }
        return s;
    }

    /// A part in memory with given channels, as if read from an EXR.
    static Part part_of(const ImageSpec& s, const std::string& format = "openexr") {
        Part part;
        part.spec = s;
        part.pixels = content(s);
        part.transfer = transfer_of(s, format);
        part.premultiplied = s.get_int_attribute("oiio:UnassociatedAlpha") == 0;
        classify_channels(part, format);
        return part;
    }

    static std::string message_of(const std::function<void()>& action) {
        try {
            action();
        } catch (const std::exception& error) {
            return error.what();
        }
        return "";
    }
};

}  // namespace eikonal
