/// The files that `eikonal-trace compare` writes into its folder:
///     plate.FFFF.png, truth.FFFF.png      of each frame
///     warp-MODEL.FFFF.png                 of each frame and model
///     error-MODEL.FFFF.png                errors as colours, above their scale
///     change-MODEL.FFFF.png               of each frame but the first: the error of the change of displacement since
///                                         the frame before
///     errors.csv, errors.txt              a row for each model (comparison_table.h)
///     frontier.svg                        error over time (frontier.h)
///     index.html                          all of this on one page (comparison_page.h); written last
///
/// Every file appears whole or not at all (warp/image/atomic_file.h). Failures: FrameError.
#pragma once

#include <filesystem>

#include "reference/compare/comparison.h"
#include "reference/compare/comparison_page.h"

namespace eikonal::reference {

/// Writes a frame's pictures and returns them for the page: plate, truth, then for each model the warp, the error and
/// the error of the change.
std::vector<PagePicture> write_pictures(const std::filesystem::path& folder, const Comparison& comparison,
                                        const Comparer::Frame& frame);

/// Writes tables, plot and page.
void write_report(const std::filesystem::path& folder, const Comparison& comparison,
                  const std::vector<PageFrame>& frames);

}  // namespace eikonal::reference
