/// Finds the place in a scene that a message is about. The scene reader knows the places of its own errors. Code that
/// uses a scene after it has been read knows only keys; this adds the place.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace eikonal {

/// If the message begins with a key of the scene, "medium.0.source.1.rate = …", puts the place of that key before it:
/// "scene.toml:12: …". If a setting has given the key, the place is "`set` medium.0.source.1.rate=…: …". If the key is
/// left out, the place is that of the table it belongs to. Other messages are returned unchanged. file, settings: the
/// arguments of read_scene. Reads the file again. Never throws.
std::string with_place(std::string_view message, const std::filesystem::path& file,
                       const std::vector<std::string>& settings);

}  // namespace eikonal
