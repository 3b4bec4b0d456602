#include "warp/displace/displacer.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "noise/dispatch.h"
#include "noise/error.h"
#include "noise/random.h"
#include "noise/screen_layout.h"
#include "warp/displace/first_order.h"
#include "warp/displace/lattice_tables.h"
#include "warp/displace/thin_screens.h"

namespace eikonal {
namespace {

/// Pixels of a tile, anchored at (0, 0): a pixel's bits depend on its tile, which is worked out whole, and not on the
/// window asked for. Bounds the memory of a thread, too.
constexpr int kTileWidth = 512, kTileHeight = 64;
/// Displacements beyond this [px] are cut to it, so that extreme scenes leave finite maps.
constexpr float kLargestShift = 1e6f;
/// Between nodes and layers the interpolant may exceed them by this factor.
constexpr double kOvershoot = 1.6;
/// Least depth that layers are made for [m]: nearer ones move as at this one.
constexpr double kLeastDepth = 1e-6;
/// Spline error of `table` and `tables`, relative to the rms, and the nearest object, in parts of `far`, that padding
/// is for.
constexpr double kTableSplineError = 1e-2, kNearestPadded = 0.05;
/// A lattice axis is the view's if they differ by less (1 - cosine).
constexpr double kAligned = 1e-9;
/// table and tables take rays for parallel to a lattice axis: refused beyond 30 degrees from it.
constexpr double kLeastAlignment = 0.866;

const char* name_of(Model model) {
    switch (model) {
        case Model::Table:
            return "table";
        case Model::Tables:
            return "tables";
        case Model::Spectral:
            return "spectral";
        case Model::Screens:
            return "screens";
        case Model::FirstOrder:
            return "first-order";
    }
    return "";
}

/// Padding of a lattice's spline for first-order: small lattices afford the finer one (noise/lattice_snapshot.h).
int first_order_padding(const LatticeGeometry& geometry) {
    constexpr std::size_t kMostPadded = 64 * 64 * 64;
    return geometry.spatial_samples() <= kMostPadded ? 2 : 1;
}

/// One medium with the field that its form calls for and the model that reads it.
struct Layer {
    std::size_t medium = 0;
    Model model = Model::Screens;
    std::variant<ScreenField, LatticeField, GradientNoiseField> field;
    dvec3 cell{1, 1, 1};  ///< of the field [m], first-order
    double constant = 0;  ///< c of `table`
    int padding = 1;      ///< of the tables' splines
};

using LayerInstant = std::variant<ScreensInstant, TablesInstant, FirstOrderInstant>;

}  // namespace

std::uint64_t memory_limit() {
    auto bytes =
        static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
    // a container may have less than the machine
    std::ifstream file("/sys/fs/cgroup/memory.max");
    if (std::uint64_t own = 0; file >> own) bytes = std::min(bytes, own);
    return bytes / 2;
}

struct Displacer::Shot {
    Scene scene;
    DisplacerSettings settings;
    CameraPath path;
    Camera reference;
    double strength;  ///< multiplies ∇n
    std::vector<Layer> layers;
    std::vector<std::string> notes, warnings;

    Shot(const Scene& s, const DisplacerSettings& set)
        : scene(s),
          settings(set),
          path(s.camera, set.width, set.height, set.pixel_aspect, set.fov),
          reference(path.reference()),
          strength(force_strength(s.optics)) {
        for (std::size_t i = 0; i < scene.media.size(); ++i) add_medium(i);
        if (settings.model && !layers.empty() &&
            std::none_of(layers.begin(), layers.end(), [&](const Layer& l) { return l.model == *settings.model; }))
            refuse_model();
    }

    bool perspective() const { return reference.projection == Projection::Perspective; }

    void add_medium(std::size_t i) {
        const auto* spec = std::get_if<TurbulenceSpec>(&scene.media[i]);
        if (!spec)
            throw UserError(fmt::format(
                "medium.{}: eikonal warp and map hold media of type \"turbulence\" so far; remove this medium "
                "from the scene or from the copy that you warp with",
                i));
        const double source = spec->spectrum == SpectrumKind::VonKarman ? spec->cn2 : spec->strength;
        if (source * strength == 0) {
            notes.push_back(fmt::format("medium.{}: left out, its strength is zero", i));
            return;
        }
        switch (spec->form) {
            case TurbulenceForm::Screens:
                add_screens(i, *spec);
                break;
            case TurbulenceForm::Lattice:
                add_lattice(i, *spec);
                break;
            case TurbulenceForm::GradientNoise:
                add_noise(i, *spec);
                break;
        }
    }

