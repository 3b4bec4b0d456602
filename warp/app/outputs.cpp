#include "warp/app/outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "noise/error.h"
#include "warp/image/movie_writer.h"
#include "warp/image/picture.h"

namespace eikonal {
namespace fs = std::filesystem;
namespace {

/// A path that two names of the same file share, whether or not it exists; links are followed.
fs::path identity(const fs::path& file) {
    std::error_code ignored;
    const auto path = fs::weakly_canonical(fs::absolute(file), ignored);
    return ignored ? fs::absolute(file).lexically_normal() : path;
}

/// "plate.####.exr" for "plate.exr".
std::string numbered(const fs::path& path, const std::string& extension) {
    return (path.parent_path() / (path.stem().string() + ".####" + extension)).string();
}

void check_format(const std::string& option, const fs::path& path, OutputKind kind) {
    if (kind == OutputKind::Report) return;
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (kind == OutputKind::Maps) {
        if (is_movie(path))
            throw UserError(fmt::format("{}: '{}' is a movie, which cannot hold float maps; write a sequence like '{}'",
                                        option, path.string(), numbered(path, ".exr")));
        if (extension != ".exr")
            throw UserError(fmt::format("{}: '{}' must be an EXR, whose floats hold the map exactly; name it '{}'",
                                        option, path.string(), fs::path(path).replace_extension(".exr").string()));
    } else if (is_movie(path) ? !is_movie_name(path) : !can_write_picture(path)) {
        throw UserError(fmt::format(
            "{}: '{}': no format that can be written has the extension '{}'; use .exr, .png, .tif, .jpg, .dpx, "
            ".mp4, .mov, .mkv, .avi or .webm",
            option, path.string(), extension));
    }
}

}  // namespace

void Outputs::add(const std::string& option, const fs::path& path, OutputKind kind) {
    if (path.filename().empty() || path.filename() == "." || path.filename() == "..")
        throw UserError(fmt::format("{}: '{}' is no file name", option, path.string()));
    std::error_code ignored;
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, ignored))
        throw UserError(fmt::format("{}: the folder '{}' does not exist; make it first", option, folder.string()));
    if (fs::is_directory(path, ignored))
        throw UserError(fmt::format("{}: '{}' is a folder; name a file in it", option, path.string()));
    if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))
        throw UserError(fmt::format("{}: '{}' is not a regular file; name one in a folder", option, path.string()));
    check_format(option, path, kind);
    const bool single = kind == OutputKind::Report || (kind == OutputKind::Pictures && is_movie(path));
    outputs_.push_back({{option, FilePattern::parse(path), single}, kind});
}

void Outputs::check(const std::vector<int>& frames, const std::vector<NamedFiles>& inputs) const {
    for (const Output& output : outputs_)
        if (!output.single && !output.files.is_sequence() && frames.size() > 1)
            throw UserError(
                fmt::format("{}: '{}' names one file for {} frames; put #### where the frame number goes, e.g. '{}'",
                            output.option, output.files.text().string(), frames.size(),
                            numbered(output.files.text(), output.files.text().extension().string())));
    std::map<fs::path, std::string> taken;
    const auto claim = [&](const fs::path& file, const std::string& who, bool written) {
        const auto [other, fresh] = taken.emplace(identity(file), who);
        if (fresh || !written || other->second == who) return;
        throw UserError(fmt::format("{} and {} are the same file, '{}'; give the output another name", other->second,
                                    who, file.string()));
    };
    const auto claim_all = [&](const NamedFiles& named, bool written) {
        if (named.single || !named.files.is_sequence()) {
            claim(named.files.text(), named.option, written);
            return;
        }
        std::set<int> numbers(frames.begin(), frames.end());
        if (!written) {  // frames that are not asked for must not be lost either
            const std::vector<int> all = named.files.find_frames();
            numbers.insert(all.begin(), all.end());
        }
        for (const int number : numbers) claim(named.at(number), named.option, written);
    };
    for (const NamedFiles& input : inputs) claim_all(input, false);
    for (const Output& output : outputs_) claim_all(output, true);
}

bool Outputs::finished(int frame) const {
    std::error_code ignored;
    return std::all_of(outputs_.begin(), outputs_.end(), [&](const Output& o) {
        return o.kind == OutputKind::Report ||
               (fs::is_regular_file(o.at(frame), ignored) && fs::file_size(o.at(frame), ignored) > 0);
    });
}

std::size_t Outputs::keep_finished(std::vector<int>& frames) const {
    const std::size_t kept = std::erase_if(frames, [&](int frame) { return finished(frame); });
    if (kept > 0)
        fmt::print(stderr, "eikonal: {} frame{} already there and kept; --overwrite makes them anew\n", kept,
                   kept == 1 ? " is" : "s are");
    return kept;
}

const NamedFiles* Outputs::find(const std::string& option) const {
    for (const Output& output : outputs_)
        if (output.option == option) return &output;
    return nullptr;
}

}  // namespace eikonal
