#include "warp/displace/media/surface/mirage_air.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "noise/math/portable_math.h"
#include "warp/displace/grid/displacement_grid.h"

namespace eikonal {
namespace {

/// Least |sine| of the angle between the two axes of a bend in the picture. Below it they cannot be told apart.
constexpr double kLeastAngle = 1e-6;
/// Nodes are so close together that the plane, if it is seen tilted, climbs by this many pixels between them at most.
constexpr double kMostClimb = 0.25;
/// Rays whose elevations differ by this part of Mirage::quarter_pixel() or less share one response.
constexpr double kSameElevation = 0.1;

/// Where a depth lies among ascending depths: the indices of its two neighbours, and the weight of the upper.
struct Between {
    std::size_t lower, upper;
    double part;
};
Between between(const std::vector<double>& depths, double z) {
    if (z >= depths.back()) return {depths.size() - 1, depths.size() - 1, 0};
    if (z <= depths.front()) return {0, 0, 0};
    const auto upper = static_cast<std::size_t>(std::upper_bound(depths.begin(), depths.end(), z) - depths.begin());
    return {upper - 1, upper, (z - depths[upper - 1]) / (depths[upper] - depths[upper - 1])};
}

/// Interpolates linearly.
template <class Values>
double value_at(const Values& values, const Between& b) {
    return values[b.lower] + b.part * (values[b.upper] - values[b.lower]);
}

}  // namespace

/// The kicks of one grid's medium. Between two depths of a grid lies a slab of air, and so does before the first depth.
/// The kicks within a slab act as one, in its middle, with the moment that they have about its end.
struct MirageAir::GridKicks {
    struct Slab {
        double from, to, middle;  ///< axial depths [m]
        Between at_from, at_to;   ///< among the response's depths
        std::size_t after;        ///< first of the response's depths that lies beyond the middle
    };
    struct Kick {
        dvec2 kick;    ///< [px]
        dvec2 moment;  ///< about the slab's end [px·m]
    };
    const DisplacementGrid* grid;
    std::vector<Slab> slabs;

    GridKicks(const DisplacementGrid& of, const std::vector<double>& response_depths) : grid(&of) {
        double from = 0;
        for (const double to : of.depths) {
            const double middle = 0.5 * (from + to);
            const auto after = std::lower_bound(response_depths.begin(), response_depths.end(), middle);
            slabs.push_back({from, to, middle, between(response_depths, from), between(response_depths, to),
                             static_cast<std::size_t>(after - response_depths.begin())});
            from = to;
        }
    }

