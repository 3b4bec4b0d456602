/// The models of displacement, the settings that all models of a shot share, and the limit of what is visible.
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

/// The models, from the cheapest to the dearest.
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

/// Focusing variance above which the user is warned that rays fold.
inline constexpr double kFolding = 0.5;
/// Focusing variance above which not even second-order holds.
inline constexpr double kHopelessFolding = 10;

/// A part of the air may be left out if it moves no pixel by more than this [px]. The limit holds for a medium, and for
/// the sum of all parts that are left out of one medium.
inline constexpr double kNegligibleShift = 0.002;
/// Largest component of a displacement that a map may hold [px]. A map that would exceed it is refused.
inline constexpr double kLargestShift = 1e6;

/// The settings of a shot that the footage and the command line state, and not the scene.
struct DisplacerSettings {
    int width = 0, height = 0;  ///< size of the display window [px]
    double pixel_aspect = 1;
    double fps = kDefaultFps;   ///< frame F is at t = (F - first_frame)/fps
    std::optional<double> fov;  ///< overrides the scene's camera
    /// Axial distance [m] > 0 of the background. Thin screens fill the air up to it. Tables, sizes and warnings are
    /// settled once a shot and hold up to it.
    double far = 0;
    double deepest = 0;  ///< largest depth of an object [m], if it may exceed `far`
    /// The pixels that maps may be asked for, if they exceed the display window. Called at most once a shot, and only
    /// if there are media outside of that window.
    std::function<PixelWindow()> overscan;
    std::optional<Model> model;  ///< used for every medium that it suits; if left out: each medium's default
    /// Media that move no pixel by more than this before any gain are left out [px] >= 0.
    double negligible = kNegligibleShift;
    bool sample_errors = false;  ///< whether stated_error() will be called
    std::stop_token stop;        ///< once requested, work ends with a FrameError
};

/// Whether a depth exceeds `far` by more than the rounding of a float.
inline bool is_beyond(double depth, double far) {
    return depth > far * (1 + 1e-6);
}

/// FrameError if a stop has been requested. It costs little compared with a ray.
inline void check_stop(const std::stop_token& stop) {
    if (stop.stop_requested()) throw FrameError(kStopped);
}

}  // namespace eikonal
