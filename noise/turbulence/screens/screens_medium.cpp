#include "noise/turbulence/screens/screens_medium.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "noise/turbulence/parameters/turbulence_spec.h"
#include "noise/turbulence/screens/screen_force.h"
#include "noise/turbulence/screens/screen_layout.h"

namespace eikonal {
namespace {

const ShotFrame& frame_of(const MediumSetting& setting) {
    if (!setting.frame) throw std::logic_error("ScreensMedium: thin screens without a shot's frame");
    return *setting.frame;
}

ScreenField make_field(const TurbulenceSpec& spec, const MediumSetting& setting) {
    const ShotFrame& frame = frame_of(setting);
    std::vector<ScreenGeometry> geometry = layout_screens(spec, frame.view);
    check_screens(spec, geometry, setting.budget->memory);
    setting.budget->take_memory(screens_bytes(spec, geometry));
    return ScreenField(spec, std::move(geometry), frame.right, frame.up);
}

/// One screen's values, on as many samples as the largest screen has.
void fill_slice(const ScreenInstant& screen, const ScreenGeometry& g, const ForceLaw& law, int width, int height,
                std::span<float> values) {
    tbb::parallel_for(0, height, [&](int row) {
        for (int x = 0; x < width; ++x) {
            const auto s = screen.sample(x * g.Lx / g.nx, (height - 1 - row) * g.Ly / g.ny);
            float* out = &values[kFieldChannels * (static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                                                   static_cast<std::size_t>(x))];
            out[0] = static_cast<float>(law.exaggeration * double{s.value} / g.thickness);
            out[1] = static_cast<float>(law.strength() * double{s.dx} / g.thickness);
            out[2] = static_cast<float>(law.strength() * double{s.dy} / g.thickness);
            out[3] = 0;
        }
    });
}

}  // namespace

ScreensMedium::ScreensMedium(const TurbulenceSpec& spec, const MediumSetting& setting)
    : spec_(spec), frame_(frame_of(setting)), field_(make_field(spec, setting)) {}

std::shared_ptr<const MediumInstant> ScreensMedium::around(std::vector<ScreenInstant> screens,
                                                           const InstantSettings& settings) const {
    return std::make_shared<const ScreenForce>(field_, std::move(screens), frame_, spec_.falloff, settings.strength());
}

std::shared_ptr<const MediumInstant> ScreensMedium::at(double t, const InstantSettings& settings) const {
    return around(field_.at(t), settings);
}

std::string ScreensMedium::note() const {
    const std::vector<ScreenGeometry>& screens = field_.screens();
    const ScreenGeometry& middle = screens[screens.size() / 2];
    return fmt::format("{} thin screens of {} x {} x {} samples, {:.3g} m apart", screens.size(), middle.nx, middle.ny,
                       middle.nt, middle.thickness);
}

FieldSlices ScreensMedium::slices(double t, const ForceLaw& law) const {
    const std::vector<ScreenGeometry>& geometry = field_.screens();
    auto screens = std::make_shared<const std::vector<ScreenInstant>>(field_.at(t));
    FieldSlices slices;
    slices.count = static_cast<int>(geometry.size());
    for (const ScreenGeometry& g : geometry) {
        slices.width = std::max(slices.width, g.nx);
        slices.height = std::max(slices.height, g.ny);
    }
    slices.position = [geometry](int m) { return geometry[static_cast<std::size_t>(m)].w; };
    slices.fill = [=, width = slices.width, height = slices.height](int m, std::span<float> values) {
        const auto i = static_cast<std::size_t>(m);
        fill_slice((*screens)[i], geometry[i], law, width, height, values);
    };
    const ScreenGeometry& g = geometry.front();
    slices.describe({g.Lx, g.Ly, 0, g.T}, {g.Lx / g.nx, g.Ly / g.ny, g.thickness}, t);
    return slices;
}

}  // namespace eikonal
