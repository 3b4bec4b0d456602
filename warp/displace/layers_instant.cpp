#include <algorithm>
#include <cmath>

#include "noise/math/portable_math.h"
#include "warp/displace/layers.h"

namespace eikonal {
namespace {

constexpr int kMostFirstOrderDepths = 33;
/// The nearest layer, in cells: within one, X is a parabola, and pixels of next to no depth need no layers.
constexpr double kNearestLayer = 0.1;

/// Layers of the first-order model: evenly spaced in the logarithm, a step or two apart where that is not too many.
DisplacementGrid first_order_grid(const FirstOrderRays& model, const Camera& camera, double nearest, double farthest) {
    DisplacementGrid grid;
    grid.perspective = camera.projection == Projection::Perspective;
    grid.interpolation = DepthInterpolation::Hermite;
    nearest = std::min(std::max(nearest, kNearestLayer / model.cells_along(camera.forward)), farthest);
    if (farthest > nearest) {
        const double wanted = (farthest - nearest) * model.cells_along(camera.forward) / 2;
        const int intervals =
            std::clamp(static_cast<int>(std::ceil(std::min(wanted, 1e6))), 1, kMostFirstOrderDepths - 1);
        for (int i = 0; i <= intervals; ++i) {
            // near objects need finer layers, their angles being the larger
            const double t = static_cast<double>(i) / intervals;
            grid.depths.push_back(i == 0           ? nearest
                                  : i == intervals ? farthest
                                                   : nearest * portable::pow(farthest / nearest, t));
        }
        grid.depths.erase(std::unique(grid.depths.begin(), grid.depths.end()), grid.depths.end());
    } else {
        grid.depths = {nearest};
    }
    grid.spacing = node_spacing(model.finest_cell() * camera.f_px / (grid.perspective ? farthest : 1.0));
    return grid;
}

/// Nodes and layers of second-order: as fine as every layer's own.
struct Grid {
    int spacing = kWidestSpacing;
    std::vector<double> depths;

