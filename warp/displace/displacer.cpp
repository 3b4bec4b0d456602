#include "warp/displace/displacer.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>

#include "noise/base/instruction_sets.h"
#include "noise/math/random.h"
#include "warp/displace/layers.h"
#include "warp/displace/stated_error.h"

namespace eikonal {
namespace {

/// Largest tile in pixels; bounds the memory of a thread. Tiles are anchored at (0, 0): a pixel's bits depend on its
/// tile, which is worked out whole, and not on the window asked for.
constexpr int kTileWidth = 512, kTileHeight = 64;
/// Tiles of smaller pictures are no larger than these, to a multiple of this: rays far beyond them may be very oblique.
constexpr int kTileUnit = 16;

int tile_side(int picture, int largest) {
    return std::min(largest, (picture + kTileUnit - 1) / kTileUnit * kTileUnit);
}
/// Tiles of pictures with a mirage and other media are as long as the picture the way that the mirage moves, up to
/// this, and as wide: a ray that it bends passes the air of far pixels.
constexpr int kAirTileLength = 2048, kAirTileWidth = 128;
/// How far beyond a tile, in pictures, the air is looked up; farther out it is that of the border.
constexpr double kAirAround = 0.5;
/// Where the air of a mirage's rays begins to be told apart, as a part of the farthest depth: objects need no layers
/// before them, but rays turn there.
constexpr double kNearestAir = 1.0 / 64;
/// To a float's precision.
constexpr int kMeetingHalvings = 30;
/// Between nodes and layers the interpolant may exceed them by this factor.
constexpr double kOvershoot = 1.6;
/// Least depth that layers are made for [m]: nearer ones move as at this one, which is not at all.
constexpr double kLeastDepth = 1e-12;

/// What the interpolation in lattices that a ray and its judge share may move the pixel by, drawn from what is expected
/// [px].
dvec2 drawn_interpolation(const AirInstant& field, const Camera& camera, const SamplePixel& pixel, double depth) {
    const StraightRay ray = straight_ray(camera, pixel.x + 0.5, pixel.y + 0.5);
    const double shift = field.interpolation(ray.at(0), ray.at(depth)).shift;
    if (!(shift > 0)) return {0, 0};
    dvec2 gaussian;
    RandomStream(0, "interpolation", static_cast<std::uint64_t>(pixel.x))
        .gaussians(static_cast<std::uint64_t>(pixel.y), gaussian.x, gaussian.y);
    const double scale = camera.projection == Projection::Perspective ? camera.f_px / depth : camera.f_px;
    return std::sqrt(0.5) * shift * scale * gaussian;
}

}  // namespace

struct Displacer::Shot {
    Scene scene;
    DisplacerSettings settings;
    CameraPath path;
    MediaLayers media;

    Shot(const Scene& s, const DisplacerSettings& set)
        : scene(s),
          settings(set),
          path(s.camera, set.width, set.height, set.pixel_aspect, set.fov),
          media(scene, settings, path) {}
    Shot(const Shot&) = delete;  // media refers to the members before it

    double time(double frame) const { return (frame - scene.time.first_frame) / settings.fps; }
};

struct Displacer::Instant::State {
    const MediaLayers* media;
    Camera camera;
    double t, nearest, farthest, gain;
    bool (*cancelled)();
    int tile_width, tile_height;
    std::vector<LayerInstant> own;                     ///< of every layer
    std::vector<LayerInstant> joint;                   ///< of second-order: the one that bends rays instead
    std::vector<std::vector<DisplacementGrid>> blank;  ///< of each that does
    std::vector<Mirage> mirages;

    mutable std::once_flag judged;
    mutable std::optional<BentRays> judge;  ///< of maps; made when first asked for

