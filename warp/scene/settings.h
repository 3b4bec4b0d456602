/// The setting `set`, KEY=VALUE: changes to a scene's tables before they are checked.
#pragma once

#include <toml++/toml.h>

#include <string>
#include <string_view>
#include <vector>

namespace eikonal::scene_file {

/// Largest number of parts of a setting's dotted key. Scenes need four ("medium.0.falloff.length"), an element five.
inline constexpr std::size_t kDeepestKey = 8;

/// Applies one "key=value". The key is dotted, and array elements count from 0. Missing tables and keys are made, and
/// so is the element after an array's last. The value is TOML; a bare word is text; an empty value removes the key.
/// Nodes made here name the option as their source. UserError that begins with "`set` KEY=VALUE: ".
void apply_setting(toml::table& root, const std::string& setting);

/// The tables of a scene's text, with the settings applied. The text came from the file `name`. UserError.
toml::table parse_root(std::string_view text, const std::string& name, const std::vector<std::string>& settings);

}  // namespace eikonal::scene_file
