/// One medium of a shot in the warp: the model that bends rays through it, its strength, and its displacement at a
/// frame.
///
///     Medium (noise/medium/medium.h)  --make_medium_bend-->  MediumBend  --at(frame)-->  BendInstant  --grids-->
/// tiles
///
/// Some kinds of medium have a quicker way than integration through the interface of a medium. They have a MediumBend
/// of their own in a folder beside this file. All others use any_medium/. The list is in warp/displace/shot_media.cpp.
///
/// Conventions: axial depths in metres; displacement in pixels, x right, y down. Falloff, mask and gain are not
/// included where it is not said. Both classes are immutable and thread-safe. The same arguments give the same bits.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "noise/medium/medium.h"
#include "warp/displace/grid/displacement_grid.h"
#include "warp/displace/grid/model.h"
#include "warp/displace/grid/ray_frame.h"
#include "warp/scene/camera.h"
#include "warp/scene/scene.h"

namespace eikonal {

/// What holds for all media of a shot. It refers to the scene, the settings and the camera path, and must not outlive
/// them.
struct ShotContext {
    const Scene& scene;
    const DisplacerSettings& settings;
    const CameraPath& path;
    Camera reference;  ///< the camera at the first key of its path
    double strength;   ///< factor on ∇n in the force: ray equation and exaggeration
    ForceLaw law;

    bool perspective() const { return reference.projection == Projection::Perspective; }
    bool camera_moves() const { return path.moving(); }
    /// Whether each ray goes through the sum of all media (model second-order).
    bool second_order() const { return settings.model == Model::SecondOrder; }
    /// The model in use, for a medium whose model would otherwise be `usual`.
    Model own_model(Model usual) const { return second_order() ? Model::SecondOrder : usual; }
    /// Axial depth [m] beyond which there is no object. It is a bound from the settings, known before the depth map of
    /// any frame is read.
    double deepest() const { return std::max(settings.far, settings.deepest); }
    PixelWindow picture() const { return {0, 0, settings.width, settings.height}; }
    /// Size in pixels of a metre across the view at axial depth D [m].
    double pixels_per_metre(double D) const { return perspective() ? reference.f_px / D : reference.f_px; }
};

/// What a frame asks of a medium.
struct FrameView {
    const Camera& camera;
    double t;                  ///< [s]
    double nearest, farthest;  ///< range of the axial depths that will be asked for [m]
    double gain = 1;           ///< multiplies the displacement
};

/// Nodes that suit a medium: the spacing in pixels, and the axial depths [m].
struct NodeLayout {
    int spacing = kWidestSpacing;
    std::vector<double> depths;
};

/// One medium at one frame.
class BendInstant {
  public:
    virtual ~BendInstant() = default;

    /// Filled grids for a tile, whose displacements add up. They hold the pixels of `cover`, which lies within or
    /// around the tile. Their values depend on the tile alone. The gain is included. FrameError once a stop is
    /// requested.
    virtual std::vector<DisplacementGrid> grids(const PixelWindow& tile, const PixelWindow& cover) const = 0;
    /// The same, with a node on every pixel of a window.
    virtual std::vector<DisplacementGrid> every_pixel(const PixelWindow& window) const = 0;
    /// A layout whose nodes and depths are as fine as those of all its grids.
    virtual NodeLayout layout() const = 0;
    /// The same air for rays that are followed through it. settings.weight is the gain.
    virtual std::shared_ptr<const MediumInstant> air(const InstantSettings& settings) const = 0;
    /// Size of the cells that an aperture averages over [m]. Nothing if the medium is averaged already, or if its
    /// features are large compared with an aperture.
    virtual std::optional<dvec3> averaged_cells() const { return {}; }
    /// The longest step of bent rays, as a multiple of the step that the medium says is safe.
    virtual double bent_step() const;
    /// Where the medium ends for bent rays (InstantSettings::reach). judge: for rays that judge straight ones. Below:
    /// whether the medium itself should choose the steps if it is the only one.
    virtual std::optional<double> reach(bool judge) const;
    virtual bool chooses_own_steps() const { return false; }
    /// Whether rays through it cost several times as much as through other media.
    virtual bool is_dear() const { return false; }
};

/// A medium whose grids are laid out once a frame and filled tile by tile.
class LaidOutInstant : public BendInstant {
  public:
    std::vector<DisplacementGrid> grids(const PixelWindow& tile, const PixelWindow& cover) const override;
    std::vector<DisplacementGrid> every_pixel(const PixelWindow& window) const override;
    NodeLayout layout() const override;

  protected:
    LaidOutInstant(const Camera& camera, double gain) : camera_(camera), gain_(gain) {}
    /// Adds X and S at every node and depth of a grid whose nodes are zero.
    virtual void fill(DisplacementGrid& grid) const = 0;
    const Camera& camera() const { return camera_; }
    void lay_out(std::vector<DisplacementGrid> blank) { blank_ = std::move(blank); }

  private:
    std::vector<DisplacementGrid> filled(const PixelWindow& cover, bool every_pixel) const;

    Camera camera_;
    double gain_;
    std::vector<DisplacementGrid> blank_;
};

/// What --verbose reports of a medium, and what the user should know, in the order of the lines. `first_…` lines are
/// given even if the medium is then left out.
struct MediumTold {
    std::vector<std::string> first_notes, first_warnings;
    std::string note;
    std::vector<std::string> last_notes, last_warnings;
};

class MediumBend {
  public:
    MediumBend(const ShotContext& shot, std::size_t medium, Model model)
        : shot_(shot), medium_(medium), model_(model) {}
    virtual ~MediumBend() = default;

    std::size_t medium() const { return medium_; }  ///< index in Scene::media
    Model model() const { return model_; }
    const MediumTold& told() const { return told_; }
    /// Whether bounds of its own have already shown that the medium moves something visible.
    virtual bool is_seen_for_sure() const { return false; }

    /// FrameError: a camera or depth of the frame that the model cannot serve.
    virtual std::unique_ptr<const BendInstant> at(const FrameView& frame) const = 0;
    /// Expected variance of |d| over pixels and time [px²], for objects at axial distance D [m]. If `rough`, a quick
    /// estimate is enough.
    virtual double expected_variance(double D, bool rough) const = 0;
    /// Expected variance of ∂d_x/∂x of the map at axial distance D [m]. PHYSICS.md#focusing
    virtual double focusing_variance(double D) const = 0;
    /// Upper bound of the displacement of a ray through the picture's corner, divided by that of the ray on the axis.
    virtual double corner_gain() const;
    /// Approximate size of one instant [bytes].
    virtual double instant_bytes() const { return 0; }
    /// What does not hold for objects as far as `farthest` [m], which is beyond the shot's `far`; one line each.
    virtual std::vector<std::string> beyond_far(double farthest) const;

  protected:
    std::string name() const;  ///< "medium.2"
    const ShotContext& shot_;
    MediumTold told_;

  private:
    std::size_t medium_;
    Model model_;
};

}  // namespace eikonal
