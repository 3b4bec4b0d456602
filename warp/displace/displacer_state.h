/// What an instant of a Displacer holds. Internal: displacer.cpp makes maps of it, displacer_errors.cpp judges them.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "warp/displace/displacer.h"
#include "warp/displace/shot_media.h"

namespace eikonal {

/// FrameError unless all n values are numbers of at most kLargestShift in magnitude.
void refuse_beyond(const float* v, std::size_t n);

struct Displacer::Instant::State {
    const ShotMedia* media;
    Camera camera;
    double t, nearest, farthest, gain;
    std::stop_token stop;
    int tile_width, tile_height;
    std::vector<std::unique_ptr<const BendInstant>> own;  ///< of every medium that takes a model
    std::optional<BentRays> joint;                        ///< of second-order: the rays that bend instead
    std::vector<Mirage> mirages;

    mutable std::once_flag judged;
    mutable std::optional<BentRays> judge;  ///< of maps; made when first asked for

    FrameView view() const { return {camera, t, nearest, farthest, gain}; }
    const BentRays& reference() const {
        std::call_once(judged, [&] { judge.emplace(media->bent_rays(own, view(), true)); });
        return *judge;
    }
    std::vector<DisplacementGrid> tile_grids(const PixelWindow& tile, const PixelWindow& cover) const;
    /// Those that may move a pixel of the window.
    std::span<const Mirage> mirages_on(const PixelWindow& window) const {
        const bool any =
            std::any_of(mirages.begin(), mirages.end(), [&](const Mirage& m) { return m.touches(window); });
        return any ? mirages : std::span<const Mirage>{};
    }
    /// Axial depth where the bent ray of a pixel alone, known at these depths, first meets a surface; infinite if
    /// never.
    double meeting_with_surface(GridRows& row, const std::vector<double>& depths, int x, int y) const;
    /// Whether a sample's ray ends on a surface where the depth buffer has a hole: the tracer's goes on through it.
    bool falls_through(GridRows& row, const DepthPlane& depth, const SamplePixel& p) const;
    /// The mirage that bends the rays of a tile through other media; null if there are none or they stay straight.
    const Mirage* air_bender(const PixelWindow& tile) const;
    /// The pixels whose air the rays of a tile may pass that a mirage bends: no farther from the picture than it is
    /// wide.
    PixelWindow air_around(const Mirage& mirage, const PixelWindow& tile) const;
    /// How far a bent ray may lead from its pixel [px].
    int reach(const std::vector<DisplacementGrid>& grids, std::span<const Mirage> near,
              const PixelWindow& window) const;
};

}  // namespace eikonal
