/// Thin screens in the warp: model `screens` (warp/displace/models/thin_screens.h).
#pragma once

#include "noise/turbulence/screens/screens_medium.h"
#include "warp/displace/media/medium_bend.h"

namespace eikonal {

class ScreensBend final : public MediumBend {
  public:
    ScreensBend(const ShotContext& shot, std::size_t medium, std::shared_ptr<const ScreensMedium> screens);

    std::unique_ptr<const BendInstant> at(const FrameView& frame) const override;
    double expected_variance(double D, bool rough) const override;
    double focusing_variance(double D) const override;
    double corner_gain() const override;
    double instant_bytes() const override;
    std::vector<std::string> beyond_far(double farthest) const override;

  private:
    std::shared_ptr<const ScreensMedium> screens_;
};

}  // namespace eikonal
