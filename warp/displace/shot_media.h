/// All media of a shot in the warp. The air is built once, and each medium gets the model that suits it.
///
/// Surfaces (mirages) bend rays exactly and take no model; they are held apart. Every other medium has a MediumBend.
/// Media that move no pixel are left out, with a note.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "noise/air/air.h"
#include "noise/surface/surface_medium.h"
#include "warp/displace/media/medium_bend.h"
#include "warp/displace/media/surface/mirage.h"
#include "warp/displace/models/second_order.h"

namespace eikonal {

/// The air of a shot for the warp, without the splines of lattices, which the warp makes itself. UserError: what a kind
/// of medium refuses, and a medium of absolute index.
std::shared_ptr<const Air> build_shot_air(const Scene& scene, const DisplacerSettings& settings,
                                          const CameraPath& path);

class ShotMedia {
  public:
    /// UserError: media or models that do not apply, a medium too strong for any map, a camera below a surface.
    /// air: of build_shot_air with the same arguments but for the model, or null to build it.
    ShotMedia(const Scene& scene, const DisplacerSettings& settings, const CameraPath& path,
              std::shared_ptr<const Air> air = {});
    ShotMedia(const ShotMedia&) = delete;  // the media refer to shot_

    const ShotContext& context() const { return shot_; }
    const std::shared_ptr<const Air>& air() const { return air_; }
    const std::vector<std::unique_ptr<const MediumBend>>& bends() const { return bends_; }
    /// A heated or cooled surface, and its index in Scene::media.
    struct Surface {
        std::size_t index;
        std::shared_ptr<const SurfaceMedium> medium;
    };
    const std::vector<Surface>& surfaces() const { return surfaces_; }
    /// Whether each ray goes through the sum of all media (model second-order).
    bool second_order() const { return shot_.second_order(); }

    /// Every medium at one frame, in the order of bends().
    std::vector<std::unique_ptr<const BendInstant>> at(const FrameView& frame) const;
    /// Rays through the sum of the media, as second-order follows them. If `judge`, they are the rays that any map is
    /// judged by. Those go through the surfaces too, and their steps are finer than those of second-order if that is
    /// the model. own: the result of at(frame). The gain multiplies n - n_ambient of every medium except surfaces.
    BentRays bent_rays(const std::vector<std::unique_ptr<const BendInstant>>& own, const FrameView& frame,
                       bool judge) const;
    /// The mirages as the camera of a frame sees them. UserError: the camera is not above a surface.
    std::vector<Mirage> mirages(const Camera& camera, double farthest) const;

    /// Approximate size of one instant of all media [bytes].
    std::uint64_t instant_bytes() const;
    /// As Displacer::beyond_far.
    std::vector<std::string> beyond_far(double farthest) const;
    const std::vector<std::string>& notes() const { return notes_; }
    const std::vector<std::string>& warnings() const { return warnings_; }
    /// Warnings of the media themselves, whether or not they are seen.
    const std::vector<std::string>& air_warnings() const { return air_warnings_; }

  private:
    void add(std::size_t i, const std::shared_ptr<const Medium>& medium);
    void add_surface(std::size_t i, std::shared_ptr<const SurfaceMedium> medium);
    void keep(std::unique_ptr<const MediumBend> bend);
    void warn_of_folding(const MediumBend& bend);
    void check_camera_stays_above(std::size_t i, const GroundPlane& ground) const;
    void refuse_other_model() const;

    ShotContext shot_;
    std::shared_ptr<const Air> air_;
    std::vector<std::unique_ptr<const MediumBend>> bends_;
    std::vector<Surface> surfaces_;
    std::vector<std::string> surface_names_;  ///< for messages
    std::vector<Mirage> reference_mirages_;   ///< the mirages as the reference camera sees them
    std::vector<std::string> notes_, warnings_, air_warnings_;
};

}  // namespace eikonal
