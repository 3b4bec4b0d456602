/// Makes a shot from options. `warp` and `map` do this before their first frame.
#pragma once

#include <filesystem>
#include <stop_token>
#include <vector>

#include "warp/app/options.h"
#include "warp/app/outputs.h"
#include "warp/shimmer/footage_shot.h"

namespace eikonal {

/// The scene file that the options name: a file, or that of a preset. Without either it is the preset `gentle`.
std::filesystem::path scene_file_of(const SceneOptions& options);
Scene load_scene(const SceneOptions& options);

/// The settings of a shot that the options state. Those of its footage are still to be set.
FootageShotSettings shot_settings(const ShotOptions& options, const RunOptions& run, const std::stop_token& stop);

/// Files that a shot reads in addition to the footage.
std::vector<NamedFiles> companions(const FootageShot& shot);

/// Reports on stderr what the user should know before `frames` are made: first notes, if `verbose`, then warnings.
/// Returns the warnings.
std::vector<std::string> announce(const FootageShot& shot, const std::vector<int>& frames, bool verbose);

/// Lines of the library, with the names of settings replaced by those of options.
std::vector<std::string> with_options(std::vector<std::string> lines);

}  // namespace eikonal
