/// Turbulence of form "screens" as a medium: thin screens across the shot's axis.
#pragma once

#include <memory>
#include <string>

#include "noise/medium/medium.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "noise/turbulence/screens/screens.h"

namespace eikonal {

class ScreensMedium final : public Medium {
  public:
    /// UserError: as layout_screens and check_screens. std::logic_error without a shot's frame.
    ScreensMedium(const TurbulenceSpec& spec, const MediumSetting& setting);

    /// A ScreenForce: it has no index of its own.
    std::shared_ptr<const MediumInstant> at(double t, const InstantSettings& settings) const override;
    std::string note() const override;
    /// Each screen is a slice: n and F averaged over its slab, along the axes of the shot's frame (F.z = 0), without
    /// falloff, for where a falloff lies on a screen depends on the ray.
    FieldSlices slices(double t, const ForceLaw& law) const override;

    const ScreenField& field() const { return field_; }
    const ShotFrame& frame() const { return frame_; }
    const TurbulenceSpec& spec() const { return spec_; }
    /// Instants that the caller has made already, as a force.
    std::shared_ptr<const MediumInstant> around(std::vector<ScreenInstant> screens,
                                                const InstantSettings& settings) const;

  private:
    TurbulenceSpec spec_;
    ShotFrame frame_;
    ScreenField field_;
};

}  // namespace eikonal
