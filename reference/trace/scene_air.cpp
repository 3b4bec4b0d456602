#include "reference/trace/scene_air.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "noise/base/memory.h"
#include "noise/surface/surface_spec.h"
#include "warp/pixels/depth_range.h"
#include "warp/scene/background.h"
#include "warp/scene/shot_view.h"

namespace eikonal::reference {
namespace {

/// The bend by interpolation after 1 m [m^-1/2] for which a ray is off by half of the tolerance at its end.
double bend_error(const RayEnds& ends) {
    return 0.5 * ends.tolerance / kMostOfRms / (std::sqrt(ends.way / 3) * (ends.seen_from_start ? 1 : ends.way));
}

Air make_air(const Scene& scene, const RayEnds& ends, const CameraPath& path, int width, int height) {
    const ShotFrame frame = shot_frame(path.reference(), width, height, scene.optics.aperture, far_of_scene(scene),
                                       scene.time.fps.value_or(kDefaultFps));
    return Air(scene.media, scene.optics, {frame, memory_limit(), bend_error(ends)});
}

}  // namespace

SceneAir::SceneAir(const Scene& scene, const RaySettings& settings, const RayEnds& ends)
    : scene_(scene),
      settings_(settings),
      width_(scene.camera.resolution.value_or(kDefaultResolution)[0]),
      height_(scene.camera.resolution.value_or(kDefaultResolution)[1]),
      far_(far_of_scene(scene)),
      path_(scene.camera, width_, height_),
      air_(make_air(scene, ends, path_, width_, height_)) {
    if (scene.media.size() == 1)
        if (const auto* surface = scene.media.front().get_if<SurfaceSpec>())
            lone_ = std::make_shared<LoneSurface>(*surface, scene.optics);
    baseline_surface(settings.integrator,
                     scene.media);  // throws here, before any frame, if the integrator cannot follow the media
}

double SceneAir::time(int frame) const {
    return (static_cast<double>(frame) - scene_.time.first_frame) / scene_.time.fps.value_or(kDefaultFps);
}

std::optional<SceneAir::Below> SceneAir::below_surface(const dvec3& at) const {
    for (std::size_t i = 0; i < scene_.media.size(); ++i) {
        const std::optional<GroundPlane> ground = scene_.media[i].mirage_ground(scene_.optics);
        if (!ground) continue;
        const double height = ground->height(at);
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
