#include "warp/scene/text_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <system_error>

#include "noise/base/error.h"

namespace eikonal::scene_file {

std::string read_text(const std::filesystem::path& file, const char* kind) {
    const auto refuse = [&](const std::string& reason) {
        throw UserError(fmt::format("{}: cannot read the {}: {}", file.string(), kind, reason));
    };
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(file, ignored);
    if (std::filesystem::is_directory(status)) refuse("it is a folder");
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        refuse("it is not a regular file");
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    if (!stream) refuse(std::generic_category().message(errno ? errno : ENOENT));
    std::string text;
    char block[1 << 14];
    while (stream.read(block, sizeof block) || stream.gcount() > 0) {
        text.append(block, static_cast<std::size_t>(stream.gcount()));
        if (text.size() > kLargestTextFile) refuse(fmt::format("it is larger than {} MiB", kLargestTextFile >> 20));
    }
    if (stream.bad()) refuse("reading stopped in the middle");
    return text;
}

}  // namespace eikonal::scene_file
