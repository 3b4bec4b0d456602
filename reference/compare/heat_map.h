/// Errors as colours: from black through violet, red and orange to light yellow; grey-green where there is no answer.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "warp/pixels/linear_image.h"

namespace eikonal::reference {

/// Height of the scale below a heat map [px].
inline constexpr int kScaleHeight = 26;

/// The end of a scale that holds `largest`: 1, 2 or 5 times a power of ten, at least 0.001 [px].
double scale_end(double largest);

/// Errors [px] as a picture, width * height, over a scale of kScaleHeight rows from 0 to `end` px with its numbers.
/// error: negative where there is none. Larger ones than `end` are drawn as `end`.
LinearImage heat_map(std::span<const float> error, int width, int height, double end);

/// The scale's colours as a CSS gradient.
std::string heat_gradient();

}  // namespace eikonal::reference
