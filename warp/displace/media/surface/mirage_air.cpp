#include "warp/displace/media/surface/mirage_air.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "noise/math/portable_math.h"
#include "warp/displace/grid/displacement_grid.h"

namespace eikonal {
namespace {

/// |sine| of the angle between two axes in the picture, from which a bend cannot be told apart along them.
constexpr double kLeastAngle = 1e-6;
/// Nodes may be so far apart that the plane climbs by this many pixels between them.
constexpr double kMostClimb = 0.25;
/// Sines that differ by this part of a quarter of a pixel have one response.
constexpr double kSameElevation = 0.1;

/// Where z lies between two of the depths: both indices, and the part of the upper.
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

/// Of the nearest of many phases.
const std::array<float, kNodeTaps>& weights_at(double f) {
    constexpr int kPhases = 256;
    static const std::vector<std::array<float, kNodeTaps>> table = [] {
        std::vector<std::array<float, kNodeTaps>> weights;
        for (int i = 0; i <= kPhases; ++i) weights.push_back(lagrange_weights(static_cast<double>(i) / kPhases));
        return weights;
    }();
    return table[static_cast<std::size_t>(f * kPhases + 0.5)];
}

template <class Values>
double mix(const Values& values, const Between& b) {
    return values[b.lower] + b.part * (values[b.upper] - values[b.lower]);
}

}  // namespace

/// One grid, to be read at any place.
struct MirageAir::Sheet {
    const DisplacementGrid* grid;
    struct Slab {
        double from, to, middle;
        Between at_from, at_to;
        std::size_t after;  ///< first response depth that its kicks count for
    };
    std::vector<Slab> slabs;  ///< from the camera to the first layer, and from layer to layer

    Sheet(const DisplacementGrid& b, const std::vector<double>& depths) : grid(&b) {
        double from = 0;
        for (const double to : b.depths) {
            const double middle = 0.5 * (from + to);
            const auto after =
                static_cast<std::size_t>(std::lower_bound(depths.begin(), depths.end(), middle) - depths.begin());
            slabs.push_back({from, to, middle, between(depths, from), between(depths, to), after});
            from = to;
        }
    }

    /// Kick of a slab [px], and its moment about the slab's end [px·m], at any place of the picture.
    struct Kick {
        dvec2 kick, moment;
    };
    Kick kick(std::size_t slab, double x, double y) const {
        const double gx = x / grid->spacing, gy = y / grid->spacing;
        const int cx = static_cast<int>(std::floor(gx)), cy = static_cast<int>(std::floor(gy));
        const auto &wx = weights_at(gx - cx), &wy = weights_at(gy - cy);
        std::array<std::size_t, kNodeTaps> column{};
        for (int i = 0; i < kNodeTaps; ++i)
            column[static_cast<std::size_t>(i)] =
                static_cast<std::size_t>(std::clamp(cx + i - kTapsBefore - grid->column0, 0, grid->columns - 1));
        Node before2{}, before{}, here{};
        for (int j = 0; j < kNodeTaps; ++j) {
            const int row = std::clamp(cy + j - kTapsBefore - grid->row0, 0, grid->rows - 1);
            const float weight = wy[static_cast<std::size_t>(j)];
            const auto line = [&](std::size_t layer) {
                const Node* nodes = grid->nodes.data() + grid->index(row, layer);
                Node sum{};
                for (std::size_t i = 0; i < kNodeTaps; ++i) sum += nodes[column[i]] * wx[i];
                return sum * weight;
            };
            here += line(slab);
            if (slab > 0) before += line(slab - 1);
            if (slab > 1 && grid->interpolation == DepthInterpolation::Linear) before2 += line(slab - 2);
        }
        const Slab& s = slabs[slab];
        const double length = s.to - s.from;
        const dvec2 X0(before[0], before[1]), S0(before[2], before[3]), X1(here[0], here[1]), S1(here[2], here[3]);
        if (grid->interpolation == DepthInterpolation::Hermite) return {S1 - S0, X1 - X0 - length * S0};
        // X bends at the layers only
        dvec2 slope(0, 0);
        if (slab > 0) slope = (X0 - dvec2(before2[0], before2[1])) / (slabs[slab - 1].to - slabs[slab - 1].from);
        const dvec2 kick = (X1 - X0) / length - slope;
        return {kick, length * kick};
    }
};

/// Of a ray that leaves with elevation w.
struct MirageAir::Response {
    double w = std::numeric_limits<double>::quiet_NaN();
    bool bent = false;
    double end = 0, anchor = 0;
    std::vector<double> A, B;
    std::vector<double> rise;  ///< in the middle of every slab of every sheet [m]
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
    column0_ = floor_div(pixels.x0, spacing_) - kTapsBefore;
    columns_ = floor_div(pixels.x0 + pixels.width - 1, spacing_) + kNodeTaps - kTapsBefore - column0_;
    for (int p = 0; p < spacing_; ++p) weights_.push_back(lagrange_weights(static_cast<double>(p) / spacing_));

