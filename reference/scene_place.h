/// Where a scene file states a name of a file, for messages about what that file holds: the reader of scenes knows the
/// place of what it finds wrong itself, but forgets it. The file is read again, so ask only when something is wrong.
#pragma once

#include <filesystem>
#include <string>

#include "warp/scene/scene.h"

namespace eikonal::reference {

/// "scene.toml:12: object.0.file": where `key`, dotted, names `file`. Without the line where the scene's file is not
/// there or names another, which an option has then replaced; the key alone for a scene that is no file's.
std::string place_of(const Scene& scene, const std::string& key, const std::filesystem::path& file);

}  // namespace eikonal::reference
