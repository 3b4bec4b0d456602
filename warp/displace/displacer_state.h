/// What an instant of a Displacer holds. Internal: displacer.cpp computes maps from it, displacer_errors.cpp their
/// errors.
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
    std::vector<std::unique_ptr<const BendInstant>> own;  ///< one of every medium that takes a model
    std::optional<BentRays> joint;                        ///< with second-order: the rays used instead of `own`
    std::vector<Mirage> mirages;

    mutable std::once_flag judged;
    mutable std::optional<BentRays> judge;  ///< the rays that maps are judged by; made when first asked for

    FrameView view() const { return {camera, t, nearest, farthest, gain}; }
    const BentRays& reference() const {
        std::call_once(judged, [&] { judge.emplace(media->bent_rays(own, view(), true)); });
        return *judge;
    }
    std::vector<DisplacementGrid> tile_grids(const PixelWindow& tile, const PixelWindow& cover) const;
    /// All mirages if any of them may move a pixel of the window, else none.
    std::span<const Mirage> mirages_on(const PixelWindow& window) const {
        const bool any =
            std::any_of(mirages.begin(), mirages.end(), [&](const Mirage& m) { return m.touches(window); });
        return any ? mirages : std::span<const Mirage>{};
    }
    /// Axial depth [m] at which the bent ray of one pixel first reaches a surface. The ray is known at `depths`.
    /// Infinite if it reaches none.
    double meeting_with_surface(GridRows& row, const std::vector<double>& depths, int x, int y) const;
    /// Whether a sample's ray ends on a surface while the depth buffer has no surface there. The tracer's ray goes on
    /// through such a hole.
    bool falls_through(GridRows& row, const DepthPlane& depth, const SamplePixel& p) const;
    /// The mirage that bends a tile's rays on their way through the other media. Null if there is no mirage, or if it
    /// leaves these rays straight.
    const Mirage* air_bender(const PixelWindow& tile) const;
    /// The pixels through whose air a tile's rays may pass after a mirage has bent them. They are no farther from the
    /// picture than the picture is wide.
    PixelWindow air_around(const Mirage& mirage, const PixelWindow& tile) const;
    /// Largest distance between a pixel and the pixel that its bent ray leads to [px].
    int reach(const std::vector<DisplacementGrid>& grids, std::span<const Mirage> near,
              const PixelWindow& window) const;
};

}  // namespace eikonal
