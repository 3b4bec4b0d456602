#include "warp/app/shot_options.h"

#include <fmt/format.h>

#include "warp/program/option_names.h"

namespace eikonal {

std::filesystem::path scene_file_of(const SceneOptions& options) {
    return options.scene ? *options.scene : find_preset(options.preset.value_or("gentle"));
}

Scene load_scene(const SceneOptions& options) {
    return read_scene(scene_file_of(options), options.settings, options.seed);
}

FootageShotSettings shot_settings(const ShotOptions& options, const RunOptions& run, const std::stop_token& stop) {
    FootageShotSettings settings;
    settings.view.fov = options.scene.fov;
    settings.depth = options.depth;
    settings.strength = options.strength;
    settings.mask = options.mask;
    settings.state_errors = run.states_errors();
    settings.stop = stop;
    return settings;
}

std::vector<NamedFiles> companions(const FootageShot& shot) {
    std::vector<NamedFiles> files;
    if (const auto& scene = shot.shot().scene().file; !scene.empty())
        files.push_back({"the scene", FilePattern::parse(scene), true});
    if (shot.depth().files()) files.push_back({"--depth", *shot.depth().files()});
    if (shot.matte()) files.push_back({"--mask", shot.matte()->files()});
    return files;
}

std::vector<std::string> announce(const FootageShot& shot, const std::vector<int>& frames, bool verbose) {
    std::vector<std::string> warnings = with_options(shot.shot().warnings(frames));
    if (verbose)
        for (const std::string& note : with_options(shot.notes())) fmt::print(stderr, "eikonal: {}\n", note);
    for (const std::string& warning : warnings) fmt::print(stderr, "eikonal: warning: {}\n", warning);
    return warnings;
}

std::vector<std::string> with_options(std::vector<std::string> lines) {
    for (std::string& line : lines) line = with_options(std::string_view(line));
    return lines;
}

}  // namespace eikonal
