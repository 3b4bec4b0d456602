/// Error against time: the models that are worth their time, and a plot of them.
#pragma once

#include <string>
#include <vector>

#include "reference/compare/comparison.h"

namespace eikonal::reference {

/// Indices into comparison.models of the efficient models, quickest first. No other model beats them in both error (p95
/// of all pixels) and time. The plate itself is not one of them. It beats every model that is not more exact than no
/// warp.
std::vector<std::size_t> efficient(const Comparison& comparison);

/// An SVG document that plots every model's p95 error [px] over its time [ms], both on logarithmic axes. A line joins
/// the efficient models. The tracer's time and the error of the plate as it is are marked.
std::string frontier_svg(const Comparison& comparison);

}  // namespace eikonal::reference
