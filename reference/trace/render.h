/// Renders one frame of a scene. Straight rays give the undistorted plate and the depth that the warp takes as input.
/// Bent rays give what a camera in that air sees, and by how much each pixel is displaced.
///
/// Colour is R, G, B (linear) and A = 1, the mean over each pixel's square (box filter). All other planes belong to the
/// ray through the pixel's *centre* and never mix two surfaces:
///     Z               axial depth of the surface seen [m]; infinity for background
/// Bent rays only:
///     length          length of the ray's path to the surface [m]; infinity for background
///     u, v            the pixel where straight rays show the same point, minus this pixel [px]: out(p) = in(p + d), y
///     down.
///                     The background is infinitely far in perspective, unless render() is told otherwise, and at `far`
///                     in orthographic views
///     id              1 + index of the object seen, 0 for background. Black pixels have -1 for a trapped ray
///     (kTrapTurn of
///                     bent_ray.h), -2 for one that came to n <= 0, and -3 for one whose step budget was used up
///     steps           steps of the integrator
///     error           estimated error of u, v [px]
///     magnification   of distant things in area (ray_differential.h), if asked for. Negative: folded, hence mirrored
///
/// The bytes are the same for any number of threads: every sample is a pure function of scene, frame, pixel and its
/// index. A pixel is black without further samples if the rays of its centre and of its first kTriedSamples samples
/// have no end. Radiance is limited to 0 … the largest half, and NaN becomes 0.
///
/// Failures: UserError for the scene (geometry.h, shading.h, camera.h, noise/air/air.h). FrameError if a frame cannot
/// be rendered, or if the render is given up.
#pragma once

#include <functional>

#include "reference/trace/camera_ray.h"
#include "reference/trace/ray_tree.h"
#include "reference/trace/scene_air.h"
#include "reference/trace/shadowgraph.h"
#include "reference/trace/stop.h"
#include "warp/scene/camera.h"

namespace eikonal::reference {

inline constexpr int kTriedSamples = 3;
/// The part of the tolerance with which rays are tried again. The steps' own error estimates do not know how far the
/// air spreads their errors apart.
inline constexpr double kFinerTried = 0.01;

struct RenderSettings {
    int samples = 16;  ///< samples of colour for each pixel >= 1
    bool straight = false;
    RaySettings rays;
    bool magnification = false;
    int light_rays = 0;         ///< rays across a side of each quad (shadowgraph.h). 0: straight sunlight
    bool colour = true;         ///< false: only the planes of pixels' centres
    std::stop_token stop = {};  ///< once requested, a render ends with a FrameError
};

/// Planes of width * height pixels. Those of bent rays are empty for straight ones.
struct RenderedFrame {
    int width = 0, height = 0;
    std::vector<float> color;  ///< R G B A, interleaved
    std::vector<float> depth;  ///< axial [m]
    std::vector<float> length, u, v, id, steps, error, magnification;

    /// How many rays through pixels' centres are trapped or unfinished.
    std::size_t trapped() const;
    /// How many of them used up their step budget.
    std::size_t unfinished() const;
    /// How many came to a place with n <= 0.
    std::size_t without_index() const;
    /// How many have negative magnification.
    std::size_t folded() const;
};

/// How much of a frame a probe tries. It begins with `first` pixels spread over the frame. It doubles their number
/// until there are `most` or `seconds` are over. No ray takes more than `steps`, so a probe is short in any scene.
struct ProbeLimits {
    int first = 64, most = 64;
    double seconds = 0;
    int steps = 2000;
    int samples = 0;  ///< the most samples of colour
};

/// What a few pixels tell about the cost and the accuracy of a frame.
struct Probe {
    RenderedFrame pixels;      ///< the pixels tried, in one row, under straight sunlight
    int samples = 0;           ///< samples of colour for each pixel
    int step_limit = 0;        ///< number of steps that ended the unfinished rays of `pixels`
    double steps_to_come = 0;  ///< steps that those rays would still take, up to their budget
    std::size_t beyond = 0;    ///< how many of those rays would use up their budget
    /// Rays that were tried again with kFinerTried of the tolerance; those of them that were off by more than
    /// kPessimism times the tolerance; and the largest difference [px].
    std::size_t again = 0, off = 0;
    double farthest_off = 0;
    double setup = 0, seconds = 0;  ///< wall time for the media and for the rays [s]

    /// Wall time of `area` pixels with `samples_each` samples [s].
    double time(double area, int samples_each) const;
};

/// Callbacks while a frame is rendered. Each may be empty.
struct FrameWatch {
    std::function<void(const Probe&)> probed;  ///< after the probe of bent rays, before all other rays
    LightWatch light;
    std::function<void()> tiles_begin;
    std::function<void()> tile_done;  ///< after each of tile_count() tiles, from any thread
};

class Renderer {
  public:
    /// Reads meshes and textures and makes the media, once for all frames.
    Renderer(const Scene& scene, const RenderSettings& settings);

    /// background: axial depth at which u and v of a perspective view see the background, as in the warp [m] > 0.
    /// Without it the background is infinitely far.
    RenderedFrame render(int frame, const FrameWatch& watch, std::optional<double> background = {}) const;
    RenderedFrame render(int frame, const std::function<void()>& tile_done = {},
                         std::optional<double> background = {}) const {
        return render(frame, FrameWatch{{}, {}, {}, tile_done}, background);
    }
    int tile_count() const;
    Probe probe(int frame, const ProbeLimits& limits) const;

    int width() const { return width_; }
    int height() const { return height_; }
    /// What each medium was made into. Empty for straight rays.
    std::vector<std::string> notes() const { return air_ ? air_->notes() : std::vector<std::string>{}; }

    /// Index of the sphere or closed mesh that the camera is inside of, if any. The picture shows it from within.
    std::optional<int> camera_inside(int frame) const { return geometry_.object_around(camera(frame).position); }
    /// UserError if bent rays would start below a heated surface, where there is no air. (Straight rays may.)
    void check_camera(int frame) const;
    Camera camera(int frame) const { return path_.at(frame); }

  private:
    struct Tile {
        int x0, y0, x1, y1;
    };
    struct FrameAir;
    int tile_size() const;
    std::optional<FrameAir> air_at(int frame, const Camera& camera) const;
    RenderedFrame planes(int width, int height, bool colour) const;
    Probe try_rays(const Camera& camera, int frame, FrameAir* air, const ProbeLimits& limits) const;
    void try_again(const Camera& camera, int frame, FrameAir& air, Probe& probe) const;
    double longest_way(const Camera& camera, double open) const;
    RayEnds ray_ends() const;
    void render_tile(const Camera& camera, int frame, const Tile& tile, const FrameAir* air, RenderedFrame& into) const;
    BentHit render_pixel(const Camera& camera, int frame, int x, int y, const FrameAir* air, int samples, std::size_t i,
                         RenderedFrame& into) const;
    dvec3 colour(const Camera& camera, int frame, int x, int y, const FrameAir* air, int samples, bool has_end) const;
    void center_straight(const Camera& camera, int x, int y, std::size_t i, RenderedFrame& into) const;
    BentHit center_bent(const Camera& camera, int x, int y, const FrameAir& air, std::size_t i,
                        RenderedFrame& into) const;
    double steps_to_come(const Camera& camera, int x, int y, const FrameAir& air, const BentHit& tried) const;

    Scene scene_;
    RenderSettings settings_;
    int width_, height_;
    CameraPath path_;
    Geometry geometry_;
    Shading shading_;
    std::optional<SceneAir> air_;  ///< none for straight rays
};

}  // namespace eikonal::reference
