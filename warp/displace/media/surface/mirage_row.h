/// Mirages as benders of a row of pixels (row_bender.h), with the air about them or without.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "warp/displace/grid/row_bender.h"
#include "warp/displace/media/surface/mirage.h"
#include "warp/displace/media/surface/mirage_air.h"

namespace eikonal {

/// One mirage.
class MirageRow final : public RowBender {
  public:
    /// air: what the grids do to the rays of this mirage; null if they do nothing to them and their displacement is
    /// added. mirage and air must outlive this.
    explicit MirageRow(const Mirage& mirage, const MirageAir* air = nullptr) : mirage_(&mirage), air_(air) {}

    void start_row(int y) override;
    Shift at(int x, double z) override;
    bool moves(int x) override { return ready(x); }
    double ray_end(int x) override { return ready(x) ? pixel_.end : std::numeric_limits<double>::infinity(); }
    bool contains_grids(int x) override { return row_air_ != nullptr && ready(x); }
    bool row_may_contain_grids() const override { return row_air_ != nullptr; }

  private:
    /// Makes pixel x the current one. Whether the mirage moves it.
    bool ready(int x) {
        if (x != x_ || !known_) look_up(x);
        return moves_;
    }
    void look_up(int x);

    const Mirage* mirage_;
    const MirageAir* air_;
    const MirageAir* row_air_ = nullptr;  ///< air_, in rows where the mirage moves pixels
    int y_ = 0, x_ = 0;
    bool known_ = false, moves_ = false;  ///< of the current pixel, as all that follows
    Mirage::PixelRay pixel_;
    Mirage::Axes axes_;
    MirageAir::Pixel air_pixel_;
};

/// All mirages of a tile, for GridRows::start(). Not to be copied, because benders() refers to members.
class MirageRows {
  public:
    /// air: of one of the mirages (MirageAir::belongs_to); null if there is none. mirages and air must outlive this.
    explicit MirageRows(std::span<const Mirage> mirages, const MirageAir* air = nullptr);
    MirageRows(const MirageRows&) = delete;
    MirageRows& operator=(const MirageRows&) = delete;

    std::span<RowBender* const> benders() const { return benders_; }

  private:
    std::vector<MirageRow> rows_;
    std::vector<RowBender*> benders_;
};

/// A single pixel whose ray is known from elsewhere: other grids hold its whole displacement, mirages included. Mirages
/// tell only whether they move it.
class KnownMirageRay final : public RowBender {
  public:
    KnownMirageRay(std::span<const Mirage> mirages, int x, int y);

    /// Sets the axial depth where the pixel's ray ends on a surface [m] > 0; infinite if it ends on none.
    void end_at(double z) { end_ = z; }

    void start_row(int) override {}
    Shift at(int, double) override { return {}; }
    bool moves(int) override { return moves_; }
    double ray_end(int) override { return end_; }
    bool contains_grids(int) override { return false; }
    bool row_may_contain_grids() const override { return false; }

  private:
    bool moves_ = false;
    double end_ = std::numeric_limits<double>::infinity();
};

}  // namespace eikonal
