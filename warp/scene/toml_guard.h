/// Guard in front of the TOML parser, whose recursion over the parts of dotted keys has no limit of its own.
#pragma once

#include <cstddef>
#include <string_view>

namespace eikonal::scene_file {

/// Most dots of a text that are no decimal points; they bound the depth of its tables, whatever else the text is.
inline constexpr std::size_t kMostDots = 2000;

/// The line (from 1) on which the text exceeds kMostDots; 0 if it does not.
std::size_t too_dotted_line(std::string_view text);

}  // namespace eikonal::scene_file