    /// The kick of a slab, at any place of the picture.
    Kick at(std::size_t slab, double x, double y) const {
        const GridPlace place = grid->place(x, y);
        const bool linear = grid->interpolation == DepthInterpolation::Linear;
        const Node end = grid->at(place, slab);
        const Node start = slab > 0 ? grid->at(place, slab - 1) : Node{};
        const dvec2 X0(start[0], start[1]), X1(end[0], end[1]);
        const double length = slabs[slab].to - slabs[slab].from;
        if (!linear) {
            const dvec2 S0(start[2], start[3]), S1(end[2], end[3]);
            return {S1 - S0, X1 - X0 - length * S0};
        }
        // A linear X bends at the grid's depths only.
        dvec2 slope_before(0, 0);
        if (slab > 0) {
            const Node earlier = slab > 1 ? grid->at(place, slab - 2) : Node{};
            slope_before = (X0 - dvec2(earlier[0], earlier[1])) / (slabs[slab - 1].to - slabs[slab - 1].from);
        }
        const dvec2 kick = (X1 - X0) / length - slope_before;
        return {kick, length * kick};
    }
};

/// How the rays of one elevation depend on their start.
struct MirageAir::Response {
    double w = std::numeric_limits<double>::quiet_NaN();  ///< sine of the elevation
    bool bent = false;
    double end = 0, anchor = 0;  ///< axial depths [m]
    std::vector<double> A, B;    ///< at each depth
    std::vector<double> rise;    ///< δ in the middle of every slab of every grid [m]
};

/// The changes of a ray's start that stand for all kicks before each depth.
struct MirageAir::StartChanges {
    std::array<double, kMostResponses> lift{}, tilt{};     ///< δH and δw, across the plane
    std::array<double, kMostResponses> offset{}, slope{};  ///< along the plane, where rays are straight
};

MirageAir::MirageAir(const std::vector<DisplacementGrid>& grids, const Mirage& mirage, const PixelWindow& pixels,
                     const PixelWindow& cover, double nearest, double farthest)
    : mirage_(&mirage), cover_(cover), row0_(pixels.y0) {
    const double octaves = portable::log(farthest / nearest) / portable::log(2);
    const int intervals =
        static_cast<int>(std::ceil(std::clamp(octaves * kResponsesAnOctave, 1.0, kMostResponses - 1.0)));
    for (int k = 0; k < intervals; ++k)
        depths_.push_back(nearest * portable::pow(farthest / nearest, static_cast<double>(k) / intervals));
    depths_.push_back(farthest);
    depths_.erase(std::unique(depths_.begin(), depths_.end()), depths_.end());

    spacing_ = kWidestSpacing;
    for (const DisplacementGrid& grid : grids) spacing_ = std::min(spacing_, grid.spacing);
    const auto [across, along] = mirage.axes(pixels.x0 + pixels.width / 2, pixels.y0 + pixels.height / 2);
    while (spacing_ > 1 && std::abs(across.x) * spacing_ > kMostClimb * glm::length(across)) spacing_ /= 2;
    column0_ = floor_div(pixels.x0, spacing_) - kNodesBefore;
    columns_ = floor_div(pixels.x0 + pixels.width - 1, spacing_) + kLagrangeNodes - kNodesBefore - column0_;
    weights_ = lagrange_phases(spacing_);

    std::vector<GridKicks> kicks;
    for (const DisplacementGrid& grid : grids) kicks.emplace_back(grid, depths_);
    Response response;
    for (int y = pixels.y0; y < pixels.y0 + pixels.height; ++y) {
        const bool touched = mirage.touches({pixels.x0, y, pixels.width, 1});
        rows_.push_back(touched ? static_cast<int>(launches_.size()) : -1);
        if (!touched) continue;
        for (int c = 0; c < columns_; ++c) {
            const int x = (column0_ + c) * spacing_;
            find_response(kicks, x, y, response);
            bends_.resize(bends_.size() + depths_.size(), {0, 0});
            launches_.push_back(
                bend_ray(start_changes(kicks, response, x, y), response, std::span(bends_).last(depths_.size())));
        }
    }
}

/// Leaves `out` as it is if it holds for this pixel, too.
void MirageAir::find_response(const std::vector<GridKicks>& grids, int x, int y, Response& out) const {
    const double w = mirage_->elevation(x, y);
    if (mirage_->perspective() && std::abs(w - out.w) <= kSameElevation * mirage_->quarter_pixel()) return;
    out.w = w;
    Mirage::PixelRay ray;
    out.bent = mirage_->ray(x, y, ray);
    out.end = out.bent ? ray.end : std::numeric_limits<double>::infinity();
    out.anchor = out.bent ? mirage_->anchor(ray) : 0;
    out.rise.clear();
    for (const GridKicks& grid : grids)
        for (const GridKicks::Slab& slab : grid.slabs)
            out.rise.push_back(out.bent ? mirage_->rise(ray, slab.middle) : 0);
    out.A.assign(depths_.size(), 1);
    out.B = depths_;
    if (out.bent) mirage_->response(x, y, ray, depths_, out.A, out.B);
}

MirageAir::StartChanges MirageAir::start_changes(const std::vector<GridKicks>& grids, const Response& response, int x,
                                                 int y) const {
    StartChanges sum;
    const auto [N, G] = mirage_->axes(x, y);
    const double det = N.x * G.y - N.y * G.x;
    if (!(std::abs(det) > kLeastAngle * glm::length(N) * glm::length(G))) return sum;
    const double x_most = cover_.x0 + cover_.width - 1, y_most = cover_.y0 + cover_.height - 1;
    const std::size_t K = depths_.size();
    std::size_t middle = 0;  // of slabs so far
    for (const GridKicks& grid : grids)
        for (std::size_t i = 0; i < grid.slabs.size(); ++i) {
            const GridKicks::Slab& slab = grid.slabs[i];
            const double rise = response.rise[middle++];
            if (slab.middle >= response.end || slab.after >= K) continue;
            const dvec2 d = (mirage_->perspective() ? rise / slab.middle : rise) * N;
            const auto [kick, moment] = grid.at(i, std::clamp<double>(x + d.x, cover_.x0, x_most),
                                                std::clamp<double>(y + d.y, cover_.y0, y_most));
            // In metres across the plane (a) and along it (b), and their moments.
            const double a = (kick.x * G.y - kick.y * G.x) / det, a_moment = (moment.x * G.y - moment.y * G.x) / det;
            const double b = (N.x * kick.y - N.y * kick.x) / det, b_moment = (N.x * moment.y - N.y * moment.x) / det;
            const auto response_to_kick = [&](const std::vector<double>& r, double at_camera) {
                const double to = value_at(r, slab.at_to), from = slab.from > 0 ? value_at(r, slab.at_from) : at_camera;
                return to * a - (to - from) / (slab.to - slab.from) * a_moment;
            };
            sum.lift[slab.after] -= response_to_kick(response.B, 0);
            sum.tilt[slab.after] += response_to_kick(response.A, 1);
            sum.slope[slab.after] += b;
            sum.offset[slab.after] -= slab.to * b - b_moment;
        }
    for (std::size_t k = 1; k < K; ++k) {
        sum.lift[k] += sum.lift[k - 1];
        sum.tilt[k] += sum.tilt[k - 1];
        sum.slope[k] += sum.slope[k - 1];
        sum.offset[k] += sum.offset[k - 1];
    }
    return sum;
}

Launch MirageAir::bend_ray(const StartChanges& changes, const Response& response,
                           std::span<std::array<float, 2>> bend) const {
    const Between anchor = between(depths_, response.anchor);
    const Launch launch =
        response.anchor > 0 ? Launch{value_at(changes.lift, anchor), value_at(changes.tilt, anchor)} : Launch{};
    for (std::size_t k = 0; k < depths_.size(); ++k)
        bend[k] = {static_cast<float>(response.A[k] * (changes.lift[k] - launch.lift) +
                                      response.B[k] * (changes.tilt[k] - launch.tilt)),
                   static_cast<float>(changes.offset[k] + depths_[k] * changes.slope[k])};
    return launch;
}

bool MirageAir::touches(int y) const {
    const int row = y - row0_;
    return row >= 0 && row < static_cast<int>(rows_.size()) && rows_[static_cast<std::size_t>(row)] >= 0;
}

void MirageAir::pixel(int x, int y, Pixel& out) const {
    const int base = floor_div(x, spacing_);
    const auto& w = weights_[static_cast<std::size_t>(x - base * spacing_)];
    const std::size_t first =
        static_cast<std::size_t>(rows_[static_cast<std::size_t>(y - row0_)] + base - kNodesBefore - column0_);
    const std::size_t K = depths_.size();
    out.launch = {};
    out.bend.assign(K, {0, 0});
    for (std::size_t i = 0; i < kLagrangeNodes; ++i) {
        if (w[i] == 0) continue;
        out.launch.lift += double{w[i]} * launches_[first + i].lift;
        out.launch.tilt += double{w[i]} * launches_[first + i].tilt;
        const auto* bend = bends_.data() + (first + i) * K;
        for (std::size_t k = 0; k < K; ++k)
            for (std::size_t c = 0; c < 2; ++c) out.bend[k][c] += w[i] * bend[k][c];
    }
}

std::array<double, 2> MirageAir::bend(const Pixel& pixel, double z) const {
    const Between b = between(depths_, z);
    const double near = z < depths_.front() ? z / depths_.front() : 1;  // bends grow as z² before the first depth
    std::array<double, 2> sum{};
    for (std::size_t c = 0; c < 2; ++c) {
        const double lower = pixel.bend[b.lower][c], upper = pixel.bend[b.upper][c];
        sum[c] = near * near * (lower + b.part * (upper - lower));
    }
    return sum;
}

}  // namespace eikonal
