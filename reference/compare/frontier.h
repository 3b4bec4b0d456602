/// Error against time: which models are worth their time, and the plot of it.
#pragma once

#include <string>
#include <vector>

#include "reference/compare/comparison.h"

namespace eikonal::reference {

/// Places in comparison.models of those that no other beats in both error (p95 of all pixels) and time, quickest first.
/// The plate itself is none of them, but beats every model that is not more exact than no warp at all.
std::vector<std::size_t> efficient(const Comparison& comparison);

/// An SVG document: every model's p95 error [px] over its time [ms], both logarithmic, the efficient ones joined;
/// beside them the tracer's time and the error of the plate as it is.
std::string frontier_svg(const Comparison& comparison);

}  // namespace eikonal::reference
