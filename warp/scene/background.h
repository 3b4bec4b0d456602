/// Where a shot's background is: what a depth map calls infinite, and what no object hides.
///
/// Air without bounds bends rays on all their way, so the background needs a distance. Over a heated surface it lies
/// behind all that is in sight: a mirage shows what is far, and a sky that stood before the ground's horizon would have
/// mirrored rays end on the ground beneath it.
///
/// This is the one place that decides the distance: for the warp with its settings, for the tracer, for the comparison.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "warp/pixels/depth_range.h"
#include "warp/scene/scene.h"

namespace eikonal {

/// Distance of the background where nothing states it and surfaces are all that bends, for which no distance costs
/// anything [m].
inline constexpr double kDefaultSky = 1e6;

/// Whether there is a surface that is not at ambient temperature.
bool has_mirage(const Scene& scene);

/// kDefaultFar, or kDefaultSky for a scene of surfaces only.
double default_far(const Scene& scene);

/// How the depth of a shot is known, beside its scene. All distances are axial [m] > 0.
struct KnownDepth {
    /// Depth of a map, which differs from pixel to pixel, or of flat ground; else one distance holds for all pixels.
    enum class Kind { Constant, Ground, Map } kind = Kind::Constant;
    std::optional<double> distance;       ///< Constant: as set; left out: the scene's
    std::optional<double> farthest_code;  ///< Map: the farthest that its codes can say, where they have a range
    std::optional<double> far;            ///< of the background, as set; left out: the scene's
};

/// The background of a shot.
struct Background {
    double far = kDefaultFar;  ///< its axial distance [m]
    /// No object is beyond [m]: `far`, or at least kInfiniteDepth where a map tells the depth and nothing limits it.
    double deepest = kDefaultFar;
    bool stated = false;    ///< `far` is no default
    bool in_scene = false;  ///< the scene's plate.far is there
    bool mirage = false;    ///< has_mirage(): where objects are behind `far`, the background is behind them

    /// One that objects may be beyond: a map's without limits.
    bool is_open() const { return deepest > far; }
    /// What states `far`, for messages.
    std::string_view stated_by() const { return in_scene ? "the scene's plate.far =" : "the default `far`"; }
    /// Where maps have the background whose farthest depth is `farthest` [m].
    double behind(double farthest) const { return mirage && farthest > far ? farthest : far; }
};

/// The first that is stated of: `far`, the distance of everything, the farthest code, the scene's plate.far, a default.
Background background_of(const Scene& scene, const KnownDepth& known);

/// One distance for all pixels, where known.kind is Constant [m].
double constant_distance(const Scene& scene, const KnownDepth& known);

/// The distance that the scene alone states: plate.far, else plate.distance, else a default [m].
double far_of_scene(const Scene& scene);

/// Where a map's finite depths go on behind its background, which is at `far`, puts that at the farthest of them [m].
void put_background_behind(std::vector<float>& metres, double far);

}  // namespace eikonal
