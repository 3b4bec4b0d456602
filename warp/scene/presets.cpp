#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "noise/base/error.h"
#include "warp/scene/message.h"
#include "warp/scene/scene.h"

namespace eikonal {

namespace {

namespace fs = std::filesystem;

fs::path presets_folder() {
    std::error_code ignored;
    if (const char* samples = std::getenv("EIKONAL_SAMPLES"); samples && *samples) {
        const fs::path folder = fs::path(samples) / "presets";
        if (!fs::is_directory(folder, ignored))
            throw UserError(fmt::format("EIKONAL_SAMPLES={}: there is no folder '{}'", samples, folder.string()));
        return folder;
    }
    const fs::path built = fs::path(EIKONAL_SAMPLES_DIR) / "presets";
    if (fs::is_directory(built, ignored)) return built;
    const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
    const fs::path installed = program.parent_path().parent_path() / "share/eikonal/presets";
    if (fs::is_directory(installed, ignored)) return installed;
    throw UserError(
        fmt::format("no presets: neither '{}' nor '{}' is a folder; set EIKONAL_SAMPLES to the samples folder",
                    built.string(), installed.string()));
}

std::string first_comment(const fs::path& file) {
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    const std::size_t begin = line.find_first_not_of("# \t");
    return line.starts_with('#') && begin != std::string::npos ? scene_file::printable(line.substr(begin)) : "";
}

}  // namespace

std::vector<Preset> list_presets() {
    std::vector<Preset> presets;
    for (const fs::directory_entry& entry : fs::directory_iterator(presets_folder()))
        if (entry.path().extension() == ".toml")
            presets.push_back({entry.path().stem().string(), first_comment(entry.path()), entry.path()});
    std::sort(presets.begin(), presets.end(), [](const Preset& a, const Preset& b) { return a.name < b.name; });
    return presets;
}

fs::path find_preset(const std::string& name) {
    const std::vector<Preset> presets = list_presets();
    for (const Preset& preset : presets)
        if (preset.name == name) return preset.file;
    const std::vector<std::string_view> valid = [&] {
        std::vector<std::string_view> names;
        for (const Preset& preset : presets) names.push_back(preset.name);
        return names;
    }();
    throw UserError(
        scene_file::printable(fmt::format("--preset {}: no such preset{}", name, scene_file::suggestion(name, valid))));
}

}  // namespace eikonal
