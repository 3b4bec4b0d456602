/// Air over a heated or cooled plane as a medium.
#pragma once

#include <memory>
#include <string>

#include "noise/medium/medium.h"
#include "noise/surface/surface.h"
#include "noise/surface/surface_spec.h"

namespace eikonal {

class SurfaceMedium final : public Medium {
  public:
    SurfaceMedium(const SurfaceSpec& spec, const MediumSetting& setting);

    std::shared_ptr<const MediumInstant> at(double t, const InstantSettings& settings) const override;
    std::string note() const override;
    std::optional<GroundPlane> ground() const override { return GroundPlane{spec_.origin, spec_.normal}; }

    const SurfaceIndex& index() const { return index_; }
    const SurfaceSpec& spec() const { return spec_; }

  private:
    SurfaceSpec spec_;
    SurfaceIndex index_;
};

}  // namespace eikonal
