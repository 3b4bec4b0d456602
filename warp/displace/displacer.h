/// Displacement maps of a scene: media × camera × depth → (dx, dy) in pixels, for any frame, at random.
///
///     out(p) = in(p + d(p)),   d = f_px x1⊥(D)/D        (PHYSICS.md#first-order)
///
/// A Displacer is made once a shot and is immutable; at(F) prepares an instant (spectra summed over κ, transformed);
/// Instant::map fills a window of pixels. Frame F depends on the scene, its settings and F alone: not on other frames,
/// threads, or the window asked for.
///
/// Every medium is handled by the model that suits it (warp/displace/shot_media.h), and their displacements add. Gain
/// multiplies them, but for mirages: those are geometry, and [optics] exaggeration makes more of them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "warp/displace/depth/depth_meeting.h"
#include "warp/displace/depth/depth_source.h"
#include "warp/displace/grid/model.h"
#include "warp/displace/stated_error.h"
#include "warp/scene/camera.h"
#include "warp/scene/scene.h"

namespace eikonal {

class Displacer {
  public:
    /// UserError: media or models that do not apply, lattices that do not fit into memory, a broken camera path.
    Displacer(const Scene& scene, const DisplacerSettings& settings);
    ~Displacer();
    Displacer(Displacer&&) noexcept;

    /// One frame's media, ready to be mapped. Thread-safe; must not outlive the Displacer.
    class Instant {
      public:
        /// Displacement of every pixel of `window` into `uv`: window.area() interleaved pairs. Tiles in parallel.
        /// Finite for every finite depth > 0. FrameError once the settings' `stop` is requested, and if a pixel would
        /// move by more than kLargestShift.
        void map(const PixelWindow& window, const DepthSource& depth, DepthMeeting meeting, float* uv) const;

        /// The error of a map that map() made with the same arguments. The settings must ask for it (sample_errors).
        /// FrameError as map().
        StatedError stated_error(const PixelWindow& window, const DepthSource& depth, DepthMeeting meeting,
                                 const float* uv) const;
        /// The same, `samples` errors one by one [px].
        std::vector<double> sampled_errors(const PixelWindow& window, const DepthSource& depth, DepthMeeting meeting,
                                           const float* uv, int samples) const;

        const Camera& camera() const;
        Instant(Instant&&) noexcept;
        ~Instant();

      private:
        friend class Displacer;
        struct State;
        explicit Instant(std::unique_ptr<State> state);
        std::unique_ptr<State> state_;
    };

    /// frame: any real number (shutter samples lie between frames). `nearest`, `farthest`: axial depths that map() will
    /// be asked for.
    Instant at(double frame, double nearest, double farthest, double gain = 1) const;
    /// Bytes of one instant, about, and at most needed for a while.
    std::uint64_t instant_bytes() const;

    /// Expected root mean square of |d| in pixels, over pixels and time, for an object at axial distance D at the
    /// strength that the media have before any falloff. Gradient noise and blobs: estimated from kRmsRays rays.
    double expected_rms(double D) const;

    /// Expected variance of the focusing of light from distance D (PHYSICS.md#focusing), ∂d_x/∂x of the map, at the
    /// strength that the media have before any falloff: near 1 rays fold. Gradient noise and blobs: estimated from
    /// pairs of pixels, those of blobs where blobs are. Mirages, which fold
    /// by nature, are not counted.
    double focusing_variance(double D) const;

    /// For --verbose: one line a medium: its model and why, its sizes; and what is left out.
    const std::vector<std::string>& notes() const;
    /// One line each: what the user should know of (folding rays, paths beyond a lattice period).
    const std::vector<std::string>& warnings() const;
    /// The same of the air itself, which matters only where displacement is shown at all.
    const std::vector<std::string>& air_warnings() const;
    /// One line each on what does not hold for objects as far as `farthest` [m], beyond the settings' far; none if it
    /// is not beyond.
    std::vector<std::string> beyond_far(double farthest) const;
    /// Names of the models in use, in the order of the media.
    std::vector<std::string> models() const;

    /// Whether surfaces bend rays, exactly and by no model.
    bool mirages() const;

    Camera camera(double frame) const;

  private:
    struct Shot;
    std::unique_ptr<Shot> shot_;
};

}  // namespace eikonal
