/// The page that shows a comparison: one HTML document that needs nothing else, written so that it is well-formed XML.
#pragma once

#include <string>
#include <vector>

#include "reference/comparison.h"

namespace eikonal::reference {

/// A PNG file's bytes, and what it shows.
struct PagePicture {
    std::string label;        ///< e.g. "warp: screens"
    std::string png;          ///< the file's bytes
    bool is_default = false;  ///< the default model's warp
    double scale_end = 0;     ///< of a heat map, whose lower rows are its scale [px]; else 0
};

/// pictures: of one frame, all of the comparison's size but for the heat maps' scales. The slider begins with the first
/// on its left and the default model's warp, or else the second, on its right.
std::string comparison_page(const Comparison& comparison, const std::vector<PagePicture>& pictures, int frame);

/// Text as HTML: & < > " escaped.
std::string escaped(const std::string& text);

}  // namespace eikonal::reference
