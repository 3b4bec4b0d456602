/// The setting `set`, KEY=VALUE: changes to a scene's tables before they are checked.
#pragma once

#include <toml++/toml.h>

#include <string>
#include <string_view>
#include <vector>

namespace eikonal::scene_file {

/// Deepest dotted key of a setting; scenes have four parts ("medium.0.falloff.length"), an element five.
inline constexpr std::size_t kDeepestKey = 8;

/// Applies one "key=value". The key is dotted, array elements count from 0, and tables, keys and the element after an
/// array's last are made where missing. The value is a TOML value, a bare word is text, and nothing removes the key.
/// Nodes made here name the option as their source. Throws UserError that starts with "`set` KEY=VALUE: ".
void apply_setting(toml::table& root, const std::string& setting);

/// The tables of a scene's text, which came from the file `name`, with the settings. Throws UserError.
toml::table parse_root(std::string_view text, const std::string& name, const std::vector<std::string>& settings);

}  // namespace eikonal::scene_file