    void add(int other_spacing, const std::vector<double>& other_depths) {
        spacing = std::min(spacing, other_spacing);
        depths.insert(depths.end(), other_depths.begin(), other_depths.end());
    }
    void finish(double nearest, double farthest) {
        std::erase_if(depths, [&](double z) { return z <= nearest || z >= farthest; });
        depths.push_back(nearest);
        if (farthest > nearest) depths.push_back(farthest);
        std::sort(depths.begin(), depths.end());
        depths.erase(std::unique(depths.begin(), depths.end()), depths.end());
    }
};

}  // namespace

std::vector<DisplacementGrid> blank_grids(const LayerInstant& layer, const Camera& camera, double nearest,
                                          double farthest) {
    if (const auto* screens = std::get_if<ThinScreens>(&layer)) return screens->grids(camera, nearest, farthest);
    if (const auto* tables = std::get_if<DisplacementTables>(&layer)) return {tables->grid(camera)};
    if (const auto* rays = std::get_if<FirstOrderRays>(&layer))
        return {first_order_grid(*rays, camera, nearest, farthest)};
    if (const auto* bent = std::get_if<BentRays>(&layer)) return {bent->grid(camera)};
    return {};
}

LayerInstant MediaLayers::instant(const MediumLayer& layer, const Camera& camera, double t, double nearest,
                                  double farthest, double gain) const {
    const double aperture = scene_.optics.aperture;
    if (const auto* cloud = std::get_if<BlobCloud>(&layer.field))
        return SeenBlobs(cloud->at(t), strength_, camera, farthest, gain);
    if (const auto* screens = std::get_if<ScreenField>(&layer.field))
        return ThinScreens{screens->at(t), reference_, strength_,
                           std::get<TurbulenceSpec>(scene_.media[layer.medium]).falloff};
    const double way = std::max(farthest, settings_.far);
    if ((camera_moves_ || is_beyond(farthest, settings_.far)) && layer.model >= Model::FirstOrder)
        check_frame_steps(layer.medium, layer.cell, camera, way);
    if (const auto* noise = std::get_if<GradientNoiseField>(&layer.field))
        return FirstOrderRays{
            GradientNoiseInstant{noise, t}, strength_, layer.cell, aperture, settings_.far, settings_.cancelled};
    const auto& field = std::get<LatticeField>(layer.field);
    const PathRays rays = nearest_axis(camera, aperture);
    switch (layer.model) {
        case Model::Table:
            return slice_instant(field, t, rays, settings_.far, layer.constant, strength_, layer.padding);
        case Model::Tables: {
            std::vector<double> depths;
            for (int k = 1; k <= kTables; ++k) depths.push_back(way * k / kTables);
            return exact_instant(field, t, rays, depths, DepthInterpolation::Linear, strength_, layer.padding);
        }
        case Model::Spectral:
            return exact_instant(field, t, rays, spectral_depths(field, rays, nearest, farthest),
                                 DepthInterpolation::Hermite, strength_, layer.padding);
        default:
            return FirstOrderRays{std::make_shared<const LatticeInstant>(field, t, layer.padding),
                                  strength_,
                                  layer.cell,
                                  aperture,
                                  settings_.far,
                                  settings_.cancelled};
    }
}

std::vector<LayerInstant> MediaLayers::instants(const Camera& camera, double t, double nearest, double farthest,
                                                double gain) const {
    std::vector<LayerInstant> result;
    for (const MediumLayer& layer : layers_) result.push_back(instant(layer, camera, t, nearest, farthest, gain));
    return result;
}

FieldPart MediaLayers::part_of(const MediumLayer& layer, const LayerInstant& instant, double t) const {
    if (const auto* bends = std::get_if<SeenBlobs>(&instant))
        return {BlobsPart{bends->blobs(), second_order() ? kRayBlobReach : kJudgedBlobReach}};
    if (const auto* field = std::get_if<ScreenField>(&layer.field)) {
        const auto& screens = std::get<ThinScreens>(instant);
        const ShotFrame frame{reference_.position, reference_.right, reference_.up, reference_.forward, {}};
        return {ScreensPart{field, screens.screens, frame, screens.falloff}};
    }
    if (const auto* noise = std::get_if<GradientNoiseField>(&layer.field)) return {NoisePart{noise, t}};
    const auto& field = std::get<LatticeField>(layer.field);
    if (const auto* rays = std::get_if<FirstOrderRays>(&instant))
        return {LatticePart{&field, std::get<std::shared_ptr<const LatticeInstant>>(rays->medium), layer.bend_error}};
    Padding padding{layer.ray_padding, layer.ray_padding, layer.ray_padding};
    // Along an axis that every ray runs along, the spline's error averages out over the way.
    if (layer.model == Model::Spectral) padding[static_cast<std::size_t>(nearest_axis(reference_, 0).axis)] = 1;
    return {LatticePart{&field, std::make_shared<const LatticeInstant>(field, t, padding)}};
}

BentRays MediaLayers::together(const std::vector<LayerInstant>& own, const Camera& camera, double t, double nearest,
                               double farthest, double gain, bool reference) const {
    std::vector<FieldPart> parts;
    Grid grid;
    double cell = std::numeric_limits<double>::infinity(), step = second_order() && reference ? kFineStep : kStep;
    const bool blobs_alone = std::all_of(
        own.begin(), own.end(), [](const LayerInstant& layer) { return std::holds_alternative<SeenBlobs>(layer); });
    for (std::size_t i = 0; i < layers_.size(); ++i) {
        const MediumLayer& layer = layers_[i];
        parts.push_back(part_of(layer, own[i], t));
        parts.back().weight = gain;
        if (blobs_alone) std::get<BlobsPart>(parts.back().medium).step = step;
        if (std::holds_alternative<GradientNoiseField>(layer.field)) step = std::min(step, kNoiseStep);
        if (const auto* blobs = std::get_if<SeenBlobs>(&own[i]))
            grid.add(blobs->finest_spacing(), blobs->layers(nearest, farthest));
        else
            for (const DisplacementGrid& own_grid : blank_grids(own[i], camera, nearest, farthest))
                grid.add(own_grid.spacing, own_grid.depths);
        // thin screens are averaged over the aperture as they are made, and blobs are large
        if (std::holds_alternative<LatticeField>(layer.field) ||
            std::holds_alternative<GradientNoiseField>(layer.field))
            cell = std::min({cell, layer.cell.x, layer.cell.y, layer.cell.z});
    }
    if (reference)
        for (const SurfaceIndex& surface : surface_layers_) parts.push_back({SurfacePart{&surface, kSurfaceStep}});
    if (blobs_alone && !own.empty()) step = 1;  // theirs, found in one search
    grid.finish(nearest, farthest);
    return {AirInstant(scene_.optics, std::move(parts)),      step, grid.spacing,  std::move(grid.depths),
            std::isfinite(cell) ? scene_.optics.aperture : 0, cell, settings_.far, settings_.cancelled};
}

std::uint64_t MediaLayers::instant_bytes() const {
    double bytes = 0;
    for (const MediumLayer& layer : layers_) {
        if (const auto* screens = std::get_if<ScreenField>(&layer.field)) {
            for (const ScreenGeometry& g : screens->screens())
                bytes += sizeof(float) * (1.0 * g.nx * g.ny + 3.0 * kCoarseSide * kCoarseSide);
        } else if (const auto* lattice = std::get_if<LatticeField>(&layer.field)) {
            const auto& size = lattice->geometry().size;
            const auto axis = static_cast<std::size_t>(nearest_axis(reference_, 0).axis);
            const double samples = static_cast<double>(lattice->geometry().spatial_samples());
            const double padding = layer.padding;
            // a spline of the whole lattice, or at most four tables at each of the depths
            bytes += layer.model >= Model::FirstOrder
                         ? 2 * sizeof(float) * samples * padding * padding * padding
                         : 4 * sizeof(float) * samples / size[axis] * padding * padding * kMostSpectralDepths;
        } else if (const auto* cloud = std::get_if<BlobCloud>(&layer.field)) {
            bytes += static_cast<double>(sizeof(Blob) + sizeof(SeenBlob)) * cloud->most();
        }
    }
    return static_cast<std::uint64_t>(std::min(bytes, 1e18));
}

}  // namespace eikonal
