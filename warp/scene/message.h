/// Text of messages to the user.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace eikonal::scene_file {

/// Longest value or name that a message repeats in full [bytes].
inline constexpr std::size_t kLongestShown = 60;

/// Control characters (which quoted TOML keys may hold) become '?', so that a message stays one line.
std::string printable(std::string_view text);

/// At most kLongestShown bytes and an ellipsis, not cut inside a UTF-8 character.
std::string shortened(std::string_view text);

/// The valid name with the fewest edits to `name`; empty if none is similar.
std::string_view nearest(std::string_view name, std::span<const std::string_view> valid);

/// "; did you mean 'x'?", or nothing.
std::string did_you_mean(std::string_view name, std::span<const std::string_view> valid);

/// The same, or else "; valid: …", the list of valid names.
std::string suggestion(std::string_view name, std::span<const std::string_view> valid);

}  // namespace eikonal::scene_file
