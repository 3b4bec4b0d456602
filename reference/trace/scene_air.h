/// The air of a scene at any frame, as the tracer's rays need it: its field of index and how rays are to be followed.
///
/// Frame F is at t = (F - first_frame)/fps; thin screens stand before the camera of the shot's first key, out to the
/// plate's far distance, exactly as `eikonal warp` places them for the same scene.
#pragma once

#include "reference/trace/baselines.h"
#include "warp/scene/camera.h"

namespace eikonal::reference {

/// Steps of a ray. Those of samples/ take 600 at most, at a tolerance of 1e-6 px; a kilometre of a fine lattice 40000.
inline constexpr int kStepBudget = 100000;

/// Length of path after which a ray has met nothing [m], if the scene states no farther.
inline constexpr double kFarthestSight = 1e6;

/// How rays are followed.
struct RaySettings {
    Integrator integrator = Integrator::Adaptive;
    double tolerance_px = 0.01;     ///< of the final displacement [px] > 0
    double step = 0;                ///< see TraceSettings
    int step_budget = kStepBudget;  ///< of every ray
};

/// How far rays go, and what they may be off by as they end, which lattices are made fine enough for: all > 0.
struct RayEnds {
    double way = 1;                                              ///< [m]
    double tolerance = std::numeric_limits<double>::infinity();  ///< [rad], seen from where they start, or [m]
    bool seen_from_start = true;                                 ///< which of both
};

/// The distance at which the warp sees the scene's background [m].
double far_distance(const Scene& scene);

/// Immutable, thread-safe.
class SceneAir {
  public:
    /// Keeps a reference to the scene. UserError: noise/air/air.h, camera.h, and media that the integrator cannot
    /// follow.
    SceneAir(const Scene& scene, const RaySettings& settings, const RayEnds& ends = {});

    AirInstant at(int frame) const { return field_.at(time(frame)); }
    /// What each medium has been made into (Air::notes).
    const std::vector<std::string>& notes() const { return field_.notes(); }
    /// Seconds since the scene's first frame.
    double time(int frame) const;
    TraceSettings trace_settings(const Camera& camera) const;

    /// The first heated or cooled surface that the point does not lie above, and how far below it that is [m] >= 0:
    /// there is no air.
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
    double far_;  ///< of the scene
    CameraPath path_;
    Air field_;
    std::shared_ptr<const LoneSurface> lone_;
};

}  // namespace eikonal::reference
