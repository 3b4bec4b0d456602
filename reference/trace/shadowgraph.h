/// Sunlight that hot air has bent on its way: the bright and dark pattern (caustics, shadowgraph) that it casts on
/// walls, by tracing rays forward from the sun (*added*; the paper's future work).
///
/// For every quad of the scene, parallel rays of the sun's direction, on a grid of `light_rays` a side (and some
/// beyond its outline), start before the media and are followed bent to the surface that they meet first. Those that
/// meet the quad bring their light to a map upon it, one texel a kRaysPerTexel rays a side, spread over the nearest
/// four. The map holds the irradiance over what the sun brings unobstructed, so 0 is shadow and a focus is bright. Each
/// ray stands for the same flux, hence energy is conserved: heat only moves light about.
///
/// The sun counts as a point; other shapes than quads are lit by straight rays. Rays start `reach` before the quad, the
/// greatest distance from it of: camera, quads, the bounds of spheres and Luneburg lenses, and where blobs may be. Air
/// without bounds, which is everywhere, bends light from there on only.
#pragma once

#include <functional>

#include "reference/trace/bent_ray.h"
#include "reference/trace/cancel.h"
#include "warp/scene/scene.h"

namespace eikonal::reference {

inline constexpr int kRaysPerTexel = 4;
inline constexpr int kMostLightRays = 8192;

/// Told while light rays are followed; either may be left out.
struct LightWatch {
    std::function<void(int object, int rows)> begins;  ///< a quad, of which so many rows of rays are followed
    std::function<void()> row_done;                    ///< from any thread
};

/// Immutable, thread-safe. The same for any number of threads.
class Shadowgraph {
  public:
    /// light_rays: 2 kRaysPerTexel … kMostLightRays. scene.light must be set. FrameError: cancelled.
    Shadowgraph(const Scene& scene, const Geometry& geometry, const AirInstant& field, const TraceSettings& trace,
                int light_rays, Cancelled cancelled = nullptr, const LightWatch& watch = {});

    /// Irradiance over that of the unobstructed sun at a hit: nothing for objects that have no map.
    std::optional<double> irradiance(const Hit& hit) const;

  private:
    struct Map {
        int object = 0, side = 0;   ///< texels a side
        std::vector<float> values;  ///< row by row of v
        double at(double u, double v) const;
    };
    std::vector<Map> maps_;
};

}  // namespace eikonal::reference
