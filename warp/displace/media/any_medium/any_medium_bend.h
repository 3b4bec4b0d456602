/// Any medium in the warp, through its interface alone. It is the model `first-order`, integrated along straight rays.
///
///     x1(z) = L² ∫₀^z (z - w) F(P(w)) dw        PHYSICS.md#first-order
///
/// The integral is computed by the two-point Gauss-Legendre rule. A step is as long as the medium says is safe. It ends
/// where the force of the medium jumps. A stretch without force is crossed in one step. A new kind of medium therefore
/// works in the warp without any code of its own there.
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
