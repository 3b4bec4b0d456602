#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "noise/base/instruction_sets.h"
#include "noise/math/random.h"
#include "warp/displace/displacer_state.h"
#include "warp/displace/media/surface/mirage_meeting.h"
#include "warp/displace/media/surface/mirage_row.h"

namespace eikonal {
namespace {

/// How often an interval of depths is halved. The result is as exact as a float.
constexpr int kMeetingHalvings = 30;

/// A random shift of the pixel [px] with the expected variance of the error of the lattices' splines. The map and the
/// ray that judges it read a lattice through the same spline, so their difference does not show this error.
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

/// Whether all n values are numbers of at most kLargestShift in magnitude.
EIKONAL_CLONES bool within_largest(const float* v, std::size_t n) {
    constexpr auto largest = static_cast<float>(kLargestShift);
    int beyond = 0;
    for (std::size_t i = 0; i < n; ++i) beyond |= v[i] >= -largest && v[i] <= largest ? 0 : 1;
    return beyond == 0;
}

}  // namespace

void refuse_beyond(const float* v, std::size_t n) {
    if (within_largest(v, n)) return;
    throw FrameError(
        fmt::format("a pixel would move by more than {:g} px, the most that a map holds; weaken the media (cn2, "
                    "strength, temperatures), or lower optics.exaggeration, `gain` or `rms`",
                    kLargestShift));
}

double Displacer::Instant::State::meeting_with_surface(GridRows& row, const std::vector<double>& depths, int x,
                                                       int y) const {
    const auto below = [&](double z) {
        const Shift d = row.at(x, z);
        const dvec3 there = straight_ray(camera, x + 0.5 + d.x, y + 0.5 + d.y).at(z);
        return std::any_of(media->surfaces().begin(), media->surfaces().end(), [&](const ShotMedia::Surface& surface) {
            return surface.medium->index().height(there) < 0;
        });
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
    const double end = row.ray_end(p.x);
    if (!std::isfinite(end)) return false;
    const Shift d = row.at(p.x, end);
    const double x = std::floor(p.x + 0.5 + d.x), y = std::floor(p.y + 0.5 + d.y);
    const PixelWindow& w = depth.window();
    if (!(x >= w.x0 && x < w.x0 + w.width && y >= w.y0 && y < w.y0 + w.height)) return false;  // depth unknown there
    const double z = depth.at(static_cast<int>(x), static_cast<int>(y));
    const auto below = [&](const ShotMedia::Surface& surface) {
        double highest = -std::numeric_limits<double>::infinity();  // height of the points that the pixel may show
        for (const dvec2 corner : {dvec2(0, 0), dvec2(1, 0), dvec2(0, 1), dvec2(1, 1)})
            highest = std::max(highest,
                               surface.medium->index().height(straight_ray(camera, x + corner.x, y + corner.y).at(z)));
        return highest < -kGroundTolerance;
    };
    return std::any_of(media->surfaces().begin(), media->surfaces().end(), below);
}

StatedError Displacer::Instant::stated_error(const PixelWindow& window, const DepthSource& depth, DepthMeeting meeting,
                                             const float* uv) const {
    const bool dear = std::any_of(state_->own.begin(), state_->own.end(), [](const auto& i) { return i->is_dear(); });
    const auto samples = static_cast<int>(std::min<std::size_t>(window.area() / kPixelsPerSample, kErrorSamples));
    return statistics_of(
        sampled_errors(window, depth, meeting, uv, std::max(dear ? samples / 2 : samples, kFewestErrorSamples)));
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
        std::span<const Mirage> mirages = s.mirages_on(pixel);
        KnownMirageRay known(mirages, p.x, p.y);
        std::array<RowBender*, 1> bender{&known};
        GridRows row;
        row.start(grids, p.y, bender);
        if (known.moves(p.x)) known.end_at(s.meeting_with_surface(row, grids.front().depths, p.x, p.y));
        if (plane && s.falls_through(row, **plane, p)) {
            mirages = {};
            row.start(grids, p.y);
        }
        std::array<float, 2> d{};
        if (plane) {
            const int reach = s.reach(grids, {}, pixel);
            TileMeeting(**plane, pixel, meeting, reach, mirage_meeting(**plane, pixel, meeting, reach, mirages))
                .row(row, p.y, d.data());
            const bool perspective = s.camera.projection == Projection::Perspective;
            if (!row.bender_moves(p.x)) {
                const Shift smooth = meet_smooth_surface(row, **plane, perspective, p.x, p.y, {d[0], d[1]});
                d = {smooth.x, smooth.y};
            }
        } else {
            const Shift shift = row.at(p.x, std::min(p.depth, row.ray_end(p.x)));
            d = {shift.x, shift.y};
        }
        const dvec2 off = drawn_interpolation(bent.field, s.camera, p, plane ? std::min(p.depth, s.farthest) : p.depth);
        d = {d[0] + static_cast<float>(off.x), d[1] + static_cast<float>(off.y)};
        refuse_beyond(d.data(), 2);
        return Shift{d[0], d[1]};
    });
}

}  // namespace eikonal
