/// One medium of a shot in the warp: which model bends rays through it, how strongly, and the displacement of a frame.
///
///     Medium (noise/medium/medium.h)  --make_medium_bend-->  MediumBend  --at(frame)-->  BendInstant  --grids-->
/// tiles
///
/// Kinds of medium that have a quicker way than integrating their interface have a MediumBend of their own in a folder
/// beside this one; all others take any_medium/. The list is in warp/displace/shot_media.cpp.
///
/// Conventions: axial depths in metres, displacement in pixels, x right, y down. Before any falloff, mask or gain where
/// not stated. Both classes are immutable and thread-safe; the same arguments give the same bits.
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

/// What a shot settles for all its media. It refers to the scene, the settings and the camera path, and must not
/// outlive them.
struct ShotContext {
    const Scene& scene;
    const DisplacerSettings& settings;
    const CameraPath& path;
    Camera reference;  ///< the shot's first
    double strength;   ///< multiplies ∇n in the force
    ForceLaw law;

    bool perspective() const { return reference.projection == Projection::Perspective; }
    bool camera_moves() const { return path.moving(); }
    /// Whether rays are followed through all media together.
    bool second_order() const { return settings.model == Model::SecondOrder; }
    /// The model of a medium that would take `usual` by itself.
    Model own_model(Model usual) const { return second_order() ? Model::SecondOrder : usual; }
    /// Axial depth beyond which there is no object, as far as is known before any frame's depth map is read [m].
    double deepest() const { return std::max(settings.far, settings.deepest); }
    PixelWindow picture() const { return {0, 0, settings.width, settings.height}; }
    /// Pixels that a metre across the ray at depth D shows as.
    double pixels_per_metre(double D) const { return perspective() ? reference.f_px / D : reference.f_px; }
};

/// A frame's request.
struct FrameView {
    const Camera& camera;
    double t;                  ///< [s]
    double nearest, farthest;  ///< axial depths that will be asked for [m]
    double gain = 1;           ///< multiplies the displacement
};

/// Nodes that suit a medium: the spacing in pixels, and the axial depths [m].
struct NodeLayout {
    int spacing = kWidestSpacing;
    std::vector<double> depths;
};

/// One frame of one medium.
class BendInstant {
  public:
    virtual ~BendInstant() = default;

    /// Filled grids for a tile: their pixels are those of `cover`, which lies within or around it. They depend on the
    /// tile alone, and add up. Gain included. FrameError once a stop is requested.
    virtual std::vector<DisplacementGrid> grids(const PixelWindow& tile, const PixelWindow& cover) const = 0;
    /// The same with a node on every pixel of a window.
    virtual std::vector<DisplacementGrid> every_pixel(const PixelWindow& window) const = 0;
    /// Nodes as fine as those of all its grids.
    virtual NodeLayout layout() const = 0;
    /// The same air as rays are followed through it. settings.weight is the gain.
    virtual std::shared_ptr<const MediumInstant> air(const InstantSettings& settings) const = 0;
    /// Cells that an aperture averages over [m]; nothing if the medium is averaged already, or is smooth beside a lens.
    virtual std::optional<dvec3> averaged_cells() const { return {}; }
    /// The longest steps of bent rays, in those that the medium says are safe.
    virtual double bent_step() const;
    /// Where the medium ends for bent rays, and for those that judge straight ones (InstantSettings::reach); and
    /// whether steps through it alone are best chosen by the medium itself.
    virtual std::optional<double> reach(bool judge) const;
    virtual bool chooses_own_steps() const { return false; }
    /// Whether rays through it cost several times as much as through other media.
    virtual bool is_dear() const { return false; }
};

/// Grids that are laid out once a frame and filled tile by tile.
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

/// What --verbose should tell of a medium, and what the user should know: in the order of telling. `first` is told even
/// of a medium that is then left out.
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
    /// Whether the kind has decided already, by bounds of its own, that it moves something that is seen.
    virtual bool is_seen_for_sure() const { return false; }

    /// FrameError: what a frame's camera or depth make impossible.
    virtual std::unique_ptr<const BendInstant> at(const FrameView& frame) const = 0;
    /// Expected variance of |d| over pixels and time [px²] for objects at axial distance D; if `rough`, a quick figure
    /// will do.
    virtual double expected_variance(double D, bool rough) const = 0;
    /// Expected variance of ∂d_x/∂x of the map at axial distance D. PHYSICS.md#focusing
    virtual double focusing_variance(double D) const = 0;
    /// How many times a ray through the picture's corner is displaced as far as the one along the axis, at most.
    virtual double corner_gain() const;
    /// Bytes of one instant, about.
    virtual double instant_bytes() const { return 0; }
    /// What does not hold for objects as far as `farthest` [m], which is beyond the shot's far.
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
