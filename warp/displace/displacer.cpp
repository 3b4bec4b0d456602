#include "warp/displace/displacer.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>

#include "warp/displace/displacer_state.h"
#include "warp/displace/media/surface/mirage_meeting.h"
#include "warp/displace/media/surface/mirage_row.h"

namespace eikonal {
namespace {

/// Largest tile [px]. It bounds the memory of a thread. Tiles are anchored at pixel (0, 0), and each is computed as a
/// whole. The bits of a pixel therefore depend on its tile and not on the window asked for.
constexpr int kTileWidth = 512, kTileHeight = 64;
/// Tiles are no larger than the picture rounded up to a multiple of this [px]. Rays far outside a small picture may be
/// very oblique.
constexpr int kTileUnit = 16;

int tile_side(int picture, int largest) {
    return std::min(largest, (picture + kTileUnit - 1) / kTileUnit * kTileUnit);
}
/// Largest tiles of pictures that show a mirage and other media [px]. A ray that a mirage bends passes through the air
/// of distant pixels along the direction in which the mirage moves pixels. Tiles are long in that direction, up to
/// kAirTileLength, and kAirTileWidth wide across it.
constexpr int kAirTileLength = 2048, kAirTileWidth = 128;
/// How far beyond a tile the air is known for rays that a mirage bends, in picture sizes. Farther out the air of the
/// border is used.
constexpr double kAirAround = 0.5;
/// Nearest depth at which a mirage's rays see the other media, as a part of the farthest depth. The nearest object may
/// be farther, but the rays turn before they reach it.
constexpr double kNearestAir = 1.0 / 64;
/// The interpolant between nodes and depths may exceed their values by this factor.
constexpr double kOvershoot = 1.6;
/// Least depth that grids are made for [m]. Nearer objects are displaced as at this depth, where there is no
/// displacement.
constexpr double kLeastDepth = 1e-12;

}  // namespace

struct Displacer::Shot {
    Scene scene;
    DisplacerSettings settings;
    CameraPath path;
    ShotMedia media;

    Shot(const Scene& s, const DisplacerSettings& set, std::shared_ptr<const Air> air)
        : scene(s),
          settings(set),
          path(s.camera, set.width, set.height, set.pixel_aspect, set.fov),
          media(scene, settings, path, std::move(air)) {}
    Shot(const Shot&) = delete;  // media refers to the members before it

    double time(double frame) const { return (frame - scene.time.first_frame) / settings.fps; }
};

int Displacer::Instant::State::reach(const std::vector<DisplacementGrid>& grids, std::span<const Mirage> near,
                                     const PixelWindow& window) const {
    double largest = 0;
    for (const DisplacementGrid& grid : grids) largest += grid.largest_shift();
    for (const Mirage& m : near) largest += m.largest_shift(window);
    return static_cast<int>(std::min(std::ceil(kOvershoot * largest) + 1, 1e6));
}

const Mirage* Displacer::Instant::State::air_bender(const PixelWindow& tile) const {
    if (own.empty()) return nullptr;
    const auto bends = [&](const Mirage& m) { return m.touches(tile); };
    const auto first = std::find_if(mirages.begin(), mirages.end(), bends);
    return first == mirages.end() ? nullptr : &*first;
}

PixelWindow Displacer::Instant::State::air_around(const Mirage& mirage, const PixelWindow& tile) const {
    const dvec2 across = mirage.axes(tile.x0 + tile.width / 2, tile.y0 + tile.height / 2).across;
    const dvec2 way = mirage.bend_sign() / std::max(glm::length(across), 1e-300) * across;
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

/// The filled grids of all media on a tile.
std::vector<DisplacementGrid> Displacer::Instant::State::tile_grids(const PixelWindow& tile,
                                                                    const PixelWindow& cover) const {
    std::vector<DisplacementGrid> grids;
    if (joint) {
        grids.push_back(joint->grid(camera));
        grids.back().cover(cover);
        joint->fill(grids.back(), camera);
        return grids;
    }
    for (const auto& instant : own)
        for (DisplacementGrid& grid : instant->grids(tile, cover)) grids.push_back(std::move(grid));
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
        check_stop(state_->stop);
        const PixelWindow tile{(first_column + t % columns) * side_x, (first_row + t / columns) * side_y, side_x,
                               side_y};
        const PixelWindow part = intersection(tile, window);
        // Nodes on lines depend on where the line begins. The reach of the march depends on the whole tile.
        const PixelWindow asked = march ? tile : PixelWindow{tile.x0, part.y0, tile.width, part.height};
        const std::span<const Mirage> mirages = state_->mirages_on(tile);
        const Mirage* bending = state_->air_bender(tile);
        const PixelWindow around = bending != nullptr ? state_->air_around(*bending, tile) : tile;
        const std::vector<DisplacementGrid> grids = state_->tile_grids(around, bending != nullptr ? around : asked);
        const MirageAir air = bending != nullptr
                                  ? MirageAir(grids, *bending, asked, around, state_->nearest, state_->farthest)
                                  : MirageAir();
        const int reach = march ? state_->reach(grids, mirages, tile) : 1;
        std::optional<TileMeeting> tile_meeting;
        if (plane)
            tile_meeting.emplace(**plane, part, meeting, reach, mirage_meeting(**plane, part, meeting, reach, mirages));
        const MirageRows mirage_rows(mirages, bending != nullptr ? &air : nullptr);
        GridRows row;
        for (int y = part.y0; y < part.y0 + part.height; ++y) {
            float* out = uv + static_cast<std::size_t>(y - window.y0) * stride +
                         2 * static_cast<std::size_t>(part.x0 - window.x0);
            const std::size_t values = 2 * static_cast<std::size_t>(part.width);
            row.start(grids, y, mirage_rows.benders());
            if (tile_meeting) {
                tile_meeting->row(row, y, out);
            } else {
                std::fill(out, out + values, 0.0f);
                row.add_constant_depth(part.x0, part.width, std::get<double>(depth), out);
            }
            refuse_beyond(out, values);
        }
    });
}