    std::vector<Sheet> sheets;
    for (const DisplacementGrid& grid : grids) sheets.emplace_back(grid, depths_);
    Response response;
    for (int y = pixels.y0; y < pixels.y0 + pixels.height; ++y) {
        const bool touched = mirage.touches({pixels.x0, y, pixels.width, 1});
        rows_.push_back(touched ? static_cast<int>(launches_.size()) : -1);
        if (!touched) continue;
        for (int c = 0; c < columns_; ++c) {
            const int x = (column0_ + c) * spacing_;
            respond(sheets, x, y, response);
            bends_.resize(bends_.size() + depths_.size(), {0, 0});
            launches_.push_back(trace(sheets, response, x, y, std::span(bends_).last(depths_.size())));
        }
    }
}

void MirageAir::respond(const std::vector<Sheet>& sheets, int x, int y, Response& out) const {
    const double w = mirage_->elevation(x, y);
    if (mirage_->perspective() && std::abs(w - out.w) <= kSameElevation * mirage_->quarter_pixel()) return;
    out.w = w;
    Mirage::PixelRay ray;
    out.bent = mirage_->ray(x, y, ray);
    out.rise.clear();
    out.end = out.bent ? ray.end : std::numeric_limits<double>::infinity();
    out.anchor = out.bent ? mirage_->anchor(ray) : 0;
    for (const Sheet& sheet : sheets)
        for (const Sheet::Slab& slab : sheet.slabs) out.rise.push_back(out.bent ? mirage_->rise(ray, slab.middle) : 0);
    out.A.assign(depths_.size(), 1);
    out.B = depths_;
    if (out.bent) {
        mirage_->response(x, y, ray, depths_, out.A, out.B);
    }
}

Launch MirageAir::trace(const std::vector<Sheet>& sheets, const Response& response, int x, int y,
                        std::span<std::array<float, 2>> bend) const {
    const auto [N, G] = mirage_->axes(x, y);
    const double det = N.x * G.y - N.y * G.x;
    if (!(std::abs(det) > kLeastAngle * glm::length(N) * glm::length(G))) return {};
    const double x_most = cover_.x0 + cover_.width - 1, y_most = cover_.y0 + cover_.height - 1;

    const std::size_t K = depths_.size();
    std::array<double, kMostResponses> lift{}, tilt{}, slope{}, offset{};  // what each depth adds to the one before
    std::size_t middle = 0;
    for (const Sheet& sheet : sheets)
        for (std::size_t i = 0; i < sheet.slabs.size(); ++i) {
            const Sheet::Slab& slab = sheet.slabs[i];
            const double rise = response.rise[middle++];
            if (slab.middle >= response.end || slab.after >= K) continue;
            const dvec2 d = (mirage_->perspective() ? rise / slab.middle : rise) * N;
            const auto [kick, moment] = sheet.kick(i, std::clamp<double>(x + d.x, cover_.x0, x_most),
                                                   std::clamp<double>(y + d.y, cover_.y0, y_most));
            // in metres across the plane (a) and along it (b)
            const double a = (kick.x * G.y - kick.y * G.x) / det, ma = (moment.x * G.y - moment.y * G.x) / det;
            const double b = (N.x * kick.y - N.y * kick.x) / det, mb = (N.x * moment.y - N.y * moment.x) / det;
            const auto pulled = [&](const std::vector<double>& r, double at_camera) {
                const double to = mix(r, slab.at_to), from = slab.from > 0 ? mix(r, slab.at_from) : at_camera;
                return to * a - (to - from) / (slab.to - slab.from) * ma;
            };
            lift[slab.after] -= pulled(response.B, 0);
            tilt[slab.after] += pulled(response.A, 1);
            slope[slab.after] += b;
            offset[slab.after] -= slab.to * b - mb;
        }
    for (std::size_t k = 1; k < K; ++k) {
        lift[k] += lift[k - 1];
        tilt[k] += tilt[k - 1];
        slope[k] += slope[k - 1];
        offset[k] += offset[k - 1];
    }
    const Between anchor = between(depths_, response.anchor);
    const Launch launch = response.anchor > 0 ? Launch{mix(lift, anchor), mix(tilt, anchor)} : Launch{};
    for (std::size_t k = 0; k < K; ++k)
        bend[k] = {
            static_cast<float>(response.A[k] * (lift[k] - launch.lift) + response.B[k] * (tilt[k] - launch.tilt)),
            static_cast<float>(offset[k] + depths_[k] * slope[k])};
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
        static_cast<std::size_t>(rows_[static_cast<std::size_t>(y - row0_)] + base - kTapsBefore - column0_);
    const std::size_t K = depths_.size();
    out.launch = {};
    out.bend.assign(K, {0, 0});
    for (std::size_t i = 0; i < kNodeTaps; ++i) {
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
    const double near = z < depths_.front() ? z / depths_.front() : 1;  // as z², as grids do
    std::array<double, 2> sum{};
    for (std::size_t c = 0; c < 2; ++c) {
        const double lower = pixel.bend[b.lower][c], upper = pixel.bend[b.upper][c];
        sum[c] = near * near * (lower + b.part * (upper - lower));
    }
    return sum;
}

}  // namespace eikonal
