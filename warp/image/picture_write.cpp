#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <optional>

#include "noise/base/error.h"
#include "warp/image/atomic_file.h"
#include "warp/image/checked_output.h"
#include "warp/image/file_error.h"
#include "warp/image/picture.h"

namespace eikonal {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse(const fs::path& path, const std::string& reason) {
    throw FrameError(fmt::format("cannot write '{}': {}", path.string(), reason));
}

/// The library's message as one line. It names the temporary file, which is replaced by the final name.
std::string reason(const OIIO::ImageOutput& output, const std::string& temporary, const fs::path& path,
                   std::string_view fallback) {
    return one_line(OIIO::Strutil::replace(output.geterror(), temporary, path.string(), true), fallback);
}

/// OpenImageIO chooses between PPM and PGM by the channels, whatever the extension is.
void check_pnm(const OIIO::ImageOutput& output, const fs::path& path, const Picture& picture) {
    if (std::string_view(output.format_name()) != "pnm") return;
    const std::string extension = OIIO::Strutil::lower(path.extension().string());
    const int channels = picture.parts.front().spec.nchannels;
    if (extension == ".pgm" && channels > 1) refuse(path, "a .pgm is grey, and the picture has colour; name it .ppm");
    if (extension == ".ppm" && channels == 1)
        refuse(path, "a .ppm has three channels, and the picture is grey; name it .pgm");
}

/// Opens, writes every part, closes.
void write_parts(OIIO::ImageOutput& output, const std::string& name, const fs::path& path, const Picture& picture) {
    std::vector<OIIO::ImageSpec> specs;
    for (const Part& part : picture.parts) {
        OIIO::ImageSpec& spec = specs.emplace_back(part.spec);
        // OpenImageIO would add today's date where there is none. The same frame would then not give the same bytes.
        if (spec.find_attribute("DateTime") == nullptr) spec.attribute("DateTime", "");
    }
    const bool many = specs.size() > 1;
    if (many && !output.supports("multiimage"))
        refuse(path, fmt::format("format '{}' holds one picture, not {}", output.format_name(), specs.size()));
    const bool announced = many && !output.supports("appendsubimage");

    for (std::size_t i = 0; i < specs.size(); ++i) {
        const bool opened = i > 0       ? output.open(name, specs[i], OIIO::ImageOutput::AppendSubimage)
                            : announced ? output.open(name, static_cast<int>(specs.size()), specs.data())
                                        : output.open(name, specs[i]);
        if (!opened || !output.write_image(OIIO::TypeDesc::UNKNOWN, picture.parts[i].pixels.data()))
            refuse(path, reason(output, name, path, "the format cannot hold this picture"));
    }
    if (!output.close()) refuse(path, reason(output, name, path, "closing failed"));
}

/// The system's reason why no more can be written to the end of a file. Empty if more can be written.
std::string growth_error(const fs::path& file) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "ab"), std::fclose);
    const std::vector<char> block(std::size_t{1} << 20);
    errno = 0;
    const bool grows = stream && std::fwrite(block.data(), 1, block.size(), stream.get()) == block.size() &&
                       std::fflush(stream.get()) == 0;
    return grows ? "" : last_system_error();
}

/// Formats that do not write through a proxy hide errors, or report them without the system's reason. Reading the file
/// back reveals the former. An attempt to write more reveals the latter.
void write_and_verify(OIIO::ImageOutput& output, const fs::path& temporary, const fs::path& path,
                      const Picture& picture) {
    bool written = false;
    try {
        write_parts(output, temporary.string(), path, picture);
        written = true;
        read_picture(temporary);
    } catch (const FrameError&) {
        if (const std::string full = growth_error(temporary); !full.empty()) refuse(path, full);
        if (written) refuse(path, "it did not reach the disk whole");
        throw;
    }
}

}  // namespace

bool can_write_picture(const fs::path& path) {
    const auto output = OIIO::ImageOutput::create(path.string());
    OIIO::geterror();  // clears the thread's message
    if (!output) return false;
    // GIF's 256 colours and PBM's two cannot hold a frame of footage. The others are not files.
    const std::string_view name = output->format_name();
    return name != "gif" && name != "term" && name != "null" &&
           !OIIO::Strutil::iequals(path.extension().string(), ".pbm");
}

void write_picture(const fs::path& path, const Picture& picture) {
    if (picture.parts.empty()) refuse(path, "there is nothing to write");
    AtomicFile file(path);
    const std::string name = file.temporary().string();
    std::optional<CheckedOutput> checked;  // outlives the output, which may still write when it is destroyed
    const auto output = OIIO::ImageOutput::create(name);
    if (!output) {
        OIIO::geterror();  // clears the thread's message, which names the temporary file
        refuse(path, fmt::format("no image format has the extension '{}'", path.extension().string()));
    }
    check_pnm(*output, path, picture);
    // OpenImageIO's TIFF writer reads its directories back, which it cannot do through a proxy.
    if (output->supports("ioproxy") && std::string_view(output->format_name()) != "tiff") {
        checked.emplace(file.temporary(), path);
        output->set_ioproxy(&*checked);
        try {
            write_parts(*output, name, path, picture);
        } catch (const FrameError&) {
            checked->finish();  // reports the system's reason, if there is one
            throw;
        }
        checked->finish();
    } else {
        write_and_verify(*output, file.temporary(), path, picture);
    }
    file.commit();
}

void write_float_exr(const fs::path& path, const PixelWindow& data, const PixelWindow& display,
                     std::span<const std::string> channel_names, std::span<const float> interleaved,
                     std::span<const Attribute> attributes) {
    if (interleaved.size() != data.area() * channel_names.size())
        throw std::logic_error("write_float_exr: the values do not fill the data window");
    Picture picture;
    picture.format = "openexr";
    Part& part = picture.parts.emplace_back();
    OIIO::ImageSpec& spec = part.spec;
    spec = OIIO::ImageSpec(data.width, data.height, static_cast<int>(channel_names.size()), OIIO::TypeDesc::FLOAT);
    spec.x = data.x0;
    spec.y = data.y0;
    spec.full_x = display.x0;
    spec.full_y = display.y0;
    spec.full_width = display.width;
    spec.full_height = display.height;
    spec.channelnames.assign(channel_names.begin(), channel_names.end());
    spec.alpha_channel = spec.z_channel = -1;
    spec.attribute("compression", "zip");
    for (const auto& [key, value] : attributes) {
        if (const auto* text = std::get_if<std::string>(&value))
            spec.attribute(key, *text);
        else
            spec.attribute(key, static_cast<float>(std::get<double>(value)));
    }
    const auto bytes = std::as_bytes(interleaved);
    part.pixels.assign(bytes.begin(), bytes.end());
    write_picture(path, picture);
}

void set_image_threads(int threads) {
    OIIO::attribute("threads", threads);
    OIIO::attribute("exr_threads",
                    threads > 1 ? threads : -1);  // -1: in the calling thread, since a pool of one would wait
}

}  // namespace eikonal
