#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "noise/base/error.h"
#include "warp/image/channels.h"
#include "warp/image/picture.h"

namespace eikonal {
namespace fs = std::filesystem;
namespace {

using OIIO::TypeDesc;

/// The abilities of a writable format.
struct Format {
    std::string name;
    bool windows;  ///< holds a data window apart from the display window
    bool alpha;
    bool linear_float;  ///< holds linear light in float types
    bool sixteen_bits;
    bool associated;  ///< its alpha is associated. The standards of all others ask for unassociated alpha.
};

Format format_for(const fs::path& path) {
    const auto output = OIIO::ImageOutput::create(path.string());
    if (!output) {
        OIIO::geterror();
        throw FrameError(fmt::format("cannot write '{}': no image format has the extension '{}'", path.string(),
                                     path.extension().string()));
    }
    Format format;
    format.name = output->format_name();
    format.windows = format.name == "openexr";  // DPX claims windows, but pads
    format.alpha = output->supports("alpha") != 0;
    format.linear_float = format.name == "openexr" || format.name == "hdr";
    format.sixteen_bits = format.name == "png" || format.name == "tiff" || format.name == "dpx" ||
                          format.name == "jpeg2000" || format.name == "pnm" || format.name == "sgi";
    format.associated =
        format.name != "png" && format.name != "tiff" && format.name != "targa" && format.name != "webp";
    return format;
}

TypeDesc type_for(const Format& format, int source_bits) {
    if (format.name == "hdr") return TypeDesc::FLOAT;
    if (format.linear_float) return source_bits > 16 ? TypeDesc::FLOAT : TypeDesc::HALF;
    if (format.name == "dpx") return TypeDesc::UINT16;
    return format.sixteen_bits && source_bits > 8 ? TypeDesc::UINT16 : TypeDesc::UINT8;
}

/// One part of `colours` colour channels (1 or 3) in the given format.
Picture encode(const LinearImage& source, const Format& format, int colours, bool with_alpha, int source_bits) {
    const LinearImage padded =
        format.windows || source.data == source.display ? LinearImage{} : cropped(source, source.display);
    const LinearImage& image = padded.pixels.empty() ? source : padded;

    Picture picture;
    picture.format = format.name;
    Part& part = picture.parts.emplace_back();
    OIIO::ImageSpec& spec = part.spec;
    const bool alpha = with_alpha && format.alpha;
    spec =
        OIIO::ImageSpec(image.data.width, image.data.height, colours + (alpha ? 1 : 0), type_for(format, source_bits));
    if (format.windows) {
        spec.x = image.data.x0;
        spec.y = image.data.y0;
        spec.full_x = image.display.x0;
        spec.full_y = image.display.y0;
        spec.full_width = image.display.width;
        spec.full_height = image.display.height;
    }
    spec.channelnames = colours == 1 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
    spec.alpha_channel = -1;
    if (alpha) {
        spec.channelnames.push_back("A");
        spec.alpha_channel = colours;
        if (!format.associated) spec.attribute("oiio:UnassociatedAlpha", 1);
    }
    if (format.name == "openexr") spec.attribute("compression", "zip");
    if (image.pixel_aspect != 1) spec.attribute("PixelAspectRatio", static_cast<float>(image.pixel_aspect));
    spec.attribute("oiio:ColorSpace", format.linear_float ? "Linear" : "sRGB");
    part.transfer = format.linear_float ? Transfer::Linear : Transfer::SRGB;
    part.premultiplied = format.associated || !alpha;
    classify_channels(part, format.name);
    part.pixels.resize(spec.image_bytes(true));
    const std::vector<std::uint8_t> all(image.data.area(), 1);
    store_group(part, part.groups.at(0), image, all);
    return picture;
}

/// Metadata about the storage in the old format. They would mean nothing, or something wrong, in another format.
bool about_storage(OIIO::string_view name) {
    for (const char* prefix :
         {"oiio:", "openexr:", "png:", "tiff:", "jpeg:", "dpx:", "bmp:", "targa:", "hdr:", "webp:"})
        if (OIIO::Strutil::istarts_with(name, prefix)) return true;
    for (const char* whole : {"compression", "CompressionQuality", "PixelAspectRatio", "name", "textureformat",
                              "wrapmodes", "XResolution", "YResolution", "ResolutionUnit", "planarconfig"})
        if (OIIO::Strutil::iequals(name, whole)) return true;
    return false;
}

int bits_of(const Part& part, const ChannelGroup& group) {
    const int channel = group.count > 0 ? group.channel[0] : group.alpha;
    const TypeDesc type = part.spec.channelformat(channel);
    if (type == TypeDesc::HALF) return 16;
    // 16-bit codes in linear light need more than a half's 11 bits.
    return type.size() == 1 ? 8 : type == TypeDesc::UINT16 ? 17 : 32;
}

}  // namespace

Picture picture_from_linear(const LinearImage& image, const fs::path& for_file, bool with_alpha, int source_bits) {
    return encode(image, format_for(for_file), 3, with_alpha, source_bits);
}

Picture picture_for_format(Picture picture, const fs::path& for_file) {
    const Format format = format_for(for_file);
    if (format.name == picture.format) return picture;
    for (const Part& part : picture.parts) {
        if (part.groups.empty() || part.groups[0].count == 0) continue;
        const ChannelGroup& group = part.groups[0];
        Picture result =
            encode(load_group(part, group), format, group.count == 1 ? 1 : 3, group.alpha >= 0, bits_of(part, group));
        for (const auto& attribute : part.spec.extra_attribs)
            if (!about_storage(attribute.name())) result.parts[0].spec.extra_attribs.push_back(attribute);
        return result;
    }
    throw FrameError(fmt::format("cannot write '{}': the picture holds no colour that '{}' could keep",
                                 for_file.string(), format.name));
}

}  // namespace eikonal
