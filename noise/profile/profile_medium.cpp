/// The hooks of [[medium]] type = "profile", and the profile as a medium.
#include "noise/medium/medium.h"
#include "noise/medium/optics.h"
#include "noise/profile/profile.h"
#include "noise/profile/profile_spec.h"

namespace eikonal {
namespace {

/// A step is at most this part of the length over which the profile changes by its own size.
constexpr double kPartOfProfile = 0.125;

class Instant final : public MediumInstant {
  public:
    explicit Instant(const Profile& profile) : profile_(profile) {}

    IndexJet jet(const dvec3& x) const override { return profile_.jet(x); }
    double longest_step(const dvec3& x, const dvec3&) const override { return kPartOfProfile * profile_.scale(x); }
    double clear_way(const dvec3& x, const dvec3& d) const override { return profile_.clear_way(x, d); }
    double way_to_edge(const dvec3& x, const dvec3& d) const override { return profile_.way_to_edge(x, d); }

  private:
    Profile profile_;
};

class ProfileMedium final : public Medium {
  public:
    explicit ProfileMedium(const ProfileSpec& spec) : spec_(spec), profile_(spec) {}

    std::shared_ptr<const MediumInstant> at(double, const InstantSettings&) const override {
        return std::make_shared<const Instant>(profile_);
    }
    std::string note() const override { return "a profile, the absolute index of all space"; }
    double farthest_part(const dvec3& from) const override {
        return spec_.profile == ProfileKind::Luneburg ? glm::distance(from, spec_.center) + spec_.radius : 0;
    }

  private:
    ProfileSpec spec_;
    Profile profile_;
};

}  // namespace

std::string why_still(const ProfileSpec&, const OpticsSpec&) {
    return {};
}

std::unique_ptr<const Medium> build_medium(const ProfileSpec& spec, const MediumSetting&) {
    return std::make_unique<const ProfileMedium>(spec);
}

}  // namespace eikonal
