/// Hot blobs in the warp: the closed form of model `first-order` (warp/displace/media/blobs/seen_blobs.h).
#pragma once

#include "noise/blobs/blobs_medium.h"
#include "warp/displace/media/blobs/seen_blobs.h"
#include "warp/displace/media/medium_bend.h"

namespace eikonal {

class BlobsBend final : public MediumBend {
  public:
    BlobsBend(const ShotContext& shot, std::size_t medium, std::shared_ptr<const BlobsMedium> blobs);

    /// Why blobs that live there move no pixel that is seen; empty if they may.
    static std::string why_unseen(const ShotContext& shot, const BlobsMedium& blobs);

    bool is_seen_for_sure() const override { return true; }
    std::unique_ptr<const BendInstant> at(const FrameView& frame) const override;
    double expected_variance(double D, bool rough) const override;
    /// Where blobs are, at t = 0: within 1.5 σ of the middle of one taken at random.
    double focusing_variance(double D) const override;
    double instant_bytes() const override;

  private:
    SeenBlobs seen_at(const Camera& camera, double t, double farthest, double gain) const;
    /// Variance of |d| [px²] over pixels, most of them among the blobs, and over `instants`, the first of them t = 0: a
    /// shot begins there, and finds its wind made. Fewer if there is a wind and blobs at many of them.
    double shift_variance(double D, int instants, int rays) const;

    std::shared_ptr<const BlobsMedium> blobs_;
};

}  // namespace eikonal
