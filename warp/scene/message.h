/// Text of messages to the user.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace eikonal::scene_file {

/// Longest value or name that a message repeats in full [bytes].
inline constexpr std::size_t kLongestShown = 60;

/// Replaces control characters (which quoted TOML keys may hold) by '?', so that a message stays one line.
std::string printable(std::string_view text);

/// The text cut to at most kLongestShown bytes, with an ellipsis. It is not cut inside a UTF-8 character.
std::string shortened(std::string_view text);

/// The valid name that is the fewest edits away from `name`; empty if none is similar.
std::string_view nearest(std::string_view name, std::span<const std::string_view> valid);

/// "; did you mean 'x'?", or an empty text if no valid name is similar.
std::string did_you_mean(std::string_view name, std::span<const std::string_view> valid);

/// As did_you_mean(), but "; valid: …" with the list of valid names if none is similar.
std::string suggestion(std::string_view name, std::span<const std::string_view> valid);

}  // namespace eikonal::scene_file
