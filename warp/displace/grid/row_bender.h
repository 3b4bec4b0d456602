/// A medium that bends the rays of a row of pixels exactly, in addition to the displacement grids; a mirage, for
/// example.
///
/// The grids hold displacements that are small and smooth. A medium that bends rays too strongly for them implements
/// this interface instead, and GridRows adds its displacement to that of the grids. One object serves one thread.
#pragma once

#include "warp/displace/grid/shift.h"

namespace eikonal {

class RowBender {
  public:
    virtual ~RowBender() = default;

    /// Goes to pixel row y (absolute). The functions below are about the pixels of this row; x is an absolute column.
    virtual void start_row(int y) = 0;
    /// Displacement of pixel x for an object at axial depth z [m] > 0.
    virtual Shift at(int x, double z) = 0;
    /// Whether it displaces pixel x at any depth.
    virtual bool moves(int x) = 0;
    /// Axial depth where the ray of pixel x ends on a surface [m]; infinite if it ends on none, or if it does not move.
    virtual double ray_end(int x) = 0;
    /// Whether at(x, z) contains the displacement of the grids, which must then not be added to it.
    virtual bool contains_grids(int x) = 0;
    /// Whether contains_grids() may be true anywhere in this row. Rows without such pixels take the grids' fast path.
    virtual bool row_may_contain_grids() const = 0;

  protected:
    RowBender() = default;
    RowBender(const RowBender&) = default;
    RowBender(RowBender&&) = default;
    RowBender& operator=(const RowBender&) = default;
    RowBender& operator=(RowBender&&) = default;
};

}  // namespace eikonal
