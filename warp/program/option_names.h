/// Names of settings as the user of a program types them.
#pragma once

#include <string>
#include <string_view>

namespace eikonal {

/// Replaces the names of settings in a message by those of options: `depth_range` becomes --depth-range. The libraries
/// put names of settings between backticks (noise/base/error.h). Other text between backticks stays as it is.
std::string with_options(std::string_view message);

}  // namespace eikonal
