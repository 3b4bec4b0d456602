/// The models of displacement, what a shot settles for all of them, and what counts as too little to see.
/// Theory: PHYSICS.md#focusing.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <stop_token>
#include <string_view>
#include <utility>

#include "noise/base/error.h"
#include "warp/pixels/linear_image.h"
#include "warp/scene/scene.h"

namespace eikonal {

/// Cheapest first.
enum class Model { Table, Tables, Spectral, Screens, FirstOrder, SecondOrder };

inline constexpr std::array<std::pair<std::string_view, Model>, 6> kModelNames{{{"table", Model::Table},
                                                                                {"tables", Model::Tables},
                                                                                {"spectral", Model::Spectral},
                                                                                {"screens", Model::Screens},
                                                                                {"first-order", Model::FirstOrder},
                                                                                {"second-order", Model::SecondOrder}}};
constexpr std::string_view name_of(Model model) {
    for (const auto& [name, value] : kModelNames)
        if (value == model) return name;
    return "";
}

/// Focusing variance from which folding rays are warned of.
inline constexpr double kFolding = 0.5;
/// From here on not even second-order holds.
inline constexpr double kHopelessFolding = 10;

/// A medium, or the dropped parts of one, that together move no pixel by more than this are left out [px].
inline constexpr double kNegligibleShift = 0.002;
/// Largest component of a displacement that a map may hold [px]; what would exceed it is refused, not cut.
inline constexpr double kLargestShift = 1e6;

/// What the scene leaves to the footage and the command line.
struct DisplacerSettings {
    int width = 0, height = 0;  ///< of the display window
    double pixel_aspect = 1;
    double fps = kDefaultFps;   ///< frame F is at t = (F - first_frame)/fps
    std::optional<double> fov;  ///< overrides the scene's camera
    /// Axial distance [m] > 0 of the background: thin screens fill the air up to it, and what is settled once a shot
    /// (tables, sizes, warnings) holds up to it.
    double far = 0;
    double deepest = 0;  ///< of any object [m], if that may be farther than `far`
    /// Pixels that maps may be asked for, where they are not the display window's alone. Called if media outside of
    /// that are there, once a shot.
    std::function<PixelWindow()> overscan;
    std::optional<Model> model;  ///< for every medium that it suits; left out: each medium's default
    /// Media that move no pixel by more than this before any gain are left out [px] >= 0.
    double negligible = kNegligibleShift;
    bool sample_errors = false;  ///< stated_error() will be asked for
    std::stop_token stop;        ///< once requested, work ends with a FrameError
};

/// Whether a depth lies beyond `far`, rounding to float aside.
inline bool is_beyond(double depth, double far) {
    return depth > far * (1 + 1e-6);
}

/// FrameError if a stop has been requested. Cheap beside a ray.
inline void check_stop(const std::stop_token& stop) {
    if (stop.stop_requested()) throw FrameError(kStopped);
}

}  // namespace eikonal
