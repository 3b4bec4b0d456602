/// Hot blobs in the warp: the closed form of model `first-order` (warp/displace/media/blobs/seen_blobs.h).
#pragma once

#include "noise/blobs/blobs_medium.h"
#include "warp/displace/media/blobs/seen_blobs.h"
#include "warp/displace/media/medium_bend.h"

namespace eikonal {

class BlobsBend final : public MediumBend {
  public:
    BlobsBend(const ShotContext& shot, std::size_t medium, std::shared_ptr<const BlobsMedium> blobs);

    /// Why these blobs move no visible pixel; empty if they may move one.
    static std::string why_unseen(const ShotContext& shot, const BlobsMedium& blobs);

    bool is_seen_for_sure() const override { return true; }
    std::unique_ptr<const BendInstant> at(const FrameView& frame) const override;
    double expected_variance(double D, bool rough) const override;
    /// Taken where blobs are, at t = 0: within 1.5 σ of the middle of a blob chosen at random.
    double focusing_variance(double D) const override;
    double instant_bytes() const override;

  private:
    SeenBlobs seen_at(const Camera& camera, double t, double farthest, double gain) const;
    /// Variance of |d| [px²] over pixels, most of them among the blobs, and over `instants`. The first instant is t =
    /// 0, where a shot begins, so that the shot finds its wind already computed. Fewer instants are used if there is a
    /// wind and many of them have blobs.
    double shift_variance(double D, int instants, int rays) const;

    std::shared_ptr<const BlobsMedium> blobs_;
};

}  // namespace eikonal
