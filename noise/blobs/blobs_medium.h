/// Hot blobs as a medium.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "noise/blobs/blobs.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/medium/medium.h"

namespace eikonal {

class BlobsMedium final : public Medium {
  public:
    /// UserError: as BlobCloud. The blobs are counted in the budget.
    BlobsMedium(const BlobsSpec& spec, const MediumSetting& setting);

    std::shared_ptr<const MediumInstant> at(double t, const InstantSettings& settings) const override;
    std::string note() const override;
    std::string why_still() const override;
    double farthest_part(const dvec3& from) const override;

    const BlobCloud& cloud() const { return cloud_; }
    const BlobsSpec& spec() const { return spec_; }
    /// An instant of blobs that the caller has computed already.
    static std::shared_ptr<const MediumInstant> around(const std::vector<Blob>& blobs, const InstantSettings& settings);

  private:
    BlobsSpec spec_;
    BlobCloud cloud_;
};

}  // namespace eikonal
