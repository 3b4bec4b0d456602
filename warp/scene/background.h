/// The distance of a shot's background. The background is what a depth map calls infinite, and what no object hides.
///
/// Unbounded air bends rays all along their path, so the background needs a distance. Over a heated surface it must lie
/// behind everything in sight. A mirage shows distant things. If the sky were nearer than the horizon of the ground,
/// mirrored rays would reach the ground below the sky instead of the sky.
///
/// The distance is decided here alone: for the warp with its settings, for the tracer and for the comparison.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "warp/pixels/depth_range.h"
#include "warp/scene/scene.h"

namespace eikonal {

/// Default distance of the background if only surfaces bend rays [m]. For those no distance takes more time.
inline constexpr double kDefaultSky = 1e6;

/// Whether a surface of the scene has another temperature than the ambient.
bool has_mirage(const Scene& scene);

/// kDefaultFar, or kDefaultSky for a scene that has only surfaces.
double default_far(const Scene& scene);

/// What is known of a shot's depth in addition to its scene. All distances are axial [m] > 0.
struct KnownDepth {
    /// Constant: one distance holds for all pixels. Ground: flat ground. Map: the depth map of each frame.
    enum class Kind { Constant, Ground, Map } kind = Kind::Constant;
    std::optional<double> distance;       ///< Constant: the distance as set; if left out, the scene's
    std::optional<double> farthest_code;  ///< Map: the farthest depth that its codes can state, if they have a range
    std::optional<double> far;            ///< distance of the background as set; if left out, the scene's
};

/// The background of a shot.
struct Background {
    double far = kDefaultFar;  ///< its axial distance [m]
    /// No object is farther than this [m]. It is `far`, or at least kInfiniteDepth if a map states depth without limit.
    double deepest = kDefaultFar;
    bool stated = false;    ///< whether `far` was stated, and is not a default
    bool in_scene = false;  ///< whether the scene states plate.far
    bool mirage = false;    ///< has_mirage(): the background moves behind objects that are farther than `far`

    /// Whether objects may be farther than the background. This is so for a map without limits.
    bool is_open() const { return deepest > far; }
    /// The words for what states `far`, for messages.
    std::string_view stated_by() const { return in_scene ? "the scene's plate.far =" : "the default `far`"; }
    /// Distance of the background in a map whose farthest depth is `farthest` [m].
    double behind(double farthest) const { return mirage && farthest > far ? farthest : far; }
};

/// The background of a shot. Its distance is the first of these that is stated: `far`, the distance of all pixels, the
/// farthest code of the map, the scene's plate.far, a default.
Background background_of(const Scene& scene, const KnownDepth& known);

/// The one distance of all pixels [m], where known.kind is Constant.
double constant_distance(const Scene& scene, const KnownDepth& known);

/// The distance that the scene states without other settings: plate.far, else plate.distance, else a default [m].
double far_of_scene(const Scene& scene);

/// Moves the background of a map, which is at `far`, to the farthest finite depth of the map if that is farther [m].
void put_background_behind(std::vector<float>& metres, double far);

}  // namespace eikonal
