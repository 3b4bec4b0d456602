/// What `eikonal-trace compare` leaves in its folder:
///     plate.FFFF.png  truth.FFFF.png  warp-MODEL.FFFF.png  error-MODEL.FFFF.png    of each frame; errors as colours
///                                                              over their scale
///     errors.csv  errors.txt     a row for each model (comparison_table.h)
///     frontier.svg               error over time (frontier.h)
///     index.html                 all of it on one page (comparison_page.h), with the first frame's pictures; made last
///
/// Every file appears whole or not at all (warp/image/atomic_file.h). FrameError.
#pragma once

#include <filesystem>

#include "reference/comparison.h"
#include "reference/comparison_page.h"

namespace eikonal::reference {

/// Writes a frame's pictures and gives them back for the page: plate, truth, then of each model the warp and the error.
std::vector<PagePicture> write_pictures(const std::filesystem::path& folder, const Comparison& comparison,
                                        const Comparer::Frame& frame);

/// Tables, plot and page. pictures: of the first frame.
void write_report(const std::filesystem::path& folder, const Comparison& comparison,
                  const std::vector<PagePicture>& pictures);

}  // namespace eikonal::reference
