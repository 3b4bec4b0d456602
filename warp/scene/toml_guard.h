/// A check before the TOML parser. The parser recurses over the parts of dotted keys without a limit of its own.
#pragma once

#include <cstddef>
#include <string_view>

namespace eikonal::scene_file {

/// Largest number of dots in a text, decimal points excluded. It bounds the depth of the tables for any text.
inline constexpr std::size_t kMostDots = 2000;

/// The line (from 1) on which the text exceeds kMostDots; 0 if it does not.
std::size_t too_dotted_line(std::string_view text);

}  // namespace eikonal::scene_file
