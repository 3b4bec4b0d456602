#include <dlfcn.h>
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

constexpr const char* kInstalled = "share/eikonal/presets";
/// Number of folders between an installed file and the prefix, at most: bin, lib, lib/x86_64-linux-gnu.
constexpr int kDeepest = 2;

/// The file of the shared library that holds this code. The result is not reliable in a program that links it
/// statically.
fs::path own_file() {
    Dl_info info{};
    return dladdr(reinterpret_cast<const void*>(&list_presets), &info) != 0 && info.dli_fname ? info.dli_fname : "";
}

/// The folder of presets under the prefix that `file` is installed in; empty if there is none.
fs::path installed_beside(const fs::path& file) {
    std::error_code ignored;
    fs::path prefix = fs::absolute(file, ignored).parent_path();
    for (int i = 0; i < kDeepest; ++i) {
        prefix = prefix.parent_path();
        if (fs::is_directory(prefix / kInstalled, ignored)) return prefix / kInstalled;
    }
    return {};
}

fs::path presets_folder() {
    std::error_code ignored;
    if (const char* samples = std::getenv("EIKONAL_SAMPLES"); samples && *samples) {
        const fs::path folder = fs::path(samples) / "presets";
        if (!fs::is_directory(folder, ignored))
            throw UserError(fmt::format("EIKONAL_SAMPLES={}: there is no folder '{}'", samples, folder.string()));
        return folder;
    }
    for (const fs::path& file : {own_file(), fs::read_symlink("/proc/self/exe", ignored)})
        if (const fs::path folder = installed_beside(file); !folder.empty()) return folder;
    const fs::path built = fs::path(EIKONAL_SAMPLES_DIR) / "presets";
    if (fs::is_directory(built, ignored)) return built;
    throw UserError(fmt::format(
        "no presets: '{}' is no folder, and '{}' is in no folder above the program; set EIKONAL_SAMPLES to the samples "
        "folder",
        built.string(), kInstalled));
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
        scene_file::printable(fmt::format("`preset` {}: no such preset{}", name, scene_file::suggestion(name, valid))));
}

}  // namespace eikonal
