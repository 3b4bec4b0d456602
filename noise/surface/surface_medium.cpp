#include "noise/surface/surface_medium.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "noise/medium/optics.h"
#include "noise/surface/surface_spec.h"

namespace eikonal {
namespace {

/// A step changes the height by at most this part of the dropoff d0.
constexpr double kPartOfDropoff = 0.25;
/// Height above the surface up to which `eikonal field` shows it [dropoff].
constexpr double kShownHeight = 8;

class Instant final : public MediumInstant {
  public:
    Instant(const SurfaceIndex& index, const SurfaceSpec& spec, const InstantSettings& settings)
        : index_(index), spec_(spec), part_(kPartOfDropoff * settings.step) {
        const double n = 1 + settings.law.ambient +
                         std::max(0.0, settings.law.exaggeration * settings.weight * index.above_ambient(0));
        largest_force_ = std::abs(settings.strength()) * index.largest_slope() * n;
    }

    IndexSample sample(const dvec3& x) const override { return index_.sample(x); }
    IndexJet jet(const dvec3& x) const override { return index_.jet(x); }
    /// The allowed change of height grows above the knee. Over s metres of the ray the height changes by at most
    /// climb s + largest_force s²/2.
    double longest_step(const dvec3& x, const dvec3& d) const override {
        const double h = index_.height(x), within = std::clamp(h, 0.0, index_.top());
        const double change = part_ * (index_.dropoff() + std::max(0.0, within - index_.knee()));
        const double climb = std::abs(index_.climb(d));
        return std::abs(h - within) + 2 * change / (climb + std::sqrt(climb * climb + 2 * largest_force_ * change));
    }
    /// Taken along the normal, the steepest direction.
    double longest_step(const dvec3& x) const override { return longest_step(x, index_.normal()); }
    double clear_way(const dvec3& x, const dvec3& d) const override {
        return way_into_layer(index_.height(x), index_.climb(d), 0, index_.top());
    }
    double way_to_edge(const dvec3& x, const dvec3& d) const override {
        return way_to_plane(index_.height(x), index_.climb(d));
    }
    /// A cube that stands on the surface's origin.
    Box shown_box() const override {
        const double half = 0.5 * kShownHeight * spec_.dropoff;
        const dvec3 center = spec_.origin + half * spec_.normal;
        return {center - dvec3(half), center + dvec3(half)};
    }

  private:
    SurfaceIndex index_;
    SurfaceSpec spec_;
    double part_;           ///< largest change of height in a step [dropoff]
    double largest_force_;  ///< [1/m]
};

}  // namespace

std::string why_still(const SurfaceSpec& spec, const OpticsSpec& optics) {
    const double above = index_law(optics).above_ambient(spec.surface_temperature);
    return above * force_strength(optics) == 0 ? "the surface is at ambient temperature" : "";
}

std::unique_ptr<const Medium> build_medium(const SurfaceSpec& spec, const MediumSetting& setting) {
    return std::make_unique<const SurfaceMedium>(spec, setting);
}

std::optional<GroundPlane> mirage_ground(const SurfaceSpec& spec, const OpticsSpec& optics) {
    if (!why_still(spec, optics).empty()) return {};
    return GroundPlane{spec.origin, glm::normalize(spec.normal)};
}

SurfaceMedium::SurfaceMedium(const SurfaceSpec& spec, const MediumSetting& setting)
    : spec_(spec), index_(spec, index_law(setting.optics)) {}

std::shared_ptr<const MediumInstant> SurfaceMedium::at(double, const InstantSettings& settings) const {
    return std::make_shared<const Instant>(index_, spec_, settings);
}

std::string SurfaceMedium::note() const {
    return fmt::format("{} surface, a layer {:.3g} m high", index_.above_ambient(0) < 0 ? "hot" : "cold", index_.top());
}

}  // namespace eikonal
