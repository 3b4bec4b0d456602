/// Displacement maps of a scene. Media, a camera and a depth give the displacement (dx, dy) of every pixel, of any
/// frame and in any order.
///
///     out(p) = in(p + d(p)),   d = f_px x1⊥(D)/D        (PHYSICS.md#first-order)
///
/// A Displacer is made once a shot and is immutable. at(F) prepares the media at frame F; it sums the spectra over κ
/// and transforms them. Instant::map fills a window of pixels. Frame F depends on the scene, its settings and F alone,
/// and not on other frames, on threads or on the window asked for.
///
/// Every medium is computed by the model that suits it (warp/displace/shot_media.h), and the displacements of all media
/// are added. The gain multiplies the displacements of all media except surfaces. A mirage follows from the geometry of
/// its rays; [optics] exaggeration strengthens it.
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

class Air;

class Displacer {
  public:
    /// UserError: media or models that do not apply, lattices that do not fit into memory, a faulty camera path.
    /// air: that of another Displacer of the same scene and settings, whose model may differ; null: it is built.
    Displacer(const Scene& scene, const DisplacerSettings& settings, std::shared_ptr<const Air> air = {});
    ~Displacer();
    Displacer(Displacer&&) noexcept;

    /// All media at one frame, ready to be mapped. Thread-safe. It must not outlive the Displacer.
    class Instant {
      public:
        /// Writes the displacement of every pixel of `window` into `uv`, as window.area() interleaved pairs. Tiles are
        /// computed in parallel. The values are finite for every finite depth > 0. FrameError once the settings' `stop`
        /// is requested, and if a pixel would move by more than kLargestShift.
        void map(const PixelWindow& window, const DepthSource& depth, DepthMeeting meeting, float* uv) const;

        /// The error of a map that map() made with the same arguments. settings.sample_errors must be true.
        /// FrameError as map().
        StatedError stated_error(const PixelWindow& window, const DepthSource& depth, DepthMeeting meeting,
                                 const float* uv) const;
        /// The errors of `samples` single pixels of the map [px].
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

    /// The media at a frame. frame: any real number; shutter samples lie between whole frames. `nearest`, `farthest`:
    /// the range of axial depths that map() will be asked for [m].
    Instant at(double frame, double nearest, double farthest, double gain = 1) const;
    /// Approximate size of one instant [bytes]. Computing it may take as much again for a while.
    std::uint64_t instant_bytes() const;

    /// Expected root mean square of |d| [px] over pixels and time, for an object at axial distance D [m]. The media
    /// have their strength before any falloff. For gradient noise and blobs it is estimated from kRmsRays rays.
    double expected_rms(double D) const;

    /// Expected variance of ∂d_x/∂x of the map for objects at axial distance D [m], which measures the focusing of
    /// light (PHYSICS.md#focusing). Near 1 rays fold. The media have their strength before any falloff. For gradient
    /// noise and blobs it is estimated from pairs of pixels; for blobs these lie where the blobs are. Mirages are not
    /// counted, because their rays always fold.
    double focusing_variance(double D) const;

    /// Notes for --verbose: one line for each medium with its model, the reason for it and its sizes, or why the medium
    /// is left out.
    const std::vector<std::string>& notes() const;
    /// What the user should know, one line each: rays that fold, paths longer than a lattice period.
    const std::vector<std::string>& warnings() const;
    /// Warnings about the air itself, one line each. They matter only if the displacement is shown.
    const std::vector<std::string>& air_warnings() const;
    /// What does not hold for objects as far as `farthest` [m], one line each. Empty if `farthest` is not beyond the
    /// settings' far.
    std::vector<std::string> beyond_far(double farthest) const;
    /// Names of the models in use, in the order of the media.
    std::vector<std::string> models() const;

    /// Whether the scene has surfaces that bend rays. These are computed exactly and take no model.
    bool mirages() const;

    Camera camera(double frame) const;
    /// The media, which displacers of one shot may share.
    const std::shared_ptr<const Air>& air() const;

  private:
    struct Shot;
    std::unique_ptr<Shot> shot_;
};

}  // namespace eikonal
