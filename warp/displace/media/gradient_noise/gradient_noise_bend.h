/// Gradient noise in the warp: model `first-order` (warp/displace/models/first_order.h).
#pragma once

#include "noise/turbulence/gradient_noise/gradient_noise_medium.h"
#include "warp/displace/media/medium_bend.h"

namespace eikonal {

class GradientNoiseBend final : public MediumBend {
  public:
    /// UserError: rays that need too many steps.
    GradientNoiseBend(const ShotContext& shot, std::size_t medium, std::shared_ptr<const GradientNoiseMedium> noise);

    std::unique_ptr<const BendInstant> at(const FrameView& frame) const override;
    double expected_variance(double D, bool rough) const override;
    double focusing_variance(double D) const override;
    std::vector<std::string> beyond_far(double farthest) const override;

  private:
    std::shared_ptr<const GradientNoiseMedium> noise_;
    dvec3 cell_;  ///< [m]
};

}  // namespace eikonal
