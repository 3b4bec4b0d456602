#include "reference/trace/scene_air.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "noise/base/memory.h"
#include "warp/pixels/depth_range.h"
#include "warp/scene/background.h"
#include "warp/scene/screen_view.h"

namespace eikonal::reference {
namespace {

/// What interpolation may bend a ray by after 1 m [m^-1/2], to be off by half of the tolerance as it ends.
double bend_error(const RayEnds& ends) {
    return 0.5 * ends.tolerance / kMostOfRms / (std::sqrt(ends.way / 3) * (ends.seen_from_start ? 1 : ends.way));
}

Air make_field(const Scene& scene, const RayEnds& ends, const CameraPath& path, int width, int height) {
    const Camera camera = path.reference();
    const ShotFrame frame{camera.position, camera.right, camera.up, camera.forward,
                          screen_view(camera, width, height, scene.optics.aperture, far_distance(scene),
                                      scene.time.fps.value_or(kDefaultFps))};
    return Air(scene.media, scene.optics, frame, memory_limit(), bend_error(ends));
}

}  // namespace

double far_distance(const Scene& scene) {
    return scene.plate.far.value_or(scene.plate.distance.value_or(default_far(scene)));
}

SceneAir::SceneAir(const Scene& scene, const RaySettings& settings, const RayEnds& ends)
    : scene_(scene),
      settings_(settings),
      width_(scene.camera.resolution.value_or(kDefaultResolution)[0]),
      height_(scene.camera.resolution.value_or(kDefaultResolution)[1]),
      far_(far_distance(scene)),
      path_(scene.camera, width_, height_),
      field_(make_field(scene, ends, path_, width_, height_)) {
    if (scene.media.size() == 1)
        if (const auto* surface = std::get_if<SurfaceSpec>(&scene.media.front()))
            lone_ = std::make_shared<LoneSurface>(*surface, scene.optics);
    baseline_surface(settings.integrator, scene.media);  // refuses what the integrator cannot do before any frame
}

double SceneAir::time(int frame) const {
    return (static_cast<double>(frame) - scene_.time.first_frame) / scene_.time.fps.value_or(kDefaultFps);
}

std::optional<SceneAir::Below> SceneAir::below_surface(const dvec3& at) const {
    for (std::size_t i = 0; i < scene_.media.size(); ++i) {
        const auto* surface = std::get_if<SurfaceSpec>(&scene_.media[i]);
        if (!surface || surface->surface_temperature == scene_.optics.ambient_temperature) continue;
        const double height = glm::dot(at - surface->origin, glm::normalize(surface->normal));
        if (!(height > 0)) return Below{i, 0.0 - height};
    }
    return {};
}

TraceSettings SceneAir::trace_settings(const Camera& camera) const {
    TraceSettings trace;
    trace.integrator = settings_.integrator;
    trace.tolerance_px = settings_.tolerance_px;
    trace.perspective = camera.projection == Projection::Perspective;
    trace.pixel = 1 / camera.f_px;
    trace.step = settings_.step;
    trace.step_budget = settings_.step_budget;
    trace.end_trapped = true;
    trace.far = std::max(kFarthestSight, 10 * far_);
    trace.surface = baseline_surface(settings_.integrator, scene_.media);
    trace.lone = lone_;
    return trace;
}

}  // namespace eikonal::reference
