#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>
#include <fmt/format.h>

#include <memory>

#include "noise/error.h"
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

/// What the library says, which names the temporary, as one line that names the file.
std::string reason(const OIIO::ImageOutput& output, const std::string& temporary, const fs::path& path,
                   std::string_view fallback) {
    return one_line(OIIO::Strutil::replace(output.geterror(), temporary, path.string(), true), fallback);
}

/// Opens, writes every part, closes.
void write_parts(OIIO::ImageOutput& output, const std::string& name, const fs::path& path, const Picture& picture) {
    std::vector<OIIO::ImageSpec> specs;
    for (const Part& part : picture.parts) {
        OIIO::ImageSpec& spec = specs.emplace_back(part.spec);
        // Where there is no date, OpenImageIO would put today's: the same frame would not be the same bytes tomorrow.
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

/// Formats that do not write through a proxy hide errors; reading the file back shows them.
void verify(const fs::path& temporary, const fs::path& path) {
    try {
        read_picture(temporary);
    } catch (const FrameError&) {
        refuse(path, "it did not reach the disk whole; is the disk full?");
    }
}

}  // namespace

bool can_write_picture(const fs::path& path) {
    const bool known = OIIO::ImageOutput::create(path.string()) != nullptr;
    OIIO::geterror();  // clears the thread's message
    return known;
}

void write_picture(const fs::path& path, const Picture& picture) {
    if (picture.parts.empty()) refuse(path, "there is nothing to write");
    AtomicFile file(path);
    const std::string name = file.temporary().string();
    const auto output = OIIO::ImageOutput::create(name);
    if (!output) {
        OIIO::geterror();  // clears the thread's message, which names the temporary
        refuse(path, fmt::format("no image format has the extension '{}'", path.extension().string()));
    }
    // OpenImageIO's TIFF writer goes back to its directories by reading, which it cannot do through a proxy.
    if (output->supports("ioproxy") && std::string_view(output->format_name()) != "tiff") {
        CheckedOutput checked(file.temporary(), path);
        output->set_ioproxy(&checked);
        write_parts(*output, name, path, picture);
        checked.finish();
    } else {
        write_parts(*output, name, path, picture);
        verify(file.temporary(), path);
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
    OIIO::attribute("exr_threads", threads > 1 ? threads : -1);  // -1: in the calling thread; a pool of one would wait
}

}  // namespace eikonal
