#include "warp/displace/media/gradient_noise/gradient_noise_bend.h"

#include <fmt/format.h>

#include "warp/displace/media/ray_steps.h"
#include "warp/displace/media/sampled_variance.h"
#include "warp/displace/models/first_order.h"
#include "warp/displace/models/second_order.h"

namespace eikonal {
namespace {

/// A step is half an inner scale long, but at most this part of the finest octave's cell.
constexpr double kPartOfCell = 0.75;

class Instant final : public LaidOutInstant {
  public:
    Instant(std::shared_ptr<const GradientNoiseMedium> noise, const FirstOrderRays& rays, const FrameView& frame)
        : LaidOutInstant(frame.camera, frame.gain), noise_(std::move(noise)), rays_(rays), t_(frame.t) {
        lay_out({rays_.grid(frame.camera, frame.nearest, frame.farthest)});
    }
    std::shared_ptr<const MediumInstant> air(const InstantSettings& settings) const override {
        return noise_->at(t_, settings);
    }
    std::optional<dvec3> averaged_cells() const override { return rays_.cell; }
    double bent_step() const override { return kNoiseStep; }

  private:
    struct AtTime {
        const GradientNoiseField& field;
        double t;
        IndexSample sample(const dvec3& x) const { return field.sample(x, t); }
    };
    void fill(DisplacementGrid& grid) const override { rays_.fill(grid, camera(), AtTime{noise_->field(), t_}); }

    std::shared_ptr<const GradientNoiseMedium> noise_;
    FirstOrderRays rays_;
    double t_;  ///< [s]
};

}  // namespace

GradientNoiseBend::GradientNoiseBend(const ShotContext& shot, std::size_t medium,
                                     std::shared_ptr<const GradientNoiseMedium> noise)
    : MediumBend(shot, medium, shot.own_model(Model::FirstOrder)),
      noise_(std::move(noise)),
      cell_(std::min(0.5 * noise_->spec().inner_scale, kPartOfCell * noise_->field().smallest_cell())) {
    if (std::string warning = check_steps(shot, name(), cell_); !warning.empty())
        told_.first_warnings.push_back(std::move(warning));
    told_.note = fmt::format("{}: model {}, not periodic", name(),
                             shot.second_order() ? "second-order (through all media together)"
                                                 : "first-order (gradient noise has no other)");
}

std::unique_ptr<const BendInstant> GradientNoiseBend::at(const FrameView& frame) const {
    const DisplacerSettings& settings = shot_.settings;
    if (shot_.camera_moves() || is_beyond(frame.farthest, settings.far))
        check_frame_steps(shot_, name(), cell_, frame.camera, std::max(frame.farthest, settings.far));
    return std::make_unique<const Instant>(
        noise_, FirstOrderRays{shot_.strength, cell_, shot_.scene.optics.aperture, settings.far, settings.stop}, frame);
}

double GradientNoiseBend::expected_variance(double D, bool) const {
    return sampled_variance(shot_, *this, D, D * glm::length(shot_.reference.forward / cell_)).shift;
}

double GradientNoiseBend::focusing_variance(double D) const {
    return sampled_variance(shot_, *this, D, D * glm::length(shot_.reference.forward / cell_)).slope;
}

std::vector<std::string> GradientNoiseBend::beyond_far(double farthest) const {
    std::string line = many_steps_beyond(shot_, name(), cell_, farthest, model());
    if (line.empty()) return {};
    return {std::move(line)};
}

}  // namespace eikonal