    const std::vector<LayerInstant>& bending() const { return joint.empty() ? own : joint; }
    const BentRays& reference() const {
        std::call_once(judged, [&] { judge.emplace(media->together(own, camera, t, nearest, farthest, gain, true)); });
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

int Displacer::Instant::State::reach(const std::vector<DisplacementGrid>& grids, std::span<const Mirage> near,
                                     const PixelWindow& window) const {
    double largest = 0;
    for (const DisplacementGrid& grid : grids) largest += grid.largest_shift();
    for (const Mirage& m : near) largest += m.largest_shift(window);
    return static_cast<int>(std::min(std::ceil(kOvershoot * largest) + 1, 1e6));
}

const Mirage* Displacer::Instant::State::air_bender(const PixelWindow& tile) const {
    if (bending().empty()) return nullptr;
    const auto bends = [&](const Mirage& m) { return m.touches(tile); };
    const auto first = std::find_if(mirages.begin(), mirages.end(), bends);
    return first == mirages.end() ? nullptr : &*first;
}

PixelWindow Displacer::Instant::State::air_around(const Mirage& mirage, const PixelWindow& tile) const {
    const dvec2 across = mirage.axes(tile.x0 + tile.width / 2, tile.y0 + tile.height / 2).across;
    const dvec2 way = mirage.way() / std::max(glm::length(across), 1e-300) * across;
    const auto limited = [](double part, double picture) {
        return static_cast<int>(std::clamp(part, -kAirAround * picture, kAirAround * picture));
    };
    int x0 = tile.x0, y0 = tile.y0, x1 = tile.x0 + tile.width, y1 = tile.y0 + tile.height;
    for (int y = tile.y0; y < tile.y0 + tile.height; ++y) {
        const double most = mirage.largest_shift({tile.x0, y, tile.width, 1});
        const int dx = limited(most * way.x, 2 * camera.center.x), dy = limited(most * way.y, 2 * camera.center.y);
        x0 = std::min(x0, tile.x0 + dx);
        x1 = std::max(x1, tile.x0 + tile.width + dx);
        y0 = std::min(y0, y + dy);
        y1 = std::max(y1, y + dy + 1);
    }
    return {x0, y0, x1 - x0, y1 - y0};
}

double Displacer::Instant::State::meeting_with_surface(GridRows& row, const std::vector<double>& depths, int x,
                                                       int y) const {
    const auto below = [&](double z) {
        const Shift d = row.at(x, z);
        const dvec3 there = straight_ray(camera, x + 0.5 + d.x, y + 0.5 + d.y).at(z);
        return std::any_of(media->surface_layers().begin(), media->surface_layers().end(),
                           [&](const SurfaceIndex& surface) { return surface.height(there) < 0; });
    };
    double above = 0;
    for (double z : depths) {
        if (!below(z)) {
            above = z;
            continue;
        }
        for (int i = 0; i < kMeetingHalvings; ++i) {
            const double middle = 0.5 * (above + z);
            (below(middle) ? z : above) = middle;
        }
        return z;
    }
    return std::numeric_limits<double>::infinity();
}

bool Displacer::Instant::State::falls_through(GridRows& row, const DepthPlane& depth, const SamplePixel& p) const {
    const double end = row.end(p.x);
    if (!std::isfinite(end)) return false;
    const Shift d = row.at(p.x, end);
    const double x = std::floor(p.x + 0.5 + d.x), y = std::floor(p.y + 0.5 + d.y);
    const PixelWindow& w = depth.window();
    if (!(x >= w.x0 && x < w.x0 + w.width && y >= w.y0 && y < w.y0 + w.height)) return false;  // not known
    const double z = depth.at(static_cast<int>(x), static_cast<int>(y));
    const auto below = [&](const SurfaceIndex& surface) {
        double highest = -std::numeric_limits<double>::infinity();  // of what the pixel may show
        for (const dvec2 corner : {dvec2(0, 0), dvec2(1, 0), dvec2(0, 1), dvec2(1, 1)})
            highest = std::max(highest, surface.height(straight_ray(camera, x + corner.x, y + corner.y).at(z)));
        return highest < -kGroundTolerance;
    };
    return std::any_of(media->surface_layers().begin(), media->surface_layers().end(), below);
}

/// The grids of every layer on a tile, filled and scaled.
std::vector<DisplacementGrid> Displacer::Instant::State::tile_grids(const PixelWindow& tile,
                                                                    const PixelWindow& cover) const {
    std::vector<DisplacementGrid> grids;
    const std::vector<LayerInstant>& layers = bending();
    for (std::size_t i = 0; i < layers.size(); ++i) {
        if (const auto* blobs = std::get_if<SeenBlobs>(&layers[i])) {
            for (DisplacementGrid& grid : blobs->grids(tile, cover, nearest, farthest)) {
                grid.scale(static_cast<float>(gain));
                grids.push_back(std::move(grid));
            }
            continue;
        }
        const bool has_gain = std::holds_alternative<BentRays>(layers[i]);
        for (DisplacementGrid grid : blank[i]) {
            grid.cover(cover);
            std::visit(
                [&](const auto& layer) {
                    if constexpr (requires { layer.fill(grid, camera); }) layer.fill(grid, camera);
                },
                layers[i]);
            if (!has_gain) grid.scale(static_cast<float>(gain));
            grids.push_back(std::move(grid));
        }
    }
    return grids;
}

Displacer::Instant::Instant(std::unique_ptr<State> state) : state_(std::move(state)) {}
Displacer::Instant::Instant(Instant&&) noexcept = default;
Displacer::Instant::~Instant() = default;
const Camera& Displacer::Instant::camera() const {
    return state_->camera;
}

namespace {

PixelWindow intersection(const PixelWindow& a, const PixelWindow& b) {
    const int x0 = std::max(a.x0, b.x0), y0 = std::max(a.y0, b.y0);
    return {x0, y0, std::min(a.x0 + a.width, b.x0 + b.width) - x0, std::min(a.y0 + a.height, b.y0 + b.height) - y0};
}

/// Whether all are numbers up to kLargestShift.
EIKONAL_CLONES bool within_largest(const float* v, std::size_t n) {
    constexpr auto largest = static_cast<float>(kLargestShift);
    int beyond = 0;
    for (std::size_t i = 0; i < n; ++i) beyond |= v[i] >= -largest && v[i] <= largest ? 0 : 1;
    return beyond == 0;
}

void refuse_beyond(const float* v, std::size_t n) {
    if (within_largest(v, n)) return;
    throw FrameError(
        fmt::format("a pixel would move by more than {:g} px, the most that a map holds; weaken the media (cn2, "
                    "strength, temperatures), or lower optics.exaggeration, --gain or --rms",
                    kLargestShift));
}

}  // namespace

void Displacer::Instant::map(const PixelWindow& window, const DepthSource& depth, DepthMeeting meeting,
                             float* uv) const {
    const auto stride = 2 * static_cast<std::size_t>(window.width);
    const auto* plane = std::get_if<const DepthPlane*>(&depth);
    const bool march = plane != nullptr && meeting == DepthMeeting::March;
    const int side_x = state_->tile_width, side_y = state_->tile_height;
    const int first_column = floor_div(window.x0, side_x), first_row = floor_div(window.y0, side_y);
    const int columns = floor_div(window.x0 + window.width - 1, side_x) - first_column + 1;
    const int rows = floor_div(window.y0 + window.height - 1, side_y) - first_row + 1;
    tbb::parallel_for(0, columns * rows, [&](int t) {
        check_cancelled(state_->cancelled);
        const PixelWindow tile{(first_column + t % columns) * side_x, (first_row + t / columns) * side_y, side_x,
                               side_y};
        const PixelWindow part = intersection(tile, window);
        // Nodes on lines depend on where the line begins, and the march's reach on the whole tile.
        const PixelWindow asked = march ? tile : PixelWindow{tile.x0, part.y0, tile.width, part.height};
        const std::span<const Mirage> mirages = state_->mirages_on(tile);
        const Mirage* bending = state_->air_bender(tile);
        const PixelWindow around = bending != nullptr ? state_->air_around(*bending, tile) : tile;
        const std::vector<DisplacementGrid> grids = state_->tile_grids(around, bending != nullptr ? around : asked);
        const MirageAir air = bending != nullptr
                                  ? MirageAir(grids, *bending, asked, around, state_->nearest, state_->farthest)
                                  : MirageAir();
        const int reach = march ? state_->reach(grids, mirages, tile) : 1;
        std::optional<TileMeeting> meet;
        if (plane) meet.emplace(**plane, part, meeting, reach, mirages);
        GridRows row;
        for (int y = part.y0; y < part.y0 + part.height; ++y) {
            float* out = uv + static_cast<std::size_t>(y - window.y0) * stride +
                         2 * static_cast<std::size_t>(part.x0 - window.x0);
            const std::size_t values = 2 * static_cast<std::size_t>(part.width);
            row.start(grids, y, mirages, 1, bending != nullptr ? &air : nullptr);
            if (meet) {
                meet->row(row, y, out);
            } else {
                std::fill(out, out + values, 0.0f);
                row.add_constant_depth(part.x0, part.width, std::get<double>(depth), out);
            }
            refuse_beyond(out, values);
        }
    });
}

StatedError Displacer::Instant::stated_error(const PixelWindow& window, const DepthSource& depth, DepthMeeting meeting,
                                             const float* uv) const {
    const bool blobs = std::any_of(state_->own.begin(), state_->own.end(),
                                   [](const LayerInstant& layer) { return std::holds_alternative<SeenBlobs>(layer); });
    const auto samples = static_cast<int>(std::min<std::size_t>(window.area() / kPixelsPerSample, kErrorSamples));
    return statistics_of(
        sampled_errors(window, depth, meeting, uv, std::max(blobs ? samples / 2 : samples, kFewestErrorSamples)));
}

std::vector<double> Displacer::Instant::sampled_errors(const PixelWindow& window, const DepthSource& depth,
                                                       DepthMeeting meeting, const float* uv, int samples) const {
    const State& s = *state_;
    const auto* plane = std::get_if<const DepthPlane*>(&depth);
    const BentRays& bent = s.reference();
    return sample_errors(choose_samples(window, depth, uv, samples), [&](const SamplePixel& p) {
        const PixelWindow pixel{p.x, p.y, 1, 1};
        BentPixel judge = bent_pixel(bent, s.camera, p.x, p.y, plane ? s.farthest : p.depth);
        constexpr float kUnknown = std::numeric_limits<float>::infinity();
        if (judge.lost_at < p.depth) return Shift{kUnknown, kUnknown};
        const std::vector<DisplacementGrid> grids{std::move(judge.grid)};
        // the bent ray has passed over the surfaces: mirages only tell which pixels they move
        std::span<const Mirage> mirages = s.mirages_on(pixel);
        GridRows row;
        row.start(grids, p.y, mirages, 0);
        if (row.mirage_moves(p.x)) row.end_at(s.meeting_with_surface(row, grids.front().depths, p.x, p.y));
        if (plane && s.falls_through(row, **plane, p)) row.start(grids, p.y, mirages = {});
        std::array<float, 2> d{};
        if (plane) {
            TileMeeting(**plane, pixel, meeting, s.reach(grids, {}, pixel), mirages).row(row, p.y, d.data());
            const bool perspective = s.camera.projection == Projection::Perspective;
            if (!row.mirage_moves(p.x)) {
                const Shift smooth = meet_smooth_surface(row, **plane, perspective, p.x, p.y, {d[0], d[1]});
                d = {smooth.x, smooth.y};
            }
        } else {
            const Shift shift = row.at(p.x, std::min(p.depth, row.end(p.x)));
            d = {shift.x, shift.y};
        }
        const dvec2 off = drawn_interpolation(bent.field, s.camera, p, plane ? std::min(p.depth, s.farthest) : p.depth);
        d = {d[0] + static_cast<float>(off.x), d[1] + static_cast<float>(off.y)};
        refuse_beyond(d.data(), 2);
        return Shift{d[0], d[1]};
    });
}

Displacer::Displacer(const Scene& scene, const DisplacerSettings& settings)
    : shot_(std::make_unique<Shot>(scene, settings)) {}
Displacer::~Displacer() = default;
Displacer::Displacer(Displacer&&) noexcept = default;

Displacer::Instant Displacer::at(double frame, double nearest, double farthest, double gain) const {
    nearest = std::max(nearest, kLeastDepth);
    farthest = std::max(nearest, farthest);
    const MediaLayers& media = shot_->media;
    const bool air_is_bent = !media.surfaces().empty() && !media.layers().empty();
    if (air_is_bent) nearest = std::min(nearest, kNearestAir * farthest);
    auto state = std::make_unique<Instant::State>();
    state->media = &media;
    state->camera = shot_->path.at(frame);
    state->nearest = nearest;
    state->farthest = farthest;
    state->gain = gain;
    state->cancelled = shot_->settings.cancelled;
    state->tile_width = tile_side(shot_->settings.width, kTileWidth);
    state->tile_height = tile_side(shot_->settings.height, kTileHeight);
    const double t = state->t = shot_->time(frame);
    state->own = media.instants(state->camera, t, nearest, farthest, gain);
    if (media.second_order() && !state->own.empty())
        state->joint.push_back(media.together(state->own, state->camera, t, nearest, farthest, gain, false));
    for (const LayerInstant& layer : state->bending())
        state->blank.push_back(blank_grids(layer, state->camera, nearest, farthest));
    for (const auto& [medium, spec] : media.surfaces()) {
        state->mirages.emplace_back(spec, media.law(), shot_->scene.optics.exaggeration,
                                    shot_->scene.optics.ray_equation, state->camera, farthest,
                                    fmt::format("medium.{}", medium));
    }
    if (air_is_bent) {
        const dvec2 across = state->mirages.front().axes(shot_->settings.width / 2, shot_->settings.height / 2).across;
        const bool upright = std::abs(across.y) >= std::abs(across.x);
        state->tile_width = tile_side(shot_->settings.width, upright ? kAirTileWidth : kAirTileLength);
        state->tile_height = tile_side(shot_->settings.height, upright ? kAirTileLength : kAirTileWidth);
    }
    return Instant(std::move(state));
}

std::uint64_t Displacer::instant_bytes() const {
    return shot_->media.instant_bytes();
}

double Displacer::expected_rms(double D) const {
    double variance = 0;
    for (const MediumLayer& layer : shot_->media.layers()) variance += shot_->media.expected_variance(layer, D);
    return std::sqrt(variance);
}

double Displacer::focusing_variance(double D) const {
    double sum = 0;
    for (const MediumLayer& layer : shot_->media.layers()) sum += shot_->media.focusing_variance(layer, D);
    return sum;
}

const std::vector<std::string>& Displacer::notes() const {
    return shot_->media.notes();
}
const std::vector<std::string>& Displacer::warnings() const {
    return shot_->media.warnings();
}
std::vector<std::string> Displacer::beyond_far(double farthest) const {
    return shot_->media.beyond_far(farthest);
}
std::vector<std::string> Displacer::models() const {
    std::vector<std::string> names;
    for (const MediumLayer& layer : shot_->media.layers()) names.emplace_back(name_of(layer.model));
    return names;
}
bool Displacer::mirages() const {
    return !shot_->media.surfaces().empty();
}
Camera Displacer::camera(double frame) const {
    return shot_->path.at(frame);
}

}  // namespace eikonal
