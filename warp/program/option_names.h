/// Settings as the user of a program types them.
#pragma once

#include <string>
#include <string_view>

namespace eikonal {

/// A message of the libraries with its settings spelled as options: `depth_range` becomes --depth-range. The libraries
/// put names of settings between backticks (noise/base/error.h). Text between backticks that is no setting stays.
std::string with_options(std::string_view message);

}  // namespace eikonal
