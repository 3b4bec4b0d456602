/// Any medium in the warp, through its interface alone: model `first-order` by integration along straight rays.
///
///     x1(z) = L² ∫₀^z (z - w) F(P(w)) dw        PHYSICS.md#first-order
///
/// by two-point Gauss-Legendre rules on steps as long as the medium says is safe; steps end where its force jumps, and
/// clear ways are crossed in one. So a new kind of medium is warped from the day that its folder exists.
///
/// The spacing of nodes follows from the shortest safe steps on rays spread over the picture. kAnyMediumError bounds
/// the error for media whose longest_step is half of their smallest feature or less. An aperture averages over a bundle
/// of rays as in warp/displace/models/first_order.h.
#pragma once

#include "warp/displace/media/medium_bend.h"

namespace eikonal {

/// Rms error of the displacement against Eq. 7, relative to the rms displacement.
/// (tests/noise/medium/puff_test.cpp)
inline constexpr double kAnyMediumError = 0.02;

class AnyMediumBend final : public MediumBend {
  public:
    AnyMediumBend(const ShotContext& shot, std::size_t medium, std::shared_ptr<const Medium> any);

    std::unique_ptr<const BendInstant> at(const FrameView& frame) const override;
    double expected_variance(double D, bool rough) const override;
    double focusing_variance(double D) const override;

  private:
    std::shared_ptr<const Medium> any_;
};

}  // namespace eikonal
