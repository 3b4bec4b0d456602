/// The air of a scene at any frame, for the tracer: the field of index, and the settings by which rays are followed.
///
/// Frame F is at t = (F - first_frame)/fps. Thin screens stand before the camera of the shot's first key, out to the
/// plate's far distance, exactly where `eikonal warp` places them for the same scene.
#pragma once

#include "reference/trace/baselines.h"
#include "warp/scene/camera.h"

namespace eikonal::reference {

/// The most steps of a ray. Rays of samples/ take at most 600 at a tolerance of 1e-6 px. A kilometre of a fine lattice
/// takes 40000.
inline constexpr int kStepBudget = 100000;

/// Length of path after which a ray that met nothing ends [m], unless the scene goes farther.
inline constexpr double kFarthestSight = 1e6;

/// How rays are followed.
struct RaySettings {
    Integrator integrator = Integrator::Adaptive;
    double tolerance_px = 0.01;     ///< of the final displacement [px] > 0
    double step = 0;                ///< see TraceSettings
    int step_budget = kStepBudget;  ///< the most steps of a ray
};

/// How far rays go, and how far off they may be at their end. Lattices are made fine enough for this. All are > 0.
struct RayEnds {
    double way = 1;                                              ///< [m]
    double tolerance = std::numeric_limits<double>::infinity();  ///< [rad] as seen from the start, or [m]
    bool seen_from_start = true;                                 ///< whether tolerance is an angle
};

/// Immutable, thread-safe.
class SceneAir {
  public:
    /// Keeps a reference to the scene. UserError as in noise/air/air.h and camera.h, and for media that the integrator
    /// cannot follow.
    SceneAir(const Scene& scene, const RaySettings& settings, const RayEnds& ends = {});

    AirInstant at(int frame) const { return air_.at(time(frame)); }
    /// What each medium was made into (Air::notes).
    std::vector<std::string> notes() const { return air_.notes(); }
    /// Greatest distance from a point to any part of a bounded medium [m].
    double farthest_part(const dvec3& from) const { return air_.farthest_part(from); }
    /// Seconds since the scene's first frame.
    double time(int frame) const;
    TraceSettings trace_settings(const Camera& camera) const;

    /// The first heated or cooled surface that the point does not lie above. There is no air at such a point. depth:
    /// how far below the surface it lies [m] >= 0.
    struct Below {
        std::size_t medium;
        double depth;
    };
    std::optional<Below> below_surface(const dvec3& at) const;

    const CameraPath& path() const { return path_; }
    int width() const { return width_; }
    int height() const { return height_; }

  private:
    const Scene& scene_;
    RaySettings settings_;
    int width_, height_;
    double far_;  ///< far distance of the scene [m]
    CameraPath path_;
    Air air_;
    std::shared_ptr<const LoneSurface> lone_;
};

}  // namespace eikonal::reference
