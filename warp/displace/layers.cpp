#include "warp/displace/layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "noise/base/error.h"
#include "noise/base/memory.h"
#include "noise/math/portable_math.h"
#include "noise/math/random.h"
#include "noise/surface/surface.h"
#include "warp/scene/screen_view.h"

namespace eikonal {
namespace {

/// Spline error of `table` and `tables`, relative to the rms, and the nearest object, in parts of `far`, that padding
/// is for.
constexpr double kTableSplineError = 1e-2, kNearestPadded = 0.05;
/// Spline error of the rays that judge tables, relative to the rms, in parts of √v, v the focusing variance: about half
/// of the second order that they are there to find.
constexpr double kJudgedSplineError = 0.125;
/// A lattice axis is the view's if they differ by less (1 - cosine).
constexpr double kAligned = 1e-9;
/// table and tables take rays for parallel to a lattice axis: refused beyond 30 degrees from it.
constexpr double kLeastAlignment = 0.866;
/// How much more than at `far` turbulence may move what is deeper: as 100 times the way does.
constexpr double kDeeper = 10;
/// A Gaussian field's largest value over a shot, in parts of its rms.
constexpr double kLargestOverRms = 6;
/// Steps of a first-order ray beyond which it is warned that frames take long.
constexpr double kManySteps = 2000;
/// Samples of the largest spline that is made finer than its lattice.
constexpr std::size_t kMostPadded = 256 * 256 * 256;
/// Thin screens that move what they should by less than this part of it are worth a note.
constexpr double kNoticedPart = 0.97;
/// A step in gradient noise is half an inner scale, and at most this part of the finest octave's cell.
constexpr double kPartOfNoiseCell = 0.75;

/// Least padding that keeps a spline's slope to an error relative to its rms, if the lattice affords it: of the scene
/// alone, so that every machine makes the same picture.
int spline_padding(const LatticeField& field, double allowed) {
    int padding = 1;
    for (const int p : {2, 3, 4}) {
        if (lattice_spline_error(field, padding).slope <= allowed) break;
        const auto finer = static_cast<std::size_t>(p);
        if (field.geometry().spatial_samples() * finer * finer * finer > kMostPadded) break;
        padding = p;
    }
    return padding;
}

}  // namespace

MediaLayers::MediaLayers(const Scene& scene, const DisplacerSettings& settings, const CameraPath& path)
    : scene_(scene),
      settings_(settings),
      path_(path),
      camera_moves_(path.moving()),
      reference_(path.reference()),
      strength_(force_strength(scene.optics)),
      law_(index_law(scene.optics)) {
    for (std::size_t i = 0; i < scene.media.size(); ++i)
        std::visit([&](const auto& spec) { add(i, spec); }, scene.media[i]);
    check_surfaces(reference_mirages_, surface_names_);
    refuse_other_model();
}

void MediaLayers::keep(MediumLayer layer, std::string note) {
    double rms = std::sqrt(expected_variance(layer, settings_.far, true));
    if (!(rms <= kLargestShift))
        throw UserError(
            fmt::format("medium.{}: it would move pixels by {:.2g} px rms, and a map holds at most {:g} px; lower its "
                        "cn2 or strength, optics.exaggeration, or --far",
                        layer.medium, rms, kLargestShift));
    // a camera may zoom in later; the rays of a wide view's corners cross more air, and show a bend larger
    const double wide = corner_gain(layer.model);
    const double deeper = deepest() > settings_.far ? kDeeper : 1;
    const auto negligible = [&] { return kLargestOverRms * rms * wide * deeper < settings_.negligible; };
    if (!camera_moves_ && negligible()) rms = std::sqrt(expected_variance(layer, settings_.far));
    if (!camera_moves_ && negligible()) {
        notes_.push_back(fmt::format("medium.{}: left out, it moves no pixel by more than {:g} px ({:.2g} px rms)",
                                     layer.medium, settings_.negligible, rms));
        return;
    }
    notes_.push_back(std::move(note));
    add_layer(std::move(layer));
}

double MediaLayers::corner_gain(Model model) const {
    const double L = straight_ray(reference_, 0, 0).length;
    switch (model) {
        case Model::Table:
        case Model::Tables:
        case Model::Spectral:
            return 1;  // parallel rays
        case Model::Screens:
            return L * L * std::sqrt(L);
        default:
            return L * L * L;
    }
}

void MediaLayers::add_layer(MediumLayer layer) {
    layers_.push_back(std::move(layer));
    const double focusing = focusing_variance(layers_.back(), settings_.far);
    if (focusing > kFolding && !second_order())
        warnings_.push_back(
            fmt::format("medium.{}: focusing variance {:.2g} at {:g} m: rays fold, where any first-order warp is only "
                        "plausible; weaken the medium, shorten the distance, or widen the aperture",
                        layers_.back().medium, focusing, settings_.far));
    if (focusing > kHopelessFolding && second_order())
        warnings_.push_back(
            fmt::format("medium.{}: focusing variance {:.2g} at {:g} m: rays fold many times over, which no warp can "
                        "show; weaken the medium or shorten the distance; eikonal-trace render follows the rays truly",
                        layers_.back().medium, focusing, settings_.far));
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
    BlobCloud cloud(spec, law_, fmt::format("medium.{}", i), most_blobs_);
    most_blobs_ += cloud.most();
    const std::vector<BlobHome> homes = cloud.homes();
    double strongest = 0;
    for (const BlobHome& home : homes) strongest = std::max(strongest, std::abs(home.largest.n));
    // wherever they are: as if every blob were at the camera
    const double bound = largest_blob_shift({{}, 0, strongest}, strength_, reference_, 0, deepest()) * cloud.most();
    const auto leave_out = [&](const std::string& why) {
        notes_.push_back(fmt::format("medium.{}: left out, {}", i, why));
    };
    if (cloud.most() == 0) return leave_out("it has no blobs");
    if (strongest == 0) return leave_out("no blob differs from the ambient temperature");
    if (bound == 0 || (!camera_moves_ && bound <= settings_.negligible))
        return leave_out(fmt::format("its blobs move no pixel by more than {:.2g} px", bound));
    const auto seen = [&](const PixelWindow& pixels) {
        return may_be_seen(homes, strength_, reference_, pixels, deepest(), settings_.negligible);
    };
    if (!camera_moves_ && !seen({0, 0, settings_.width, settings_.height}) &&
        !(settings_.overscan && seen(settings_.overscan())))
        return leave_out(
            fmt::format("none of its blobs moves a pixel of the picture by more than {:g} px: they are "
                        "aside of it, or behind what is up to {:g} m away",
                        settings_.negligible, deepest()));
    notes_.push_back(fmt::format(
        "medium.{}: model {}, up to {} blobs at a time", i,
        second_order() ? "second-order (through all media together)" : "first-order (closed form)", cloud.most()));
    add_layer({i, own(Model::FirstOrder), std::move(cloud), {}, 0});
}

void MediaLayers::check_camera_stays_above(const SurfaceSpec& spec, const std::string& name) const {
    if (!camera_moves_) return;
    const SurfaceIndex layer(spec, law_);
    const auto [first, last] = path_.frames();
    for (double frame = first; frame <= last; ++frame)
        if (const double height = layer.height(path_.at(frame).position); !(height > 0))
            throw UserError(fmt::format(
                "{}.origin: the camera's path is {:g} m below this surface at frame {:g}; it must be above it in every "
                "frame: lower the surface, or turn its normal towards the camera",
                name, 0.0 - height, frame));
}

void MediaLayers::add(std::size_t i, const SurfaceSpec& spec) {
    if (law_.above_ambient(spec.surface_temperature) * strength_ == 0) {
        notes_.push_back(fmt::format("medium.{}: left out, the surface is at ambient temperature", i));
        return;
    }
    const std::string name = fmt::format("medium.{}", i);
    check_camera_stays_above(spec, name);
    Mirage mirage(spec, law_, scene_.optics.exaggeration, scene_.optics.ray_equation, reference_, deepest(), name);
    if (!camera_moves_ && !mirage.touches({0, 0, settings_.width, settings_.height})) {
        notes_.push_back(fmt::format("{}: left out, it moves no pixel of the view by more than {:g} px up to {:g} m",
                                     name, kMirageThreshold, deepest()));
        return;
    }
    const SurfaceIndex layer(spec, law_);
    const double height = layer.height(reference_.position);
    const double critical = layer.critical_slope(height, scene_.optics.exaggeration, scene_.optics.ray_equation);
    notes_.push_back(
        critical > 0
            ? fmt::format("{}: exact bending over a hot surface: rays less than {:.3g} mrad below it turn back, seen "
                          "from {:.3g} m up that is beyond {:.3g} m",
                          name, 1e3 * critical, height, height / critical)
            : fmt::format("{}: exact bending over a cold surface, seen from {:.3g} m up", name, height));
    surfaces_.emplace_back(i, spec);
    surface_layers_.push_back(layer);
    surface_names_.push_back(name);
    reference_mirages_.push_back(std::move(mirage));
}

void MediaLayers::add(std::size_t i, const ProfileSpec&) {
    throw UserError(
        fmt::format("medium.{}: a medium of type \"profile\" is there to validate the tracer, which takes it: "
                    "eikonal-trace render; "
                    "remove it from the scene that you warp with",
                    i));
}

void MediaLayers::add_screens(std::size_t i, const TurbulenceSpec& spec) {
    const ShotView view = screen_view(reference_, settings_.width, settings_.height, scene_.optics.aperture,
                                      settings_.far, settings_.fps);
    std::vector<ScreenGeometry> geometry = layout_screens(spec, view);
    check_screens(spec, geometry, memory_limit());
    const ScreenGeometry middle = geometry[geometry.size() / 2];
    std::string note = fmt::format(
        "medium.{}: model {} ({} view): {} screens of {} x {} x {} samples over {:g} m, {:.3g} m "
        "apart, periods {:.3g} x {:.3g} m, {:.3g} s",
        i, name_of(own(Model::Screens)), perspective() ? "perspective" : "orthographic", geometry.size(), middle.nx,
        middle.ny, middle.nt, settings_.far, middle.thickness, middle.Lx, middle.Ly, middle.T);
    const std::size_t before = layers_.size();
    keep({i, own(Model::Screens), ScreenField(spec, std::move(geometry), reference_.right, reference_.up), {}, 0},
         std::move(note));
    if (layers_.size() == before) return;
    const auto& screens = std::get<ScreenField>(layers_.back().field);
    const double lost = screens.lost_angle_variance(settings_.far),
                 kept = screens.displacement_angle_variance(settings_.far);
    if (const double part = std::sqrt(kept / (kept + lost)); part < kNoticedPart)
        notes_.push_back(
            fmt::format("medium.{}: eddies finer than a pixel are left out; what is left displaces objects at {:g} m "
                        "by {:.2g} of what all would: a larger picture, or a longer lens, shows more",
                        i, settings_.far, part));
    if (glm::dot(spec.velocity, reference_.forward) != 0)
        notes_.push_back(
            fmt::format("medium.{}: the wind's part along the view axis ({:.3g} m/s) does not move thin screens", i,
                        glm::dot(spec.velocity, reference_.forward)));
}

double MediaLayers::cells_a_metre(const Camera& camera, const dvec3& cell) const {
    double most = 0;  // of the rays through the corners, the longest and most oblique
    for (const double x : {0, settings_.width})
        for (const double y : {0, settings_.height})
            most = std::max(most, glm::length(straight_ray(camera, x, y).direction / cell));
    return most;
}

void MediaLayers::check_frame_steps(std::size_t i, const dvec3& cell, const Camera& camera, double farthest) const {
    const double steps = farthest * cells_a_metre(camera, cell);
    if (!(steps > kMostFirstOrderSteps)) return;
    const std::string cause = is_beyond(farthest, settings_.far)
                                  ? fmt::format("depth reaches {:g} m, up to which", farthest)
                                  : "the camera has turned or zoomed out so that";
    throw FrameError(fmt::format(
        "medium.{}: {} {} takes {:.0f} steps a ray; allowed are at most {:g}; use a shorter --far, which limits depth, "
        "or a longer period or inner_scale",
        i, cause, name_of(own(Model::FirstOrder)), steps, kMostFirstOrderSteps));
}

double MediaLayers::deepest() const {
    return std::max(settings_.far, settings_.deepest);
}

std::vector<std::string> MediaLayers::beyond_far(double farthest) const {
    std::vector<std::string> lines;
    if (!is_beyond(farthest, settings_.far)) return lines;
    for (const MediumLayer& layer : layers_) {
        const double steps = farthest * cells_a_metre(reference_, layer.cell);
        const bool cells = std::holds_alternative<LatticeField>(layer.field) ||
                           std::holds_alternative<GradientNoiseField>(layer.field);
        if (cells && layer.model >= Model::FirstOrder && steps > kManySteps)
            lines.push_back(fmt::format("medium.{}: {} takes {:.0f} steps a ray, and frames take long", layer.medium,
                                        name_of(layer.model), steps));
        if (std::holds_alternative<ScreenField>(layer.field))
            lines.push_back(
                fmt::format("medium.{}: its thin screens end there, and what is behind them moves as if "
                            "the air did, too",
                            layer.medium));
        const auto* lattice = std::get_if<LatticeField>(&layer.field);
        if (lattice == nullptr) continue;
        const PathRays rays = nearest_axis(reference_, scene_.optics.aperture);
        const double period = lattice->geometry().period[static_cast<std::size_t>(rays.axis)];
        if (settings_.far <= period && farthest > period)
            lines.push_back(
                fmt::format("medium.{}: the lattice's period of {:g} m along the path repeats, and "
                            "displacement is overstated",
                            layer.medium, period));
    }
    return lines;
}

void MediaLayers::check_steps(std::size_t i, const dvec3& cell) {
    const double most = cells_a_metre(reference_, cell), steps = settings_.far * most;
    if (!(steps > kManySteps)) return;
    const std::string what =
        fmt::format("medium.{}: {} takes {:.0f} steps a ray, the path of {:g} m in cells of {:.3g} m", i,
                    name_of(own(Model::FirstOrder)), steps, settings_.far, 1 / most);
    const std::string remedy = "form=\"screens\", a shorter --far, or a longer period or inner_scale";
    if (steps > kMostFirstOrderSteps)
        throw UserError(fmt::format("{}; allowed are at most {:g}; use {}", what, kMostFirstOrderSteps, remedy));
    warnings_.push_back(fmt::format("{}: frames take long; quicker are {}", what, remedy));
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
    if (second_order()) {
        why = "through all media together";
        return Model::SecondOrder;
    }
    if (!settings_.model || *settings_.model == Model::Screens) {
        why = obstacle;
        return spectral_applies ? Model::Spectral : Model::FirstOrder;
    }
    const Model model = *settings_.model;
    why = "chosen";
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
    const dvec3 cell{geometry.spacing(0), geometry.spacing(1), geometry.spacing(2)};
    const bool stepped = model >= Model::FirstOrder;
    if (stepped) check_steps(i, cell);
    std::string note =
        fmt::format("medium.{}: model {} ({}): lattice {} x {} x {} x {}, periods {:g} x {:g} x {:g} m, {:g} s", i,
                    name_of(model), why, geometry.size[0], geometry.size[1], geometry.size[2], geometry.size[3],
                    geometry.period[0], geometry.period[1], geometry.period[2], geometry.period[3]);
    MediumLayer layer{i, model, LatticeField(spec, geometry), cell, 0};
    const auto& field = std::get<LatticeField>(layer.field);
    const double allowed = second_order() ? kSecondOrderSplineError : kFirstOrderSplineError;
    if (stepped) {
        layer.padding = layer.ray_padding = spline_padding(field, allowed);
        const SplineError error = lattice_spline_error(field, layer.padding);
        if (error.slope > allowed)
            notes_.push_back(fmt::format(
                "medium.{}: too large a lattice for a finer spline, whose force is off by {:.2g} of its rms", i,
                error.slope));
        // an aperture of a cell and more averages it out
        if (scene_.optics.aperture * layer.padding < std::min({cell.x, cell.y, cell.z})) layer.bend_error = error.bend;
    } else {
        const std::array paths{kNearestPadded * settings_.far, settings_.far};
        layer.padding =
            path_padding(field, rays, paths, model == Model::Spectral ? kPathTableError : kTableSplineError);
        const double order = kJudgedSplineError * std::sqrt(focusing_variance(layer, settings_.far));
        if (settings_.sample_errors) layer.ray_padding = spline_padding(field, std::max(allowed, order));
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
    GradientNoiseField field(spec);
    const dvec3 cell(std::min(0.5 * spec.inner_scale, kPartOfNoiseCell * field.smallest_cell()));
    check_steps(i, cell);
    keep({i, own(Model::FirstOrder), std::move(field), cell, 0},
         fmt::format("medium.{}: model {}, not periodic", i,
                     second_order() ? "second-order (through all media together)"
                                    : "first-order (gradient noise has no other)"));
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

}  // namespace eikonal
