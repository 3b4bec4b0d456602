/// Which model bends the rays through which medium: the media of a scene, each with the field that its form calls for
/// and the model that reads it, made once a shot.
///
///     medium           models (first: the default)
///     screens          screens
///     lattice          spectral (orthographic view along a lattice axis), else first-order; also table, tables
///     gradient-noise   first-order
///     blobs            first-order, in closed form
///     surface          exact bending in two dimensions (mirage.h), whatever the model
///
/// second-order, if asked for, takes all media but surfaces together: one ray through their sum.
///
/// What cannot move any pixel by `negligible` is left out, and a note says so. Failures: UserError for media and models
/// that do not go together, for fields that do not fit into memory, for first-order paths of too many cells, and for
/// media that are expected to move pixels by more than kLargestShift. FrameError from instant() for paths of too many
/// cells that a camera turns to later, or that a frame's depth asks for.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "noise/blobs/blobs.h"
#include "noise/medium/refractivity.h"
#include "noise/turbulence/screens/screens.h"
#include "warp/displace/grid/model.h"
#include "warp/displace/media/blobs/seen_blobs.h"
#include "warp/displace/media/surface/mirage.h"
#include "warp/displace/models/first_order.h"
#include "warp/displace/models/lattice_tables.h"
#include "warp/displace/models/second_order.h"
#include "warp/displace/models/thin_screens.h"
#include "warp/scene/camera.h"

namespace eikonal {

/// One medium and its model.
struct MediumLayer {
    std::size_t medium = 0;  ///< index in Scene::media
    Model model = Model::Screens;
    std::variant<ScreenField, LatticeField, GradientNoiseField, BlobCloud> field;
    dvec3 cell{1, 1, 1};  ///< of the field [m], first-order
    double constant = 0;  ///< c of `table`
    int padding = 1;      ///< of the splines of a lattice
    int ray_padding = 1;  ///< of the spline that rays of second-order go through
    /// SplineError::bend, where map and rays go through the same spline.
    double bend_error = 0;
};

/// A layer frozen at one time, or all of them as one.
using LayerInstant = std::variant<ThinScreens, DisplacementTables, FirstOrderRays, SeenBlobs, BentRays>;

/// Empty grids for a layer's instant; blobs have theirs made tile by tile.
std::vector<DisplacementGrid> blank_grids(const LayerInstant& layer, const Camera& camera, double nearest,
                                          double farthest);

class MediaLayers {
  public:
    MediaLayers(const Scene& scene, const DisplacerSettings& settings, const CameraPath& path);

    const std::vector<MediumLayer>& layers() const { return layers_; }
    /// Heated or cooled surfaces and their index in Scene::media.
    const std::vector<std::pair<std::size_t, SurfaceSpec>>& surfaces() const { return surfaces_; }
    /// The same, in that order.
    const std::vector<SurfaceIndex>& surface_layers() const { return surface_layers_; }
    const IndexLaw& law() const { return law_; }

    LayerInstant instant(const MediumLayer& layer, const Camera& camera, double t, double nearest, double farthest,
                         double gain) const;
    /// Of all layers, in their order.
    std::vector<LayerInstant> instants(const Camera& camera, double t, double nearest, double farthest,
                                       double gain) const;
    /// Whether the layers' rays go through all of them together (second-order).
    bool second_order() const { return settings_.model == Model::SecondOrder; }
    /// Rays through the sum of the layers: the nodes' rays of second-order or, if `reference`, through the surfaces,
    /// too, and in finer steps than second-order's own if that is the model: what any model is judged by. own:
    /// instants() with the same arguments. gain multiplies every n - n_ambient but the surfaces'. This must outlive it.
    BentRays together(const std::vector<LayerInstant>& own, const Camera& camera, double t, double nearest,
                      double farthest, double gain, bool reference) const;

