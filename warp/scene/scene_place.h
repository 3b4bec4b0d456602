/// Where a scene states what a message is about, once it has been read: what reads scenes knows the place of what it
/// finds wrong itself, what uses them knows keys only.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace eikonal {

/// A message that begins with a scene's key, "medium.0.source.1.rate = …", with the place of that key before it:
/// "scene.toml:12: …", or "`set` medium.0.source.1.rate=…: …" where a setting has given it; of a key that is left out,
/// the place of what it belongs to. Any other message as it is. file, settings: as read_scene was given them. Reads
/// the file again; never throws.
std::string with_place(std::string_view message, const std::filesystem::path& file,
                       const std::vector<std::string>& settings);

}  // namespace eikonal