    void add_screens(std::size_t i, const TurbulenceSpec& spec) {
        const double half_w = 0.5 * settings.width / reference.f_px;
        const double half_h = 0.5 * settings.height / (reference.f_px * reference.pixel_aspect);
        const ScreenView view{perspective(),      settings.far,          half_w,      half_h,
                              1 / reference.f_px, scene.optics.aperture, settings.fps};
        std::vector<ScreenGeometry> geometry = layout_screens(spec, view);
        check_screens(spec, geometry, memory_limit());
        const ScreenGeometry& middle = geometry[geometry.size() / 2];
        notes.push_back(
            fmt::format("medium.{}: model screens ({} view): {} screens of {} x {} x {} samples over {:g} m, {:.3g} m "
                        "apart, periods {:.3g} x {:.3g} m, {:.3g} s",
                        i, perspective() ? "perspective" : "orthographic", geometry.size(), middle.nx, middle.ny,
                        middle.nt, settings.far, middle.thickness, middle.Lx, middle.Ly, middle.T));
        layers.push_back(
            {i, Model::Screens, ScreenField(spec, std::move(geometry), reference.right, reference.up), {}, 0});
        if (glm::dot(spec.velocity, reference.forward) != 0)
            notes.push_back(
                fmt::format("medium.{}: the wind's part along the view axis ({:.3g} m/s) does not move thin screens", i,
                            glm::dot(spec.velocity, reference.forward)));
        const double focusing = strength * strength * focusing_of(layers.back(), settings.far);
        if (focusing > 0.5)
            warnings.push_back(
                fmt::format("medium.{}: focusing variance {:.2g} at {:g} m: rays fold, where any first-order warp is "
                            "only plausible; "
                            "weaken cn2, shorten the distance, or widen the aperture",
                            i, focusing, settings.far));
    }

    void add_lattice(std::size_t i, const TurbulenceSpec& spec) {
        const LatticeGeometry geometry = choose_lattice(spec);
        check_lattice(spec, geometry, memory_limit());
        const PathRays rays = nearest_axis(reference, scene.optics.aperture);
        const bool aligned = 1 - axis_alignment(reference, rays) < kAligned && !camera_moves();
        const bool falloff_across = !spec.falloff || std::abs(spec.falloff->normal[rays.axis]) < 1e-9;
        const bool spectral_applies = !perspective() && aligned && falloff_across;
        Model model = spectral_applies ? Model::Spectral : Model::FirstOrder;
        std::string why = spectral_applies ? "orthographic view along a lattice axis"
                          : perspective()  ? "perspective view through a lattice"
                          : !aligned       ? "the view is not along a lattice axis"
                                           : "the falloff varies along the rays";
        if (settings.model && *settings.model != Model::Screens) {
            model = *settings.model;
            why = "asked for";
            if (model == Model::Spectral && !spectral_applies)
                throw UserError(
                    fmt::format("--model spectral: medium.{} needs an orthographic camera that looks along x, y or z, "
                                "and a falloff "
                                "across the view, but here {}; use --model first-order or tables",
                                i,
                                perspective()                    ? "the camera is perspective"
                                : camera_moves() ? "the camera moves"
                                : !aligned       ? "the view is oblique"
                                                                 : "the falloff is along it"));
            if (model != Model::FirstOrder && !falloff_across)
                throw UserError(fmt::format("--model {}: the falloff of medium.{} varies along the view, which tables cannot hold; use "
                                            "--model first-order", name_of(model), i));
            if (model != Model::FirstOrder && axis_alignment(reference, rays) < kLeastAlignment)
                throw UserError(fmt::format(
                    "--model {}: the view is more than 30 degrees from every lattice axis; use --model first-order",
                    name_of(model)));
        }
        notes.push_back(
            fmt::format("medium.{}: model {} ({}): lattice {} x {} x {} x {}, periods {:g} x {:g} x {:g} m, {:g} s", i,
                        name_of(model), why, geometry.size[0], geometry.size[1], geometry.size[2], geometry.size[3],
                        geometry.period[0], geometry.period[1], geometry.period[2], geometry.period[3]));
        if (settings.far > geometry.period[static_cast<std::size_t>(rays.axis)])
            warnings.push_back(fmt::format(
                "medium.{}: the path of {:g} m is longer than the lattice period of {:g} m along it, beyond which "
                "the field repeats and displacement is overstated; use form=\"screens\", --far or a longer period",
                i, settings.far, geometry.period[static_cast<std::size_t>(rays.axis)]));
        Layer layer{i, model, LatticeField(spec, geometry), {}, 0};
        layer.cell = {geometry.spacing(0), geometry.spacing(1), geometry.spacing(2)};
        if (model != Model::FirstOrder) {
            const std::array paths{kNearestPadded * settings.far, settings.far};
            layer.padding = path_padding(std::get<LatticeField>(layer.field), rays, paths,
                                         model == Model::Spectral ? kPathTableError : kTableSplineError);
        }
        if (model == Model::Table) {
            const auto& field = std::get<LatticeField>(layer.field);
            const auto x1 = field.displacement_variance(rays.axis, settings.far, rays.aperture);
            const auto force = slice_variance(field, rays);
            const double f2 = force[0] + force[1];
            layer.constant = f2 > 0 ? std::sqrt((x1[0] + x1[1]) / f2) / settings.far : 0;
        }
        layers.push_back(std::move(layer));
    }

