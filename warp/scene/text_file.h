/// Whole text files, for the scene and the camera path.
#pragma once

#include <filesystem>
#include <string>

namespace eikonal::scene_file {

/// Largest file read [bytes]; what is larger is no scene or camera path but a slip of the hand.
inline constexpr std::size_t kLargestTextFile = std::size_t{64} << 20;

/// The file's bytes. kind: "scene", "camera path", for the message. Throws UserError: missing, unreadable, too large.
std::string read_text(const std::filesystem::path& file, const char* kind);

}  // namespace eikonal::scene_file
