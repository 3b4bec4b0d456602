/// Turbulence of form "lattice" as a medium: the field, and the splines through its instants.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "noise/medium/medium.h"
#include "noise/turbulence/lattice/lattice_instant.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {

/// Rms error of a lattice's force between its nodes, relative to the rms force, that its splines are made finer for
/// unless a user asks otherwise, and how many times finer they are at most.
inline constexpr double kInterpolationError = 1e-3;
inline constexpr int kFinestPadding = 8;
/// Nodes of a spline that is made finer than its lattice, at most: 640³ with some to spare, whatever the machine has,
/// so that every machine makes the same.
inline constexpr double kMostSplineNodes = 2.75e8;

/// What a spline may be off by, and how fine it may become for that.
struct SplineLimits {
    double slope = kInterpolationError;                     ///< SplineError::slope allowed
    double bend = std::numeric_limits<double>::infinity();  ///< SplineError::bend allowed [m^-1/2]
    int most_padding = kFinestPadding;
    double most_nodes = kMostSplineNodes;
};
struct SplineChoice {
    int padding = 1;
    SplineError error;
    bool within = true;  ///< the limits
};
/// The least padding of 1, 2, 3, 4, 5, 6, 8 that keeps to the limits; the greatest allowed if none does. A function of
/// the field alone.
SplineChoice choose_spline(const LatticeField& field, const SplineLimits& limits);

/// A given spline of the field as a medium's instant. bend_error: its InterpolationBend::error, 0 if that is not to be
/// known.
std::shared_ptr<const MediumInstant> lattice_medium_instant(std::shared_ptr<const LatticeInstant> spline,
                                                            const LatticeField& field, double bend_error);

class LatticeMedium final : public Medium {
  public:
    /// UserError: as check_lattice (memory of the budget), and a spline that does not fit into what is left of it.
    LatticeMedium(const TurbulenceSpec& spec, const MediumSetting& setting);

    std::shared_ptr<const MediumInstant> at(double t, const InstantSettings& settings) const override;
    std::string note() const override { return note_; }
    /// Of a lattice without any wave that has a slope: with two samples a period, all waves are at Nyquist.
    std::string warning() const override;
    double interpolation_error() const override { return spline_ ? spline_->error.slope : 0; }
    /// The lattice's own nodes, exactly.
    FieldSlices slices(double t, const ForceLaw& law) const override;

    const LatticeField& field() const { return *field_; }

  private:
    void make_spline_choice(const MediumSetting& setting);

    std::shared_ptr<const LatticeField> field_;
    std::optional<SplineChoice> spline_;  ///< of instants that rays are followed through
    std::string note_;
};

}  // namespace eikonal
