/// The separable filters (Bilinear, Cubic, Lanczos3) over a span. Private to the resampler.
#pragma once

#include "warp/resample/span.h"

namespace eikonal::resampling {

/// Filters all pixels of the span into out[0 ... n).
void sample_separable(const Source& source, const Span& span, Filter filter, Pixel* out);

/// Filters pixel i of the span with 2 x 2 samples. Area uses it where the map shifts or magnifies.
Pixel sample_bilinear(const Source& source, const Span& span, int i);

}  // namespace eikonal::resampling