    /// Variance of |d| [px²] that a layer is expected to have for objects at axial distance D, before any falloff, over
    /// pixels and time; of many blobs at the shot's beginning only where a rough figure will do.
    double expected_variance(const MediumLayer& layer, double D, bool rough = false) const;
    /// Variance of ∂d_x/∂x of a layer's map at axial distance D (PHYSICS.md#focusing), before any falloff: of lattices
    /// as for rays along their axis nearest to the view, of gradient noise and blobs from neighbouring pixels.
    double focusing_variance(const MediumLayer& layer, double D) const;
    /// Bytes of one instant of everything, about.
    std::uint64_t instant_bytes() const;

    /// Displacer's.
    std::vector<std::string> beyond_far(double farthest) const;

    const std::vector<std::string>& notes() const { return notes_; }
    const std::vector<std::string>& warnings() const { return warnings_; }

  private:
    Model own(Model usual) const { return second_order() ? Model::SecondOrder : usual; }
    bool perspective() const { return reference_.projection == Projection::Perspective; }
    void add(std::size_t i, const TurbulenceSpec& spec);
    void add(std::size_t i, const BlobsSpec& spec);
    void add(std::size_t i, const SurfaceSpec& spec);
    void add(std::size_t i, const ProfileSpec& spec);
    void check_camera_stays_above(const SurfaceSpec& spec, const std::string& name) const;
    void add_screens(std::size_t i, const TurbulenceSpec& spec);
    void add_lattice(std::size_t i, const TurbulenceSpec& spec);
    void add_noise(std::size_t i, const TurbulenceSpec& spec);
    Model choose_model(std::size_t i, const TurbulenceSpec& spec, const PathRays& rays, std::string& why) const;
    /// Keeps a layer unless it is too weak to see. UserError if it is too strong for any map.
    void keep(MediumLayer layer, std::string note);
    /// How many times a ray through the picture's corner is displaced as far as the one along the axis, at most.
    double corner_gain(Model model) const;
    /// Keeps it, and warns of folding rays.
    void add_layer(MediumLayer layer);
    /// Cells [m] that the picture's most oblique ray crosses a metre of depth.
    double cells_a_metre(const Camera& camera, const dvec3& cell) const;
    /// Warns of, or refuses, first-order rays of too many steps through cells [m].
    void check_steps(std::size_t i, const dvec3& cell);
    /// FrameError if those of a frame's camera and depth are too many.
    void check_frame_steps(std::size_t i, const dvec3& cell, const Camera& camera, double farthest) const;
    /// What nothing lies behind, as far as is known before the depth of the frames is [m].
    double deepest() const;
    void refuse_other_model() const;
    struct SampledVariance {
        double shift = 0;  ///< of |d| [px²]
        double slope = 0;  ///< of ∂d_x/∂x and ∂d_y/∂y, pixel to pixel
    };
    SampledVariance sampled_variance(const MediumLayer& layer, double D) const;
    /// Of |d| among blobs [px²], over so many instants at most and so many rays, about.
    double blob_variance(const MediumLayer& layer, double D, int instants, int rays) const;

    /// Variance of the slopes where blobs are, at t = 0: within 1.5 σ of the middle of one taken at random.
    double blob_focusing(const MediumLayer& layer, double D) const;

    FieldPart part_of(const MediumLayer& layer, const LayerInstant& instant, double t) const;

    const Scene& scene_;
    const DisplacerSettings& settings_;
    const CameraPath& path_;
    bool camera_moves_;
    double most_blobs_ = 0;  ///< at a time, of the media so far
    Camera reference_;
    double strength_;
    IndexLaw law_;
    std::vector<MediumLayer> layers_;
    std::vector<std::pair<std::size_t, SurfaceSpec>> surfaces_;
    std::vector<SurfaceIndex> surface_layers_;
    std::vector<std::string> surface_names_;  ///< for messages
    std::vector<Mirage> reference_mirages_;   ///< as the reference camera sees them
    std::vector<std::string> notes_, warnings_;
};

/// Rays that the expected rms and focusing of gradient noise and blobs are estimated from, fewer where they are long.
inline constexpr int kRmsRays = 256;

}  // namespace eikonal
