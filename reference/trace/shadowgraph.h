/// Sunlight that hot air has bent: the bright and dark pattern (caustics, a shadowgraph) that it casts on walls. Rays
/// are traced forward from the sun (*added*; future work in the paper).
///
/// Every quad of the scene gets a grid of parallel rays in the sun's direction: `light_rays` a side, and some beyond
/// the quad's outline. They start before the media and are followed, bent, to the first surface. A ray that meets the
/// quad brings its light to a map on the quad and spreads it over the nearest four texels. A texel is kRaysPerTexel
/// rays wide. The map holds the irradiance divided by that of the unobstructed sun: 0 is shadow, and a focus is bright.
/// Every ray stands for the same flux, so energy is conserved: heat only moves light about.
///
/// The sun counts as a point. Shapes other than quads are lit by straight rays. Rays start at the distance `reach`
/// before the quad: the greatest distance from the quad to the camera, to other quads, to the bounds of spheres and
/// Luneburg lenses, and to the places where blobs may be. Air without bounds bends light only from there on.
/// Theory: PHYSICS.md#tracer.
#pragma once

#include <functional>

#include "reference/trace/bent_ray.h"
#include "reference/trace/scene_air.h"
#include "reference/trace/stop.h"
#include "warp/scene/scene.h"

namespace eikonal::reference {

inline constexpr int kRaysPerTexel = 4;
inline constexpr int kMostLightRays = 8192;

/// Callbacks while light rays are followed. Each may be empty.
struct LightWatch {
    std::function<void(int object, int rows)> begins;  ///< a quad begins, with this number of rows of rays
    std::function<void()> row_done;                    ///< from any thread
};

/// Immutable, thread-safe. The maps are the same for any number of threads.
class Shadowgraph {
  public:
    /// light_rays: 2 kRaysPerTexel … kMostLightRays. scene.light must be set. FrameError once a stop is requested.
    Shadowgraph(const Scene& scene, const Geometry& geometry, const SceneAir& air, const AirInstant& field,
                const TraceSettings& trace, int light_rays, const std::stop_token& stop = {},
                const LightWatch& watch = {});

    /// Irradiance at a hit, divided by that of the unobstructed sun. Nothing for objects without a map.
    std::optional<double> irradiance(const Hit& hit) const;

  private:
    struct Map {
        int object = 0, side = 0;   ///< side: texels along a side
        std::vector<float> values;  ///< row by row of v
        double at(double u, double v) const;
    };
    std::vector<Map> maps_;
};

}  // namespace eikonal::reference
