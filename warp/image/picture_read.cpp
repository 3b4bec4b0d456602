#include <OpenImageIO/filesystem.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "noise/base/error.h"
#include "warp/image/channels.h"
#include "warp/image/file_error.h"
#include "warp/image/orientation.h"
#include "warp/image/picture.h"

namespace eikonal {
namespace fs = std::filesystem;
namespace {

constexpr const char* kTruncated = "the file is truncated; copy it again";

[[noreturn]] void refuse(const fs::path& path, const std::string& reason) {
    throw FrameError(fmt::format("cannot read '{}': {}", path.string(), reason));
}

/// The reason why the library cannot read the file. Its own text for files that end too early differs between formats.
[[noreturn]] void refuse_content(const fs::path& path, const std::string& said, std::string_view fallback) {
    for (const char* end : {"end of file", "premature end", "Read error at scanline", "incomplete"})
        if (OIIO::Strutil::icontains(said, end)) refuse(path, kTruncated);
    refuse(path, one_line(said, fallback) + "; it may be damaged or another kind of file");
}

void check_file(const fs::path& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) refuse(path, "no such file; check the name");
    if (fs::is_directory(status)) refuse(path, "it is a folder; name a file in it");
    if (!fs::is_regular_file(status)) refuse(path, "it is not a regular file; name a picture on a disk");
    if (fs::file_size(path, error) == 0) refuse(path, "the file is empty (0 bytes); copy it again");
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    if (!file) refuse(path, last_system_error());
}

/// Whether a JPEG has its end marker. libjpeg replaces missing data by grey and only warns, and OpenImageIO drops the
/// warning. This function therefore walks the segments itself. It skips lengths and searches coded data for FF D9.
bool jpeg_is_whole(const fs::path& path) {
    std::string bytes;
    if (!OIIO::Filesystem::read_text_file(path.string(), bytes)) return false;
    const auto at = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
    std::size_t i = 2;  // behind the start marker
    bool coded = false;
    while (i + 1 < bytes.size()) {
        if (at(i) != 0xff || at(i + 1) == 0xff) {
            ++i;
            continue;
        }
        const unsigned char marker = at(i + 1);
        const bool stuffed = marker == 0x00 || (marker >= 0xd0 && marker <= 0xd7) || marker == 0x01;
        if (coded && marker == 0xd9) return true;
        if (stuffed) {
            i += 2;
            continue;
        }
        if (marker == 0xd9 || i + 3 >= bytes.size()) return false;
        coded = coded || marker == 0xda;
        i += 2 + at(i + 2) * 256u + at(i + 3);
    }
    return false;
}

/// Whether a PNG has its end chunk. True for other files. libpng would tell, but it prints on stderr even when it opens
/// a file.
bool png_is_whole(const fs::path& path) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    constexpr long kSignature = 8, kChecksum = 4;
    unsigned char head[8];  // the signature; then length, big-endian, and type of a chunk
    if (!file || std::fread(head, 1, 8, file.get()) != 8 || std::memcmp(head, "\x89PNG\r\n\x1a\n", 8) != 0) return true;
    long at = kSignature;
    while (std::fseek(file.get(), at, SEEK_SET) == 0 && std::fread(head, 1, 8, file.get()) == 8) {
        if (std::memcmp(head + 4, "IEND", 4) == 0) return true;
        at += 8 + kChecksum + ((long{head[0]} << 24) | (long{head[1]} << 16) | (long{head[2]} << 8) | long{head[3]});
    }
    return false;
}

/// What this library does not handle.
void check_kind(const fs::path& path, const OIIO::ImageSpec& spec) {
    if (spec.deep) refuse(path, "deep pictures are not supported; flatten it first");
    if (spec.depth > 1) refuse(path, fmt::format("volume pictures are not supported (depth {})", spec.depth));
    if (OIIO::Strutil::icontains(spec.get_string_attribute("textureformat"), "cubeface"))
        refuse(path, "cube maps are not supported; convert it to a plain picture");
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1)
        refuse(path, fmt::format("it has no pixels ({}x{}, {} channels)", spec.width, spec.height, spec.nchannels));
}