    void add_noise(std::size_t i, const TurbulenceSpec& spec) {
        notes.push_back(fmt::format("medium.{}: model first-order (gradient noise has no other), not periodic", i));
        layers.push_back({i, Model::FirstOrder, GradientNoiseField(spec), dvec3(0.5 * spec.inner_scale), 0});
    }

    [[noreturn]] void refuse_model() const {
        std::string have;
        for (const Layer& l : layers)
            have += fmt::format("{}medium.{}: {}", have.empty() ? "" : ", ", l.medium, name_of(l.model));
        throw UserError(fmt::format(
            "--model {}: no medium of this scene suits it ({}); screens goes with form=\"screens\", the others with "
            "form=\"lattice\" (--set medium.0.form=lattice)",
            name_of(*settings.model), have));
    }

    /// A camera with a path is taken to turn: no lattice axis is its view's in every frame.
    bool camera_moves() const { return path.moving(); }

    double focusing_of(const Layer& layer, double D) const {
        const auto* field = std::get_if<ScreenField>(&layer.field);
        return field ? field->focusing_variance(D, perspective()) : 0;
    }

    const TurbulenceSpec& spec(const Layer& layer) const { return std::get<TurbulenceSpec>(scene.media[layer.medium]); }

    double time(double frame) const { return (frame - scene.time.first_frame) / settings.fps; }