Displacer::Displacer(const Scene& scene, const DisplacerSettings& settings, std::shared_ptr<const Air> air)
    : shot_(std::make_unique<Shot>(scene, settings, std::move(air))) {}
Displacer::~Displacer() = default;
Displacer::Displacer(Displacer&&) noexcept = default;

Displacer::Instant Displacer::at(double frame, double nearest, double farthest, double gain) const {
    nearest = std::max(nearest, kLeastDepth);
    farthest = std::max(nearest, farthest);
    const ShotMedia& media = shot_->media;
    const bool air_is_bent = !media.surfaces().empty() && !media.bends().empty();
    if (air_is_bent) nearest = std::min(nearest, kNearestAir * farthest);
    auto state = std::make_unique<Instant::State>();
    state->media = &media;
    state->camera = shot_->path.at(frame);
    state->nearest = nearest;
    state->farthest = farthest;
    state->gain = gain;
    state->stop = shot_->settings.stop;
    state->tile_width = tile_side(shot_->settings.width, kTileWidth);
    state->tile_height = tile_side(shot_->settings.height, kTileHeight);
    state->t = shot_->time(frame);
    state->own = media.at(state->view());
    if (media.second_order() && !state->own.empty())
        state->joint.emplace(media.bent_rays(state->own, state->view(), false));
    state->mirages = media.mirages(state->camera, farthest);
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
    for (const auto& bend : shot_->media.bends()) variance += bend->expected_variance(D, false);
    return std::sqrt(variance);
}

double Displacer::focusing_variance(double D) const {
    double sum = 0;
    for (const auto& bend : shot_->media.bends()) sum += bend->focusing_variance(D);
    return sum;
}

const std::vector<std::string>& Displacer::notes() const {
    return shot_->media.notes();
}
const std::vector<std::string>& Displacer::warnings() const {
    return shot_->media.warnings();
}
const std::vector<std::string>& Displacer::air_warnings() const {
    return shot_->media.air_warnings();
}
std::vector<std::string> Displacer::beyond_far(double farthest) const {
    return shot_->media.beyond_far(farthest);
}
std::vector<std::string> Displacer::models() const {
    std::vector<std::string> names;
    for (const auto& bend : shot_->media.bends()) names.emplace_back(name_of(bend->model()));
    return names;
}
bool Displacer::mirages() const {
    return !shot_->media.surfaces().empty();
}
const std::shared_ptr<const Air>& Displacer::air() const {
    return shot_->media.air();
}
Camera Displacer::camera(double frame) const {
    return shot_->path.at(frame);
}

}  // namespace eikonal
