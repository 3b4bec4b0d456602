#include "noise/turbulence/gradient_noise/gradient_noise_medium.h"

#include <tbb/parallel_for.h>

#include <utility>

#include "noise/turbulence/parameters/falloff_bounds.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {
namespace {

/// A step is at most this part of the finest octave's cell.
constexpr double kPartOfCell = 0.5;

class Instant final : public MediumInstant {
  public:
    Instant(std::shared_ptr<const GradientNoiseField> field, double t)
        : bounds_{field->falloff(), kPartOfCell * field->smallest_cell()}, field_(std::move(field)), t_(t) {}

    IndexSample sample(const dvec3& x) const override { return field_->sample(x, t_); }
    IndexJet jet(const dvec3& x) const override { return field_->jet(x, t_); }
    double longest_step(const dvec3& x, const dvec3&) const override { return bounds_.longest_step(x); }
    double clear_way(const dvec3& x, const dvec3& d) const override { return bounds_.clear_way(x, d); }
    double way_to_edge(const dvec3& x, const dvec3& d) const override { return bounds_.way_to_edge(x, d); }

  private:
    FalloffBounds bounds_;
    std::shared_ptr<const GradientNoiseField> field_;
    double t_;  ///< [s]
};

}  // namespace

GradientNoiseMedium::GradientNoiseMedium(const TurbulenceSpec& spec, const MediumSetting&)
    : spec_(spec), field_(std::make_shared<const GradientNoiseField>(spec)) {}

std::shared_ptr<const MediumInstant> GradientNoiseMedium::at(double t, const InstantSettings&) const {
    return std::make_shared<const Instant>(field_, t);
}

FieldSlices GradientNoiseMedium::slices(double t, const ForceLaw& law) const {
    const std::array<int, 4> size = spec_.lattice.value_or(std::array{kFieldSamples, kFieldSamples, kFieldSamples, 1});
    const double side = 2 * spec_.outer_scale;
    const std::array<double, 4> period = spec_.period.value_or(std::array{side, side, side, 0.0});
    const dvec3 spacing{period[0] / size[0], period[1] / size[1], period[2] / size[2]};
    FieldSlices slices{size[2], size[0], size[1], {}, [=](int z) { return z * spacing.z; }, {}};
    slices.fill = [=, field = field_](int z, std::span<float> values) {
        tbb::parallel_for(0, size[1], [&](int row) {
            for (int x = 0; x < size[0]; ++x) {
                const IndexSample s = field->sample(spacing * dvec3(x, size[1] - 1 - row, z), t);
                float* out =
                    &values[kFieldChannels * (static_cast<std::size_t>(row) * static_cast<std::size_t>(size[0]) +
                                              static_cast<std::size_t>(x))];
                out[0] = static_cast<float>(law.exaggeration * s.n);
                for (int c = 0; c < 3; ++c) out[c + 1] = static_cast<float>(law.strength() * s.gradient[c]);
            }
        });
    };
    slices.describe({0, 0, 0, 0}, spacing, t);
    return slices;
}

}  // namespace eikonal
