/// The depth buffer of a picture: axial depth of every pixel of a window, in metres, positive and finite.
///
/// Depth is read at single pixels and never filtered, because a depth between foreground and background exists nowhere.
/// Every pixel is thus a facet at its own depth. The picture, though, is filtered: an antialiased pixel beside an edge
/// shows some of the foreground, whatever its depth is. The plane therefore knows for every pixel which of its
/// neighbours stand out before it.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "warp/displace/grid/displacement_grid.h"
#include "warp/pixels/linear_image.h"

namespace eikonal {

/// A pixel stands out before its neighbour if it is nearer than this part of the neighbour's depth. On a plane seen at
/// a grazing angle neighbours differ as much. So it must also be nearer than this part of the depth where a plane would
/// be that goes through the neighbour and the pixel on the neighbour's other side. (In perspective, inverse depths of a
/// plane are linear.)
inline constexpr float kEdgeRatio = 0.8f;

/// Immutable and thread-safe.
class DepthPlane {
  public:
    /// Depths within some window of pixels [m].
    struct Range {
        float nearest, farthest;
        float front = std::numeric_limits<float>::infinity();  ///< nearest front() of the pixels
    };
    /// Side of the blocks of pixels whose ranges around() gives.
    static constexpr int kBlock = 8;

    /// metres: window.area() > 0 values, row by row.
    DepthPlane(const PixelWindow& window, std::vector<float> metres);

    const PixelWindow& window() const { return window_; }
    /// Depth of a pixel. Outside of the window it is that of the nearest pixel in it.
    float at(int x, int y) const { return metres_[index(x, y)]; }
    /// Depth of the nearest of the eight neighbours that stand out before this pixel (kEdgeRatio); infinite if there is
    /// none.
    float front(int x, int y) const { return fronts_[index(x, y)]; }
    float nearest() const { return all_.nearest; }
    float farthest() const { return all_.farthest; }
    /// Ranges around each block that has a pixel in `tile`, row by row. Blocks are kBlock pixels wide and high, and
    /// counted from the window's first pixel. A range takes in all pixels within `radius` of any pixel of the block,
    /// and perhaps some more.
    std::vector<Range> around(const PixelWindow& tile, int radius) const;

    /// Rows and columns of blocks: the block of pixel (x, y), which may lie outside of the window.
    int block_column(int x) const { return floor_div(x - window_.x0, kBlock); }
    int block_row(int y) const { return floor_div(y - window_.y0, kBlock); }

  private:
    std::size_t index(int x, int y) const {
        const int cx = std::clamp(x - window_.x0, 0, window_.width - 1);
        const int cy = std::clamp(y - window_.y0, 0, window_.height - 1);
        return static_cast<std::size_t>(cy) * static_cast<std::size_t>(window_.width) + static_cast<std::size_t>(cx);
    }
    void find_fronts(int y);

    PixelWindow window_;
    std::vector<float> metres_, fronts_;
    std::vector<Range> blocks_;
    int block_columns_ = 0, block_rows_ = 0;
    Range all_{};
};

}  // namespace eikonal
