#include "warp/displace/layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "noise/error.h"
#include "noise/memory.h"
#include "noise/portable_math.h"
#include "noise/random.h"
#include "warp/scene/screen_view.h"

namespace eikonal {
namespace {

/// Spline error of `table` and `tables`, relative to the rms, and the nearest object, in parts of `far`, that padding
/// is for.
constexpr double kTableSplineError = 1e-2, kNearestPadded = 0.05;
/// A lattice axis is the view's if they differ by less (1 - cosine).
constexpr double kAligned = 1e-9;
/// table and tables take rays for parallel to a lattice axis: refused beyond 30 degrees from it.
constexpr double kLeastAlignment = 0.866;
/// A Gaussian field's largest value over a shot, in parts of its rms.
constexpr double kLargestOverRms = 6;
constexpr int kMostFirstOrderDepths = 33;
/// Instants over which the expected rms of blobs is taken.
constexpr int kRmsInstants = 2;

/// Padding of a lattice's spline for first-order: small lattices afford the finer one (noise/lattice_snapshot.h).
int first_order_padding(const LatticeGeometry& geometry) {
    constexpr std::size_t kMostPadded = 64 * 64 * 64;
    return geometry.spatial_samples() <= kMostPadded ? 2 : 1;
}

/// Layers of the first-order model: evenly spaced in the logarithm, a step or two apart where that is not too many.
Band first_order_band(const FirstOrderInstant& model, const Camera& camera, double nearest, double farthest) {
    Band band;
    band.perspective = camera.projection == Projection::Perspective;
    band.interpolation = DepthInterpolation::Hermite;
    if (farthest > nearest) {
        const double wanted = (farthest - nearest) * model.cells_along(camera.forward) / 2;
        const int intervals =
            std::clamp(static_cast<int>(std::ceil(std::min(wanted, 1e6))), 1, kMostFirstOrderDepths - 1);
        for (int i = 0; i <= intervals; ++i) {
            // near objects need finer layers, their angles being the larger
            const double t = static_cast<double>(i) / intervals;
            band.depths.push_back(i == 0           ? nearest
                                  : i == intervals ? farthest
                                                   : nearest * portable::pow(farthest / nearest, t));
        }
        band.depths.erase(std::unique(band.depths.begin(), band.depths.end()), band.depths.end());
    } else {
        band.depths = {nearest};
    }
    band.spacing = node_spacing(model.finest_cell() * camera.f_px / (band.perspective ? farthest : 1.0));
    return band;
}

}  // namespace

std::vector<Band> blank_bands(const LayerInstant& layer, const Camera& camera, double nearest, double farthest) {
    if (const auto* screens = std::get_if<ScreensInstant>(&layer)) return screens->bands(camera, nearest, farthest);
    if (const auto* tables = std::get_if<TablesInstant>(&layer)) return {tables->band(camera)};
    if (const auto* rays = std::get_if<FirstOrderInstant>(&layer))
        return {first_order_band(*rays, camera, nearest, farthest)};
    return {};
}

MediaLayers::MediaLayers(const Scene& scene, const DisplacerSettings& settings, const CameraPath& path)
    : scene_(scene),
      settings_(settings),
      camera_moves_(path.moving()),
      reference_(path.reference()),
      strength_(force_strength(scene.optics)),
      law_(index_law(scene.optics)) {
    for (std::size_t i = 0; i < scene.media.size(); ++i)
        std::visit([&](const auto& spec) { add(i, spec); }, scene.media[i]);
    refuse_other_model();
}

void MediaLayers::keep(MediumLayer layer, std::string note) {
    const double rms = std::sqrt(expected_variance(layer, settings_.far));
    if (kLargestOverRms * rms < settings_.negligible) {
        notes_.push_back(fmt::format("medium.{}: left out, it moves no pixel by more than {:g} px ({:.2g} px rms)",
                                     layer.medium, settings_.negligible, rms));
        return;
    }
    notes_.push_back(std::move(note));
    layers_.push_back(std::move(layer));
}

void MediaLayers::add(std::size_t i, const TurbulenceSpec& spec) {
    const double source = spec.spectrum == SpectrumKind::VonKarman ? spec.cn2 : spec.strength;
    if (source * strength_ == 0) {
        notes_.push_back(fmt::format("medium.{}: left out, its strength is zero", i));
        return;
    }
    switch (spec.form) {
        case TurbulenceForm::Screens:
            return add_screens(i, spec);
        case TurbulenceForm::Lattice:
            return add_lattice(i, spec);
        case TurbulenceForm::GradientNoise:
            return add_noise(i, spec);
    }
}

void MediaLayers::add(std::size_t i, const BlobsSpec& spec) {
    BlobCloud cloud(spec, law_, fmt::format("medium.{}", i));
    double strongest = 0;
    for (const BlobSpec& blob : spec.blobs)
        strongest = std::max(strongest, std::abs(law_.above_ambient(blob.temperature)));
    for (const BlobSourceSpec& source : spec.sources)
        if (source.rate > 0) strongest = std::max(strongest, std::abs(law_.above_ambient(source.temperature)));
    // wherever they are: as if every blob were at the camera
    const double bound = largest_blob_shift({{}, 0, strongest}, strength_, reference_, 0, settings_.far) * cloud.most();
    if (bound <= settings_.negligible) {
        notes_.push_back(fmt::format("medium.{}: left out, {}", i,
                                     cloud.most() == 0 ? "it has no blobs"
                                     : strongest == 0
                                         ? "no blob differs from the ambient temperature"
                                         : fmt::format("its blobs move no pixel by more than {:.2g} px", bound)));
        return;
    }
    notes_.push_back(
        fmt::format("medium.{}: model first-order (closed form), up to {} blobs at a time", i, cloud.most()));
    layers_.push_back({i, Model::FirstOrder, std::move(cloud), {}, 0});
}

void MediaLayers::add(std::size_t i, const SurfaceSpec& spec) {
    if (law_.above_ambient(spec.surface_temperature) * strength_ == 0) {
        notes_.push_back(fmt::format("medium.{}: left out, the surface is at ambient temperature", i));
        return;
    }
    surfaces_.emplace_back(i, spec);
}

void MediaLayers::add(std::size_t i, const ProfileSpec&) {
    throw UserError(
        fmt::format("medium.{}: a medium of type \"profile\" is there to validate the tracer, which takes it: "
                    "eikonal-trace render; "
                    "remove it from the scene that you warp with",
                    i));
}

void MediaLayers::add_screens(std::size_t i, const TurbulenceSpec& spec) {
    const ScreenView view = screen_view(reference_, settings_.width, settings_.height, scene_.optics.aperture,
                                        settings_.far, settings_.fps);
    std::vector<ScreenGeometry> geometry = layout_screens(spec, view);
    check_screens(spec, geometry, memory_limit());
    const ScreenGeometry middle = geometry[geometry.size() / 2];
    std::string note = fmt::format(
        "medium.{}: model screens ({} view): {} screens of {} x {} x {} samples over {:g} m, {:.3g} m "
        "apart, periods {:.3g} x {:.3g} m, {:.3g} s",
        i, perspective() ? "perspective" : "orthographic", geometry.size(), middle.nx, middle.ny, middle.nt,
        settings_.far, middle.thickness, middle.Lx, middle.Ly, middle.T);
    const std::size_t before = layers_.size();
    keep({i, Model::Screens, ScreenField(spec, std::move(geometry), reference_.right, reference_.up), {}, 0},
         std::move(note));
    if (layers_.size() == before) return;
    if (glm::dot(spec.velocity, reference_.forward) != 0)
        notes_.push_back(
            fmt::format("medium.{}: the wind's part along the view axis ({:.3g} m/s) does not move thin screens", i,
                        glm::dot(spec.velocity, reference_.forward)));
    const double focusing = focusing_variance(layers_.back(), settings_.far);
    if (focusing > 0.5)
        warnings_.push_back(
            fmt::format("medium.{}: focusing variance {:.2g} at {:g} m: rays fold, where any first-order warp is only "
                        "plausible; weaken cn2, shorten the distance, or widen the aperture",
                        i, focusing, settings_.far));
}

Model MediaLayers::choose_model(std::size_t i, const TurbulenceSpec& spec, const PathRays& rays,
                                std::string& why) const {
    const bool aligned = 1 - axis_alignment(reference_, rays) < kAligned && !camera_moves_;
    const bool falloff_across = !spec.falloff || std::abs(spec.falloff->normal[rays.axis]) < 1e-9;
    const bool spectral_applies = !perspective() && aligned && falloff_across;
    const char* obstacle = perspective()     ? "the camera is perspective"
                           : camera_moves_   ? "the camera moves"
                           : !aligned        ? "the view is not along a lattice axis"
                           : !falloff_across ? "the falloff varies along the view"
                                             : "orthographic view along a lattice axis";
    if (!settings_.model || *settings_.model == Model::Screens) {
        why = obstacle;
        return spectral_applies ? Model::Spectral : Model::FirstOrder;
    }
    const Model model = *settings_.model;
    why = "asked for";
    if (model == Model::Spectral && !spectral_applies)
        throw UserError(
            fmt::format("--model spectral: medium.{} needs an orthographic camera that looks along x, y or z, and a "
                        "falloff across the view, but here {}; use --model first-order or tables",
                        i, obstacle));
    if (model != Model::FirstOrder && !falloff_across)
        throw UserError(
            fmt::format("--model {}: the falloff of medium.{} varies along the view, which tables cannot hold; use "
                        "--model first-order",
                        name_of(model), i));
    if (model != Model::FirstOrder && axis_alignment(reference_, rays) < kLeastAlignment)
        throw UserError(
            fmt::format("--model {}: the view is more than 30 degrees from every lattice axis; use --model first-order",
                        name_of(model)));
    return model;
}

void MediaLayers::add_lattice(std::size_t i, const TurbulenceSpec& spec) {
    const LatticeGeometry geometry = choose_lattice(spec);
    check_lattice(spec, geometry, memory_limit());
    const PathRays rays = nearest_axis(reference_, scene_.optics.aperture);
    std::string why;
    const Model model = choose_model(i, spec, rays, why);
    std::string note =
        fmt::format("medium.{}: model {} ({}): lattice {} x {} x {} x {}, periods {:g} x {:g} x {:g} m, {:g} s", i,
                    name_of(model), why, geometry.size[0], geometry.size[1], geometry.size[2], geometry.size[3],
                    geometry.period[0], geometry.period[1], geometry.period[2], geometry.period[3]);
    MediumLayer layer{i, model, LatticeField(spec, geometry), {}, 0};
    const auto& field = std::get<LatticeField>(layer.field);
    layer.cell = {geometry.spacing(0), geometry.spacing(1), geometry.spacing(2)};
    if (model == Model::FirstOrder) {
        layer.padding = first_order_padding(geometry);
    } else {
        const std::array paths{kNearestPadded * settings_.far, settings_.far};
        layer.padding =
            path_padding(field, rays, paths, model == Model::Spectral ? kPathTableError : kTableSplineError);
    }
    if (model == Model::Table) {
        const auto x1 = field.displacement_variance(rays.axis, settings_.far, rays.aperture);
        const auto force = slice_variance(field, rays);
        const double f2 = force[0] + force[1];
        layer.constant = f2 > 0 ? std::sqrt((x1[0] + x1[1]) / f2) / settings_.far : 0;
    }
    const std::size_t before = layers_.size();
    keep(std::move(layer), std::move(note));
    const double period = geometry.period[static_cast<std::size_t>(rays.axis)];
    if (layers_.size() > before && settings_.far > period)
        warnings_.push_back(fmt::format(
            "medium.{}: the path of {:g} m is longer than the lattice period of {:g} m along it, beyond which the "
            "field repeats and displacement is overstated; use form=\"screens\", --far or a longer period",
            i, settings_.far, period));
}

void MediaLayers::add_noise(std::size_t i, const TurbulenceSpec& spec) {
    keep({i, Model::FirstOrder, GradientNoiseField(spec), dvec3(0.5 * spec.inner_scale), 0},
         fmt::format("medium.{}: model first-order (gradient noise has no other), not periodic", i));
}

void MediaLayers::refuse_other_model() const {
    if (!settings_.model || layers_.empty()) return;
    std::string have;
    for (const MediumLayer& l : layers_) {
        if (l.model == *settings_.model) return;
        have += fmt::format("{}medium.{}: {}", have.empty() ? "" : ", ", l.medium, name_of(l.model));
    }
    throw UserError(fmt::format(
        "--model {}: no medium of this scene suits it ({}); screens goes with form=\"screens\", the others with "
        "form=\"lattice\" (--set medium.0.form=lattice)",
        name_of(*settings_.model), have));
}

LayerInstant MediaLayers::instant(const MediumLayer& layer, const Camera& camera, double t, double nearest,
                                  double farthest, double gain) const {
    const double aperture = scene_.optics.aperture;
    if (const auto* cloud = std::get_if<BlobCloud>(&layer.field))
        return BlobBends(cloud->at(t), strength_, camera, farthest, gain);
    if (const auto* screens = std::get_if<ScreenField>(&layer.field))
        return ScreensInstant{screens->at(t), reference_, strength_,
                              std::get<TurbulenceSpec>(scene_.media[layer.medium]).falloff};
    if (const auto* noise = std::get_if<GradientNoiseField>(&layer.field))
        return FirstOrderInstant{GradientNoiseInstant{noise, t}, strength_, layer.cell, aperture, settings_.far};
    const auto& field = std::get<LatticeField>(layer.field);
    const PathRays rays = nearest_axis(camera, aperture);
    switch (layer.model) {
        case Model::Table:
            return slice_instant(field, t, rays, settings_.far, layer.constant, strength_, layer.padding);
        case Model::Tables: {
            std::vector<double> depths;
            for (int k = 1; k <= kTables; ++k) depths.push_back(settings_.far * k / kTables);
            return exact_instant(field, t, rays, depths, DepthInterpolation::Linear, strength_, layer.padding);
        }
        case Model::Spectral:
            return exact_instant(field, t, rays, spectral_depths(field, rays, nearest, farthest),
                                 DepthInterpolation::Hermite, strength_, layer.padding);
        default:
            return FirstOrderInstant{LatticeSnapshot(field, t, layer.padding), strength_, layer.cell, aperture,
                                     settings_.far};
    }
}

double MediaLayers::expected_variance(const MediumLayer& layer, double D) const {
    const double pixels = perspective() ? reference_.f_px / D : reference_.f_px;  // of one metre of x1
    const double strength2 = strength_ * strength_;
    const double aspect2 = reference_.pixel_aspect * reference_.pixel_aspect;
    if (const auto* screens = std::get_if<ScreenField>(&layer.field))
        return strength2 * (1 + aspect2) * screens->displacement_angle_variance(D) * (pixels * D) * (pixels * D);
    if (const auto* lattice = std::get_if<LatticeField>(&layer.field)) {
        const PathRays rays = nearest_axis(reference_, scene_.optics.aperture);
        const auto x1 = lattice->displacement_variance(rays.axis, D, rays.aperture);
        return strength2 * 0.5 * (1 + aspect2) * (x1[0] + x1[1]) * pixels * pixels;
    }
    return sampled_variance(layer, D);
}

/// Over kRmsRays rays at random; of blobs, which are dear to place, at kRmsInstants times.
double MediaLayers::sampled_variance(const MediumLayer& layer, double D) const {
    const RandomStream stream(1, "expected rms");
    const auto draw = [&](int i, int c) { return stream.uniform(static_cast<std::uint64_t>(4 * i + c)); };
    const double scale = perspective() ? 1 / D : 1.0;
    std::optional<LayerInstant> instant;
    double sum = 0;
    for (int i = 0; i < kRmsRays; ++i) {
        const int x = static_cast<int>(draw(i, 0) * settings_.width),
                  y = static_cast<int>(draw(i, 1) * settings_.height);
        if (std::holds_alternative<BlobCloud>(layer.field)) {
            if (i % (kRmsRays / kRmsInstants) == 0)
                instant = this->instant(layer, reference_, 1e3 * draw(i, 2), D, D, 1);
            const PixelWindow pixel{x, y, 1, 1};
            dvec2 d{0, 0};
            for (const Band& band : std::get<BlobBends>(*instant).bands(pixel, pixel, D, D)) {
                BandRow row;
                row.start(band, y);
                const Shift shift = row.at(x, D);
                d += dvec2(shift.x, shift.y);
            }
            sum += d.x * d.x + d.y * d.y;
            continue;
        }
        instant = this->instant(layer, reference_, 1e3 * draw(i, 2), D, D, 1);
        Band band = blank_bands(*instant, reference_, D, D).front();
        band.spacing = 1;
        band.cover({x, y, 1, 1});
        std::get<FirstOrderInstant>(*instant).fill(band, reference_);
        const Node node = band.nodes[0];
        sum += scale * scale * (double{node[0]} * node[0] + double{node[1]} * node[1]);
    }
    return sum / kRmsRays;
}

double MediaLayers::focusing_variance(const MediumLayer& layer, double D) const {
    const auto* field = std::get_if<ScreenField>(&layer.field);
    return field ? strength_ * strength_ * field->focusing_variance(D, perspective()) : 0;
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
            bytes += layer.model == Model::FirstOrder
                         ? 2 * sizeof(float) * samples * padding * padding * padding
                         : 4 * sizeof(float) * samples / size[axis] * padding * padding * kMostSpectralDepths;
        } else if (const auto* cloud = std::get_if<BlobCloud>(&layer.field)) {
            bytes += static_cast<double>(sizeof(Blob) + sizeof(SeenBlob)) * cloud->most();
        }
    }
    return static_cast<std::uint64_t>(std::min(bytes, 1e18));
}

}  // namespace eikonal
