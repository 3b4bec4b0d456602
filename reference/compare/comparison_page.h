/// The page that shows a comparison: one HTML document that needs nothing else, written so that it is well-formed XML.
#pragma once

#include <string>
#include <vector>

#include "reference/compare/comparison.h"

namespace eikonal::reference {

/// A PNG file's bytes, and what it shows.
struct PagePicture {
    std::string label;        ///< e.g. "warp: screens"
    std::string png;          ///< the file's bytes
    bool is_default = false;  ///< the default model's warp
    double scale_end = 0;     ///< of a heat map, whose lower rows are its scale [px]; else 0
};
/// Pictures of one frame, by labels that are the same in every frame; the first frame may lack some of them.
struct PageFrame {
    int number;
    std::vector<PagePicture> pictures;
};

/// A page shows so many frames at most, evenly spread over the shot: it holds their pictures.
inline constexpr std::size_t kMostPageFrames = 24;
/// Whether frame i of `count` is one of them: the first and the last are.
bool on_page(std::size_t i, std::size_t count);

/// frames: at least one; their pictures all of the comparison's size but for the heat maps' scales. More than one can
/// be chosen, and played. The slider begins with the first picture on its left and the default model's warp, or else
/// the second, on its right.
std::string comparison_page(const Comparison& comparison, const std::vector<PageFrame>& frames);

/// Text as HTML: & < > " escaped.
std::string escaped(const std::string& text);

}  // namespace eikonal::reference