/// Whether the first and the last row or tile of the part at hand can be decoded.
bool ends_are_readable(OIIO::ImageInput& input, int index) {
    const OIIO::ImageSpec spec = input.spec();
    const bool tiled = spec.tile_width > 0;
    const int wide = tiled ? spec.tile_width : spec.width, high = tiled ? spec.tile_height : 1;
    std::vector<std::byte> pixels(static_cast<std::size_t>(wide) * static_cast<std::size_t>(high) *
                                  spec.pixel_bytes(true));
    const auto read_at = [&](int column, int row) {  // from the data window's corner, in tiles if there are tiles
        const int x = spec.x + column * wide, y = spec.y + row * high;
        const int x_end = std::min(x + wide, spec.x + spec.width), y_end = std::min(y + high, spec.y + spec.height);
        constexpr auto kNative = OIIO::TypeDesc::UNKNOWN;
        return tiled ? input.read_tiles(index, 0, x, x_end, y, y_end, 0, 1, 0, spec.nchannels, kNative, pixels.data())
                     : input.read_scanlines(index, 0, y, y_end, 0, 0, spec.nchannels, kNative, pixels.data());
    };
    return read_at(0, 0) && read_at((spec.width - 1) / wide, (spec.height - 1) / high);
}

enum class Wanted { Header, Ends, Pixels };

Picture read(const fs::path& path, Wanted wanted) {
    check_file(path);
    if (!png_is_whole(path)) refuse(path, kTruncated);
    OIIO::ImageSpec hints;
    hints["oiio:UnassociatedAlpha"] = 1;  // raw codes: load_group premultiplies in linear light
    const auto input = OIIO::ImageInput::open(path.string(), &hints);
    if (!input) refuse_content(path, OIIO::geterror(), "not an image file");

    Picture picture;
    picture.format = input->format_name();
    const bool marked = picture.format == "jpeg" || picture.format == "png";
    if (wanted != Wanted::Header && picture.format == "jpeg" && !jpeg_is_whole(path)) refuse(path, kTruncated);
    for (int index = 0; input->seek_subimage(index, 0); ++index) {
        Part& part = picture.parts.emplace_back();
        part.spec = input->spec();
        check_kind(path, part.spec);
        for (const char* level : {"openexr:levelmode", "openexr:roundingmode"}) part.spec.erase_attribute(level);
        if (part.spec.get_string_attribute("textureformat") == "Plain Texture")
            part.spec.erase_attribute("textureformat");
        part.transfer = transfer_of(part.spec, picture.format);
        part.premultiplied = part.spec.get_int_attribute("oiio:UnassociatedAlpha") == 0;
        classify_channels(part, picture.format);
        if (wanted == Wanted::Ends && !marked && !ends_are_readable(*input, index))
            refuse_content(path, input->geterror(), "the pixels are unreadable");
        if (wanted == Wanted::Pixels) {
            part.pixels.resize(part.spec.image_bytes(true));
            if (!input->read_image(index, 0, 0, part.spec.nchannels, OIIO::TypeDesc::UNKNOWN, part.pixels.data()))
                refuse_content(path, input->geterror(), "the pixels are unreadable");
        }
        if (may_lie_turned(picture.format)) turn_upright(part);
    }
    if (picture.parts.empty()) refuse_content(path, input->geterror(), "it holds no picture");
    input->close();
    return picture;
}

}  // namespace

Picture read_picture(const fs::path& path) {
    return read(path, Wanted::Pixels);
}
Picture read_picture_header(const fs::path& path) {
    return read(path, Wanted::Header);
}
Picture read_picture_ends(const fs::path& path) {
    return read(path, Wanted::Ends);
}

PixelWindow data_window(const Part& part) {
    return {part.spec.x, part.spec.y, part.spec.width, part.spec.height};
}

PixelWindow display_window(const Part& part) {
    const OIIO::ImageSpec& spec = part.spec;
    if (spec.full_width < 1 || spec.full_height < 1) return data_window(part);
    return {spec.full_x, spec.full_y, spec.full_width, spec.full_height};
}

double pixel_aspect(const Part& part) {
    const double aspect = part.spec.get_float_attribute("PixelAspectRatio", 1.0f);
    return std::isfinite(aspect) && aspect > 0 ? aspect : 1.0;
}

}  // namespace eikonal
