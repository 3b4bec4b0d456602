#include "noise/blobs/blobs_medium.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "noise/blobs/blob_instant.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/medium/optics.h"

namespace eikonal {
namespace {

/// `eikonal field` shows this distance around each blob [σ].
constexpr double kShownReach = 3;

class Instant final : public MediumInstant {
  public:
    Instant(const std::vector<Blob>& blobs, const InstantSettings& settings)
        : blobs_(blobs, settings.reach.value_or(kBlobReach), kBlobStep * settings.step),
          shown_(box_around(blobs)),
          force_(settings.strength() * (settings.law.equation == RayEquation::Paper ? 1 : 1 + settings.law.ambient)),
          second_order_(std::abs(settings.strength())) {}

    IndexSample sample(const dvec3& x) const override { return blobs_.sample(x); }
    IndexJet jet(const dvec3& x) const override { return blobs_.jet(x); }
    double longest_step(const dvec3& x, const dvec3&) const override { return blobs_.longest_step(x); }
    double longest_stride(const dvec3& x, const dvec3& d, double turn) const override {
        return blobs_.longest_stride(x, d, turn / std::abs(force_));
    }
    double clear_way(const dvec3& x, const dvec3& d) const override { return blobs_.clear_way(x, d); }
    bool add_bend(const dvec3& x, const dvec3& d, double distance, double turn, StraightBend& sum) const override {
        const BlobInstant::Bend bend = blobs_.bend(x, d, distance, turn / std::abs(force_));
        sum.value += force_ * bend.x1;
        sum.error += second_order_ * bend.largest;
        return true;
    }
    Box shown_box() const override { return shown_; }

  private:
    /// The box around all blobs, or a metre about the origin if there are none.
    static Box box_around(const std::vector<Blob>& blobs) {
        Box box{dvec3(-0.5), dvec3(0.5)};
        bool any = false;
        for (const Blob& blob : blobs) {
            if (blob.n == 0) continue;
            const dvec3 margin(kShownReach * blob.sigma);
            box.low = any ? glm::min(box.low, blob.center - margin) : blob.center - margin;
            box.high = any ? glm::max(box.high, blob.center + margin) : blob.center + margin;
            any = true;
        }
        return box;
    }

    BlobInstant blobs_;
    Box shown_;
    double force_;         ///< F/∇(n - n_ambient) where n is the ambient index
    double second_order_;  ///< largest relative error of force_ for an n - n_ambient of 1
};

}  // namespace

std::string why_still(const BlobsSpec& spec, const OpticsSpec&) {
    return spec.blobs.empty() && spec.sources.empty() ? "it has no blobs" : "";
}

std::unique_ptr<const Medium> build_medium(const BlobsSpec& spec, const MediumSetting& setting) {
    return std::make_unique<const BlobsMedium>(spec, setting);
}

void mix_seeds(BlobsSpec& spec, const RandomStream& stream) {
    spec.seed = stream.bits(spec.seed);
    if (spec.wind) spec.wind->seed = stream.bits(spec.wind->seed);
}

BlobsMedium::BlobsMedium(const BlobsSpec& spec, const MediumSetting& setting)
    : spec_(spec), cloud_(spec, index_law(setting.optics), setting.name, setting.budget->blobs) {
    setting.budget->blobs += cloud_.most();
}

std::shared_ptr<const MediumInstant> BlobsMedium::around(const std::vector<Blob>& blobs,
                                                         const InstantSettings& settings) {
    return std::make_shared<const Instant>(blobs, settings);
}

std::shared_ptr<const MediumInstant> BlobsMedium::at(double t, const InstantSettings& settings) const {
    return around(cloud_.at(t), settings);
}

std::string BlobsMedium::note() const {
    return fmt::format("up to {} blobs at a time", cloud_.most());
}

std::string BlobsMedium::why_still() const {
    return cloud_.most() > 0 ? "" : "it has no blobs";
}

double BlobsMedium::farthest_part(const dvec3& from) const {
    double farthest = 0;
    for (const BlobHome& home : cloud_.homes())
        farthest = std::max(farthest,
                            glm::distance(from, home.largest.center) + home.radius + kBlobReach * home.largest.sigma);
    return farthest;
}

}  // namespace eikonal
