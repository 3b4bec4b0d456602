/// From options to a shot: what `warp` and `map` do before their first frame.
#pragma once

#include <filesystem>
#include <stop_token>
#include <vector>

#include "warp/app/options.h"
#include "warp/app/outputs.h"
#include "warp/shimmer/footage_shot.h"

namespace eikonal {

/// The scene that the options name: a file, a preset, or the preset `gentle`.
std::filesystem::path scene_file_of(const SceneOptions& options);
Scene load_scene(const SceneOptions& options);

/// The settings of a shot that options state; those of its footage are still to be set.
FootageShotSettings shot_settings(const ShotOptions& options, const RunOptions& run, const std::stop_token& stop);

/// Files that a shot reads beside the footage.
std::vector<NamedFiles> companions(const FootageShot& shot);

/// Tells on stderr what the user should know before `frames` are made: warnings, which are returned, and before them,
/// if `verbose`, notes.
std::vector<std::string> announce(const FootageShot& shot, const std::vector<int>& frames, bool verbose);

/// Lines of the library with its settings spelled as options.
std::vector<std::string> with_options(std::vector<std::string> lines);

}  // namespace eikonal
