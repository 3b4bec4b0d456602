/// Whole text files, for the scene and the camera path.
#pragma once

#include <filesystem>
#include <string>

namespace eikonal::scene_file {

/// Largest file that is read [bytes]. A larger file is neither a scene nor a camera path, but named by mistake.
inline constexpr std::size_t kLargestTextFile = std::size_t{64} << 20;

/// The file's bytes. kind: "scene" or "camera path", for the message. UserError: missing, unreadable, too large.
std::string read_text(const std::filesystem::path& file, const char* kind);

}  // namespace eikonal::scene_file
