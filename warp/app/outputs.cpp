#include "warp/app/outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "noise/error.h"

namespace eikonal {
namespace {

/// A path that two names of the same file share, whether or not it exists.
std::filesystem::path identity(const std::filesystem::path& file) {
    std::error_code ignored;
    const auto path = std::filesystem::weakly_canonical(std::filesystem::absolute(file), ignored);
    return ignored ? std::filesystem::absolute(file).lexically_normal() : path;
}

}  // namespace

void Outputs::add(const std::string& option, const std::filesystem::path& path, bool movies) {
    Output output{option, FilePattern::parse(path), is_movie(path)};
    if (path.empty() || path.filename().empty()) throw UserError(fmt::format("{}: '{}' is no file name", option, path.string()));
    if (output.movie && !movies)
        throw UserError(fmt::format("{}: '{}' is a movie, which cannot hold float maps; write a sequence like '{}'", option, path.string(),
                                    (path.parent_path() / (path.stem().string() + ".####.exr")).string()));
    if (!movies && path.extension() != ".exr")
        throw UserError(fmt::format("{}: '{}' must be an EXR, whose floats hold the map exactly; name it '{}'", option, path.string(),
                                    std::filesystem::path(path).replace_extension(".exr").string()));
    const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored))
        throw UserError(fmt::format("{}: the folder '{}' does not exist; make it first", option, folder.string()));
    if (std::filesystem::is_directory(path, ignored))
        throw UserError(fmt::format("{}: '{}' is a folder; name a file in it", option, path.string()));
    outputs_.push_back(std::move(output));
}

void Outputs::check(const std::vector<int>& frames, const std::vector<FilePattern>& inputs) const {
    for (const Output& output : outputs_)
        if (!output.movie && !output.files.is_sequence() && frames.size() > 1)
            throw UserError(fmt::format("{}: '{}' names one file for {} frames; put #### where the frame number goes, e.g. '{}'", output.option,
                                        output.files.text().string(), frames.size(),
                                        (output.files.text().parent_path() / (output.files.text().stem().string() + ".####" +
                                                                              output.files.text().extension().string())).string()));
    // Only names in a folder that an input also lives in can collide; links are followed.
    std::map<std::filesystem::path, std::string> taken;
    const auto claim = [&](const std::filesystem::path& file, const std::string& who) {
        const auto [other, fresh] = taken.emplace(identity(file), who);
        if (fresh || other->second == who) return;
        throw UserError(fmt::format("{} and {} are the same file, '{}'; give the output another name", other->second, who, file.string()));
    };
    for (const FilePattern& input : inputs) {
        if (!input.is_sequence()) claim(input.text(), "the input");
        else
            for (const int frame : frames) claim(input.at(frame), "the input");
    }
    for (const Output& output : outputs_) {
        if (!output.files.is_sequence()) claim(output.files.text(), output.option);
        else
            for (const int frame : frames) claim(output.at(frame), output.option);
    }
}

bool Outputs::finished(int frame) const {
    std::error_code ignored;
    return std::all_of(outputs_.begin(), outputs_.end(),
                       [&](const Output& o) { return std::filesystem::exists(o.at(frame), ignored); });
}

const Output* Outputs::find(const std::string& option) const {
    for (const Output& output : outputs_)
        if (output.option == option) return &output;
    return nullptr;
}

}  // namespace eikonal
