#include "warp/displace/media/screens/screens_bend.h"

#include <fmt/format.h>

#include <cmath>

#include "noise/turbulence/screens/screen_layout.h"
#include "warp/displace/models/thin_screens.h"

namespace eikonal {
namespace {

/// A note is given if thin screens have less than this part of the displacement that they should have.
constexpr double kNoticedPart = 0.97;

class Instant final : public LaidOutInstant {
  public:
    Instant(std::shared_ptr<const ScreensMedium> medium, ThinScreens screens, const FrameView& frame)
        : LaidOutInstant(frame.camera, frame.gain), medium_(std::move(medium)), screens_(std::move(screens)) {
        lay_out(screens_.grids(frame.camera, frame.nearest, frame.farthest));
    }
    std::shared_ptr<const MediumInstant> air(const InstantSettings& settings) const override {
        return medium_->around(screens_.screens, settings);
    }

  private:
    void fill(DisplacementGrid& grid) const override { screens_.fill(grid, camera()); }

    std::shared_ptr<const ScreensMedium> medium_;
    ThinScreens screens_;
};

}  // namespace

ScreensBend::ScreensBend(const ShotContext& shot, std::size_t medium, std::shared_ptr<const ScreensMedium> screens)
    : MediumBend(shot, medium, shot.own_model(Model::Screens)), screens_(std::move(screens)) {
    const std::vector<ScreenGeometry>& geometry = screens_->field().screens();
    const ScreenGeometry& middle = geometry[geometry.size() / 2];
    const double far = shot.settings.far;
    told_.note = fmt::format(
        "{}: model {} ({} view): {} screens of {} x {} x {} samples over {:g} m, {:.3g} m apart, periods {:.3g} x "
        "{:.3g} m, {:.3g} s",
        name(), name_of(model()), shot.perspective() ? "perspective" : "orthographic", geometry.size(), middle.nx,
        middle.ny, middle.nt, far, middle.thickness, middle.Lx, middle.Ly, middle.T);
    const double lost = screens_->field().lost_angle_variance(far),
                 kept = screens_->field().displacement_angle_variance(far);
    if (const double part = std::sqrt(kept / (kept + lost)); part < kNoticedPart)
        told_.last_notes.push_back(fmt::format(
            "{}: eddies finer than a pixel are left out; what is left displaces objects at {:g} m by {:.2g} of what "
            "all would: a larger picture, or a longer lens, shows more",
            name(), far, part));
    if (const double along = glm::dot(screens_->spec().velocity, shot.reference.forward); along != 0)
        told_.last_notes.push_back(fmt::format(
            "{}: the wind's part along the view axis ({:.3g} m/s) does not move thin screens", name(), along));
}

std::unique_ptr<const BendInstant> ScreensBend::at(const FrameView& frame) const {
    return std::make_unique<const Instant>(
        screens_, ThinScreens{screens_->field().at(frame.t), shot_.reference, shot_.strength, screens_->spec().falloff},
        frame);
}

double ScreensBend::expected_variance(double D, bool) const {
    const double pixels = shot_.pixels_per_metre(D), aspect = shot_.reference.pixel_aspect;
    return shot_.strength * shot_.strength * (1 + aspect * aspect) * screens_->field().displacement_angle_variance(D) *
           (pixels * D) * (pixels * D);
}

double ScreensBend::focusing_variance(double D) const {
    return shot_.strength * shot_.strength * screens_->field().focusing_variance(D, shot_.perspective());
}

double ScreensBend::corner_gain() const {
    if (model() != Model::Screens) return MediumBend::corner_gain();
    const double L = straight_ray(shot_.reference, 0, 0).length;
    return L * L * std::sqrt(L);
}

double ScreensBend::instant_bytes() const {
    double bytes = 0;
    for (const ScreenGeometry& g : screens_->field().screens())
        bytes += sizeof(float) * (1.0 * g.nx * g.ny + 3.0 * kCoarseSide * kCoarseSide);
    return bytes;
}

std::vector<std::string> ScreensBend::beyond_far(double) const {
    return {
        fmt::format("{}: its thin screens end there, and what is behind them moves as if the air did, too", name())};
}

}  // namespace eikonal
