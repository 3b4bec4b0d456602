/// The page that shows a comparison: one HTML document that needs no other file. It is well-formed XML.
#pragma once

#include <string>
#include <vector>

#include "reference/compare/comparison.h"

namespace eikonal::reference {

/// A picture of the page.
struct PagePicture {
    std::string label;        ///< e.g. "warp: screens"
    std::string png;          ///< the file's bytes
    bool is_default = false;  ///< the default model's warp
    double scale_end = 0;     ///< end of a heat map's scale [px], which its lower rows show. 0 for other pictures.
};
/// Pictures of one frame. Labels are the same in every frame. The first frame may lack some of them.
struct PageFrame {
    int number;
    std::vector<PagePicture> pictures;
};

/// The most frames of a page, which holds their pictures. They are spread evenly over the shot.
inline constexpr std::size_t kMostPageFrames = 24;
/// Whether the page shows frame i of `count`. It always shows the first and the last.
bool on_page(std::size_t i, std::size_t count);

/// The page. frames: at least one. Their pictures have the comparison's size, and heat maps also have a scale below. A
/// reader can choose among several frames, and play them. The slider begins with the first picture on its left. On its
/// right is the default model's warp, or else the second picture.
std::string comparison_page(const Comparison& comparison, const std::vector<PageFrame>& frames);

/// Text as HTML, with & < > " escaped.
std::string escaped(const std::string& text);

}  // namespace eikonal::reference
