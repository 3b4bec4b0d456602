/// The puff as a medium: its keys, and its index at a point with all derivatives.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "noise/math/portable_math.h"
#include "noise/medium/keys.h"
#include "noise/medium/medium.h"
#include "tests/noise/medium/puff/puff_spec.h"

namespace eikonal {
namespace {

/// Distance at which the cloud ends, and the longest step within it, as multiples of its size.
constexpr double kReach = 6, kStep = 0.25;

class Instant final : public MediumInstant {
  public:
    explicit Instant(const PuffSpec& spec) : spec_(spec) {}

    IndexJet jet(const dvec3& x) const override {
        const dvec3 r = (x - spec_.center) / spec_.size;
        const double n = spec_.index * portable::exp(-glm::dot(r, r)), per_size = 2 / spec_.size;
        return {n, -n * per_size * r,
                n * (per_size * per_size * glm::outerProduct(r, r) - glm::dmat3(2 / (spec_.size * spec_.size)))};
    }
    double longest_step(const dvec3& x, const dvec3&) const override {
        const double away = glm::distance(x, spec_.center) - kReach * spec_.size;
        return kStep * spec_.size + std::max(0.0, away);
    }
    double clear_way(const dvec3& x, const dvec3& d) const override {
        return Chord(x - spec_.center, d, kReach * spec_.size).into();
    }
    Box shown_box() const override {
        return {spec_.center - dvec3(2 * spec_.size), spec_.center + dvec3(2 * spec_.size)};
    }

  private:
    PuffSpec spec_;
};

class PuffMedium final : public Medium {
  public:
    explicit PuffMedium(const PuffSpec& spec) : spec_(spec) {}
    std::shared_ptr<const MediumInstant> at(double, const InstantSettings&) const override {
        return std::make_shared<const Instant>(spec_);
    }
    std::string note() const override { return "a puff"; }

  private:
    PuffSpec spec_;
};

}  // namespace

Keys keys(PuffSpec& p) {
    return {{"center", "", "m", p.center},
            {"size", "", "m", p.size, {positive()}},
            {"index", "n - n_ambient in the middle", p.index}};
}

std::string why_still(const PuffSpec& spec, const OpticsSpec& optics) {
    return spec.index * force_strength(optics) == 0 ? "its index is the ambient's" : "";
}

std::unique_ptr<const Medium> build_medium(const PuffSpec& spec, const MediumSetting&) {
    return std::make_unique<const PuffMedium>(spec);
}

}  // namespace eikonal
