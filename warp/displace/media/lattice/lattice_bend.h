/// Lattices in the warp: the models `table`, `tables`, `spectral` (warp/displace/models/lattice_tables.h) and
/// `first-order` (warp/displace/models/first_order.h).
#pragma once

#include "noise/turbulence/lattice/lattice_medium.h"
#include "noise/turbulence/lattice/path_tables.h"
#include "warp/displace/media/medium_bend.h"

namespace eikonal {

class LatticeBend final : public MediumBend {
  public:
    /// UserError: a model that does not suit the view, or rays that need too many steps.
    LatticeBend(const ShotContext& shot, std::size_t medium, std::shared_ptr<const LatticeMedium> lattice);

    std::unique_ptr<const BendInstant> at(const FrameView& frame) const override;
    double expected_variance(double D, bool rough) const override;
    double focusing_variance(double D) const override;
    double corner_gain() const override;
    double instant_bytes() const override;
    std::vector<std::string> beyond_far(double farthest) const override;

  private:
    bool stepped() const { return model() >= Model::FirstOrder; }
    void choose_ray_spline();
    void choose_table_padding();
    std::unique_ptr<const BendInstant> tables_at(const FrameView& frame) const;

    std::shared_ptr<const LatticeMedium> lattice_;
    PathRays rays_;        ///< along the lattice axis nearest to the reference view
    dvec3 cell_;           ///< cell of the lattice [m]
    double constant_ = 0;  ///< the constant c of `table`
    int padding_ = 1;      ///< padding of the splines that the model reads
    int ray_padding_ = 1;  ///< padding of the spline that bent rays read
    /// SplineError::bend, if the map and the rays that judge it read the same spline; else 0.
    double bend_error_ = 0;
};

}  // namespace eikonal