    LayerInstant instant(const Layer& layer, const Camera& camera, double t, double nearest, double farthest) const {
        const double aperture = scene.optics.aperture;
        if (const auto* field = std::get_if<ScreenField>(&layer.field))
            return ScreensInstant{field->at(t), reference, strength, spec(layer).falloff};
        if (const auto* field = std::get_if<GradientNoiseField>(&layer.field))
            return FirstOrderInstant{GradientNoiseInstant{field, t}, strength, layer.cell, aperture, settings.far};
        const auto& field = std::get<LatticeField>(layer.field);
        const PathRays rays = nearest_axis(camera, aperture);
        switch (layer.model) {
            case Model::Table:
                return slice_instant(field, t, rays, settings.far, layer.constant, strength, layer.padding);
            case Model::Tables: {
                std::vector<double> depths;
                for (int k = 1; k <= kTables; ++k) depths.push_back(settings.far * k / kTables);
                return exact_instant(field, t, rays, depths, DepthInterpolation::Linear, strength, layer.padding);
            }
            case Model::Spectral:
                return exact_instant(field, t, rays, spectral_depths(field, rays, nearest, farthest),
                                     DepthInterpolation::Hermite, strength, layer.padding);
            default:
                return FirstOrderInstant{LatticeSnapshot(field, t, first_order_padding(field.geometry())), strength,
                                         layer.cell, aperture, settings.far};
        }
    }
};

namespace {

constexpr int kMostFirstOrderDepths = 33;

/// Layers of the first-order model: evenly spaced, a step or two apart where that is not too many.
Band first_order_band(const FirstOrderInstant& model, const Camera& camera, double nearest, double farthest) {
    Band band;
    band.perspective = camera.projection == Projection::Perspective;
    band.interpolation = DepthInterpolation::Hermite;
    if (farthest > nearest) {
        const double wanted = (farthest - nearest) * model.cells_along(camera.forward) / 2;
        const int intervals =
            std::clamp(static_cast<int>(std::ceil(std::min(wanted, 1e6))), 1, kMostFirstOrderDepths - 1);
        for (int i = 0; i <= intervals; ++i) {
            // even in the logarithm: near objects need finer layers, their angles being the larger
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

/// Empty bands for the layers of an instant.
std::vector<Band> bands_of(const LayerInstant& layer, const Camera& camera, double nearest, double farthest) {
    if (const auto* screens = std::get_if<ScreensInstant>(&layer)) return screens->bands(camera, nearest, farthest);
    if (const auto* tables = std::get_if<TablesInstant>(&layer)) return {tables->band(camera)};
    return {first_order_band(std::get<FirstOrderInstant>(layer), camera, nearest, farthest)};
}

}  // namespace

struct Displacer::Instant::State {
    Camera camera;
    std::vector<LayerInstant> layers;
    std::vector<Band> blank;         ///< bands without nodes
    std::vector<std::size_t> owner;  ///< index of the layer that fills each band
};

Displacer::Instant::Instant(std::unique_ptr<State> state) : state_(std::move(state)) {}
Displacer::Instant::Instant(Instant&&) noexcept = default;
Displacer::Instant::~Instant() = default;
const Camera& Displacer::Instant::camera() const {
    return state_->camera;
}

namespace {

int tile_of(int pixel, int size) {
    return pixel >= 0 ? pixel / size : -((-pixel + size - 1) / size);
}

PixelWindow intersection(const PixelWindow& a, const PixelWindow& b) {
    const int x0 = std::max(a.x0, b.x0), y0 = std::max(a.y0, b.y0);
    return {x0, y0, std::min(a.x0 + a.width, b.x0 + b.width) - x0, std::min(a.y0 + a.height, b.y0 + b.height) - y0};
}

EIKONAL_CLONES void keep_finite(float* v, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
        const float a = v[i] == v[i] ? v[i] : 0.0f;
        v[i] = a > kLargestShift ? kLargestShift : (a < -kLargestShift ? -kLargestShift : a);
    }
}

}  // namespace

void Displacer::Instant::map(const PixelWindow& window, const DepthSource& depth, DepthMeeting meeting, double gain,
                             float* uv) const {
    const auto stride = 2 * static_cast<std::size_t>(window.width);
    const auto* plane = std::get_if<const DepthPlane*>(&depth);
    const int first_column = tile_of(window.x0, kTileWidth), first_row = tile_of(window.y0, kTileHeight);
    const int columns = tile_of(window.x0 + window.width - 1, kTileWidth) - first_column + 1;
    const int rows = tile_of(window.y0 + window.height - 1, kTileHeight) - first_row + 1;
    tbb::parallel_for(0, columns * rows, [&](int t) {
        const PixelWindow tile{(first_column + t % columns) * kTileWidth, (first_row + t / columns) * kTileHeight,
                               kTileWidth, kTileHeight};
        const PixelWindow part = intersection(tile, window);
        // Nodes on lines depend on where the line begins, and the march's reach on the whole tile; rays do not.
        std::vector<Band> bands = state_->blank;
        double largest = 0;
        for (std::size_t i = 0; i < bands.size(); ++i) {
            const LayerInstant& layer = state_->layers[state_->owner[i]];
            const bool whole = plane != nullptr && meeting == DepthMeeting::March;
            const PixelWindow& wanted = whole ? tile : PixelWindow{tile.x0, part.y0, tile.width, part.height};
            bands[i].cover(std::holds_alternative<FirstOrderInstant>(layer) ? part : wanted);
            std::visit([&](const auto& l) { l.fill(bands[i], state_->camera); }, layer);
            bands[i].scale(static_cast<float>(gain));
            if (whole) largest += bands[i].largest_shift();
        }
        const int reach = static_cast<int>(std::min(std::ceil(kOvershoot * largest) + 1, 1e6));
        std::optional<MeetTile> meet;
        if (plane) meet.emplace(**plane, part, meeting, reach);
        BandRows row;
        for (int y = part.y0; y < part.y0 + part.height; ++y) {
            float* out = uv + static_cast<std::size_t>(y - window.y0) * stride +
                         2 * static_cast<std::size_t>(part.x0 - window.x0);
            const std::size_t values = 2 * static_cast<std::size_t>(part.width);
            row.start(bands, y);
            if (meet) {
                meet->row(row, y, out);
            } else {
                std::fill(out, out + values, 0.0f);
                row.add_constant_depth(part.x0, part.width, std::get<double>(depth), out);
            }
            keep_finite(out, values);
        }
    });
}

Displacer::Displacer(const Scene& scene, const DisplacerSettings& settings)
    : shot_(std::make_unique<Shot>(scene, settings)) {}
Displacer::~Displacer() = default;
Displacer::Displacer(Displacer&&) noexcept = default;

Displacer::Instant Displacer::at(double frame, double nearest, double farthest) const {
    nearest = std::max(nearest, kLeastDepth);
    farthest = std::max(nearest, farthest);
    auto state = std::make_unique<Instant::State>();
    state->camera = shot_->path.at(frame);
    const double t = shot_->time(frame);
    for (const Layer& layer : shot_->layers) {
        state->layers.push_back(shot_->instant(layer, state->camera, t, nearest, farthest));
        for (Band& band : bands_of(state->layers.back(), state->camera, nearest, farthest)) {
            state->blank.push_back(std::move(band));
            state->owner.push_back(state->layers.size() - 1);
        }
    }
    return Instant(std::move(state));
}

double Displacer::expected_rms(double D) const {
    const Camera& camera = shot_->reference;
    const double pixels = shot_->perspective() ? camera.f_px / D : camera.f_px;  // of one metre of x1
    const double strength2 = shot_->strength * shot_->strength;
    const double aspect2 = camera.pixel_aspect * camera.pixel_aspect;
    double variance = 0;
    for (const Layer& layer : shot_->layers) {
        if (const auto* field = std::get_if<ScreenField>(&layer.field)) {
            variance += strength2 * (1 + aspect2) * field->displacement_angle_variance(D) * (pixels * D) * (pixels * D);
        } else if (const auto* lattice = std::get_if<LatticeField>(&layer.field)) {
            const PathRays rays = nearest_axis(camera, shot_->scene.optics.aperture);
            const auto x1 = lattice->displacement_variance(rays.axis, D, rays.aperture);
            variance += strength2 * 0.5 * (1 + aspect2) * (x1[0] + x1[1]) * pixels * pixels;
        } else {
            const RandomStream stream(1, "expected rms");
            double sum = 0;
            for (int i = 0; i < kRmsRays; ++i) {
                const auto draw = [&](int c) { return stream.uniform(static_cast<std::uint64_t>(4 * i + c)); };
                const LayerInstant instant = shot_->instant(layer, camera, 1e3 * draw(2), D, D);
                Band band = bands_of(instant, camera, D, D).front();
                band.spacing = 1;
                band.column0 = static_cast<int>(draw(0) * shot_->settings.width);
                band.row0 = static_cast<int>(draw(1) * shot_->settings.height);
                band.columns = band.rows = 1;
                band.nodes.assign(1, Node{});
                std::get<FirstOrderInstant>(instant).fill(band, camera);
                const double scale = shot_->perspective() ? 1 / D : 1.0;
                const Node x = band.nodes[0];
                sum += scale * scale * (double{x[0]} * x[0] + double{x[1]} * x[1]);
            }
            variance += sum / kRmsRays;
        }
    }
    return std::sqrt(variance);
}

double Displacer::focusing_variance(double D) const {
    double sum = 0;
    for (const Layer& layer : shot_->layers) sum += shot_->strength * shot_->strength * shot_->focusing_of(layer, D);
    return sum;
}

const std::vector<std::string>& Displacer::notes() const {
    return shot_->notes;
}
const std::vector<std::string>& Displacer::warnings() const {
    return shot_->warnings;
}
std::vector<std::string> Displacer::models() const {
    std::vector<std::string> names;
    for (const Layer& layer : shot_->layers) names.emplace_back(name_of(layer.model));
    return names;
}
Camera Displacer::camera(double frame) const {
    return shot_->path.at(frame);
}

}  // namespace eikonal
