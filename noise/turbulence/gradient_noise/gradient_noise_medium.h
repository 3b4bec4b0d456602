/// Turbulence of form "gradient-noise" as a medium.
#pragma once

#include <memory>
#include <string>

#include "noise/medium/medium.h"
#include "noise/turbulence/gradient_noise/gradient_noise.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {

class GradientNoiseMedium final : public Medium {
  public:
    GradientNoiseMedium(const TurbulenceSpec& spec, const MediumSetting& setting);

    std::shared_ptr<const MediumInstant> at(double t, const InstantSettings& settings) const override;
    std::string note() const override { return "gradient noise, not periodic"; }
    /// A box of the spec's period and lattice from the origin on, else of two outer scales.
    FieldSlices slices(double t, const ForceLaw& law) const override;

    const GradientNoiseField& field() const { return *field_; }
    const TurbulenceSpec& spec() const { return spec_; }

  private:
    TurbulenceSpec spec_;
    std::shared_ptr<const GradientNoiseField> field_;
};

}  // namespace eikonal
