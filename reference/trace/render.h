/// Renders one frame of a scene: with straight rays, the undistorted plate and the depth that the warp takes as input;
/// with bent ones, what a camera in that air sees, and by how much every pixel is displaced.
///
/// Output: colour R, G, B (linear) and A = 1, the mean over each pixel's square (box filter). Everything else belongs
/// to the ray through the pixel's *centre* and never mixes two surfaces:
///     Z          axial depth of the surface seen [m]; infinity where there is only background
///     length     of the ray's path to it [m]; infinity likewise                                   (bent rays, here and
///     below) u, v       pixel where straight rays show that same point, minus this pixel: out(p) = in(p + d), y down
///     [px].
///                Background is infinitely far in perspective, unless render() is told, at `far` in orthographic
///                views
///     id         1 + index of the object seen, 0 for background; black: -1 for a ray that gets nowhere (kTrapTurn of
///                bent_ray.h), -2 for one that came to where n <= 0, -3 for one that its step budget ended
///     steps      of the integrator
///     error      its estimate of the error of u, v [px]
///     magnification   (if asked for) of distant things, in area; negative: folded, mirrored (ray_differential.h)
///
/// The same bytes for any number of threads: every sample is a pure function of scene, frame, pixel and its index.
/// Where a pixel's centre and its first kTriedSamples samples have no end the others are taken to have none: black.
/// Not finite radiance never leaves: it is limited to 0 … the largest half.
///
/// Failures: UserError for the scene (geometry.h, shading.h, camera.h, noise/air/air.h), FrameError when a frame cannot
/// be rendered or is given up (cancel.h).
#pragma once

#include <functional>

#include "reference/trace/cancel.h"
#include "reference/trace/ray_tree.h"
#include "reference/trace/scene_air.h"
#include "reference/trace/shadowgraph.h"
#include "warp/scene/camera.h"

namespace eikonal::reference {

inline constexpr int kTriedSamples = 3;
/// Part of the tolerance that rays are tried again with: steps' own estimates do not know how far apart the air spreads
/// what they err by.
inline constexpr double kFinerTried = 0.01;

struct RenderSettings {
    int samples = 16;  ///< of colour a pixel >= 1
    bool straight = false;
    RaySettings rays;
    bool magnification = false;
    int light_rays = 0;  ///< across a side of each quad, for the shadowgraph (shadowgraph.h); 0: straight sunlight
    bool colour = true;  ///< false: only what belongs to pixels' centres
    Cancelled cancelled = nullptr;
};

/// Planes of width * height pixels. Those of bent rays are empty for straight ones.
struct RenderedFrame {
    int width = 0, height = 0;
    std::vector<float> color;  ///< R G B A, interleaved
    std::vector<float> depth;  ///< axial [m]
    std::vector<float> length, u, v, id, steps, error, magnification;

    /// Rays through pixels' centres that gave no answer: those that get nowhere or that their budget ended, of them the
    /// latter, and those that came to where n <= 0. And those that were folded.
    std::size_t trapped() const;
    std::size_t unfinished() const;
    std::size_t without_index() const;
    std::size_t folded() const;
};

/// How much of a frame is tried: pixels spread over it, `first` of them, then as many again and again until there are
/// `most` or `seconds` are over. Whatever the scene, that is soon: no ray takes more than `steps`.
struct ProbeLimits {
    int first = 64, most = 64;
    double seconds = 0;
    int steps = 2000;
    int samples = 0;  ///< of colour, at most
};

/// What a frame will be like.
struct Probe {
    RenderedFrame pixels;      ///< those tried, in one row, under straight sunlight
    int samples = 0;           ///< of colour a pixel
    int step_limit = 0;        ///< what ended the rays that `pixels` count as unfinished
    double steps_to_come = 0;  ///< that those rays would still take, up to their budget
    std::size_t beyond = 0;    ///< of them, those that would use up their budget
    /// Of rays tried again with kFinerTried of the tolerance: how many, how many were off by more than kPessimism times
    /// the tolerance, and by how much at most [px].
    std::size_t again = 0, off = 0;
    double farthest_off = 0;
    double setup = 0, seconds = 0;  ///< wall time: of the media, of the rays

    /// Wall time of so many pixels [s].
    double time(double area, int samples_each) const;
};

/// What is told while a frame is rendered; any may be left out.
struct FrameWatch {
    std::function<void(const Probe&)> probed;  ///< of bent rays through pixels' centres, before all others
    LightWatch light;
    std::function<void()> tiles_begin;
    std::function<void()> tile_done;  ///< after each of tile_count() tiles, from any thread
};

class Renderer {
  public:
    /// Reads meshes and textures, and makes the media, once for all frames.
    Renderer(const Scene& scene, const RenderSettings& settings);

    /// background: axial depth at which u and v of a perspective view see the background, as the warp does [m] > 0;
    /// infinitely far if it is not given.
    RenderedFrame render(int frame, const FrameWatch& watch, std::optional<double> background = {}) const;
    RenderedFrame render(int frame, const std::function<void()>& tile_done = {},
                         std::optional<double> background = {}) const {
        return render(frame, FrameWatch{{}, {}, {}, tile_done}, background);
    }
    int tile_count() const;
    Probe probe(int frame, const ProbeLimits& limits) const;

    int width() const { return width_; }
    int height() const { return height_; }
    /// What becomes of each medium; nothing for straight rays.
    std::vector<std::string> notes() const { return air_ ? air_->notes() : std::vector<std::string>{}; }

    /// Object index of a sphere or closed mesh that the camera is inside of: the picture shows it from within.
    std::optional<int> camera_inside(int frame) const { return geometry_.object_around(camera(frame).position); }
    /// UserError if bent rays would start below a heated surface, where no air is. (Straight ones may.)
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

/// The straight ray of a pixel position: origin and direction. The direction is not of unit length but has axial
/// component 1, so that a distance along it is an axial depth.
struct CameraRay {
    dvec3 origin, direction;
};
CameraRay camera_ray(const Camera& camera, double px, double py);

/// How camera_ray changes from pixel to pixel: of the origin, and of the unit direction.
Bundle pixel_bundle(const Camera& camera, double px, double py);

}  // namespace eikonal::reference
