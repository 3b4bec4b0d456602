/// Errors as colours: from black through violet, red and orange to light yellow. Grey-green marks pixels without an
/// answer.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "warp/pixels/linear_image.h"

namespace eikonal::reference {

/// Height of the scale below a heat map [px].
inline constexpr int kScaleHeight = 26;

/// The end of a scale for errors up to `largest` [px]: 1, 2 or 5 times a power of ten, and at least 0.001.
double scale_end(double largest);

/// A picture of errors [px], width * height, above a scale of kScaleHeight rows from 0 to `end` px with its numbers.
/// error: negative where there is no answer. Errors above `end` have its colour.
LinearImage heat_map(std::span<const float> error, int width, int height, double end);

/// The scale's colours as a CSS gradient.
std::string heat_gradient();

}  // namespace eikonal::reference
