#include "warp/displace/models/second_order.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "noise/base/error.h"
#include "warp/displace/grid/aperture.h"
#include "warp/displace/grid/model.h"

namespace eikonal {
namespace {

/// A step ends this far before an edge of a medium, or begins this far behind it, as a part of the path. The distance
/// is larger than rounding errors.
constexpr double kHair = 1e-9;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class BentRay {
  public:
    BentRay(const BentRays& model, const StraightRay& ray)
        : field_(model.field), longest_(model.step), ray_(ray), launch_(model.field.speed(ray.origin)) {
        if (!(launch_ > 0)) lose_index(0);
    }

    /// Follows the ray to axial depth `target`, and calls `visit` at the end of every step.
    template <class Visit>
    void advance(double target, Visit&& visit) {
        while (z_ < target && !(lost_at_ < kInfinity)) {
            const dvec3 x = ray_.at(z_) + x1_, p = ray_.direction + slope_;
            const double length = glm::length(p);
            const dvec3 direction = p / length;
            const double left = target - z_;
            // A nonzero force at the end of the last step means that the ray is inside a medium.
            const bool within = force_known_ && force_ != dvec3(0);
            if (const double clear = within ? 0 : field_.clear_way(x, direction) / length; clear > 0) {
                if (clear >= left) break;
                drift(clear);
                z_ += clear;
            } else {
                const double edge = field_.way_to_edge(x, direction) / length;
                const double safe = longest_step(x, direction) / length;
                const double hair = kHair * target;
                const bool over = edge <= 2 * hair;
                const double h = over ? std::min(left, edge + hair) : std::min({left, safe, edge - hair});
                if (over)
                    drift(h);
                else
                    step(h);
                z_ = h == left ? target : z_ + h;
                if (++steps_ == kMostRaySteps || !(glm::length(slope_) < kSteepestBend * ray_.length))
                    lost_at_ = std::min(lost_at_, z_);
            }
            visit();
        }
        if (z_ < target) {
            drift(target - z_);
            z_ = target;
            visit();
        }
    }

    double depth() const { return z_; }
    double lost_at() const { return lost_at_; }
    bool without_index() const { return without_index_; }
    /// X and S of the bent ray at the axial depth that it has been followed to, by exact projection.
    std::array<double, 4> shift(const Camera& camera) const {
        const dvec3 p = ray_.direction + slope_;
        const double rate = glm::dot(p, camera.forward);
        if (!(rate > 0)) return {0, 0, 0, 0};
        const dvec3 at = x1_ - (glm::dot(x1_, camera.forward) / rate) * p;
        const dvec3 turn = p / rate - ray_.direction;
        const double fx = camera.f_px, fy = -camera.f_px * camera.pixel_aspect;
        return {fx * glm::dot(at, camera.right), fy * glm::dot(at, camera.up), fx * glm::dot(turn, camera.right),
                fy * glm::dot(turn, camera.up)};
    }

  private:
    /// At most `longest_` times the step that the field calls safe. Where that is more than one safe step, the field is
    /// asked again at the end of the first, so that no small feature is stepped over.
    double longest_step(const dvec3& x, const dvec3& direction) const {
        const double first = field_.longest_step(x, direction);
        if (longest_ <= 1 || !std::isfinite(first)) return longest_ * first;
        return first + (longest_ - 1) * field_.longest_step(x + first * direction, direction);
    }

    void lose_index(double z) {
        without_index_ = true;
        lost_at_ = std::min(lost_at_, z);
    }

    void drift(double h) {
        x1_ += h * slope_;
        force_known_ = false;
    }

    dvec3 acceleration(double z, const dvec3& x1, const dvec3& slope) {
        const dvec3 x = ray_.at(z) + x1, p = ray_.direction + slope;
        const auto [force, speed] = field_.motion(x, p);
        if (!(speed > 0)) {
            lose_index(z);
            return {0, 0, 0};
        }
        return (ray_.length * ray_.length / (launch_ * launch_)) * force;
    }

    /// One step of Nyström's method. It takes the force at the start, twice in the middle and at the end; the two in
    /// the middle are combined in one evaluation. The force at the end serves as the start of the next step. The two
    /// differ by a part of the second order that falls with h³.
    void step(double h) {
        const dvec3 f1 = force_known_ ? force_ : acceleration(z_, x1_, slope_);
        const dvec3 f2 =
            acceleration(z_ + 0.5 * h, x1_ + (0.5 * h) * slope_ + (h * h / 8) * f1, slope_ + (0.5 * h) * f1);
        const dvec3 f3 = acceleration(z_ + h, x1_ + h * slope_ + (h * h / 2) * f2, slope_ + h * f2);
        x1_ += h * slope_ + (h * h / 6) * (f1 + 2.0 * f2);
        slope_ += (h / 6) * (f1 + 4.0 * f2 + f3);
        force_ = f3;
        force_known_ = true;
    }

    const AirInstant& field_;
    double longest_;
    StraightRay ray_;
    double launch_;  ///< |dx/du| at the camera: metres of ray per unit of u where the ray is straight
    double z_ = 0;
    dvec3 x1_{0, 0, 0}, slope_{0, 0, 0};
    dvec3 force_{0, 0, 0};  ///< force at the end of the last step
    bool force_known_ = false;
    int steps_ = 0;
    double lost_at_ = kInfinity;  ///< axial depth from which on the ray is not followed [m]
    bool without_index_ = false;  ///< whether the ray is lost because n <= 0
};

Node as_node(const std::array<double, 4>& s) {
    return Node{static_cast<float>(s[0]), static_cast<float>(s[1]), static_cast<float>(s[2]), static_cast<float>(s[3])};
}

/// X and S at the depths, averaged over the aperture.
std::vector<Node> bundle(const BentRays& model, const std::vector<dvec2>& disc, const Camera& camera,
                         const StraightRay& ray, const std::vector<double>& depths, bool* without_index = nullptr) {
    std::vector<std::array<double, 4>> sum(depths.size());
    for (const dvec2& q : disc) {
        StraightRay part = ray;
        const dvec3 aside = 0.5 * model.aperture * (q.x * camera.right + q.y * camera.up);
        part.origin += aside;
        if (camera.projection == Projection::Perspective) {
            part.direction -= aside / model.focus;
            part.length = glm::length(part.direction);
        }
        BentRay bent(model, part);
        for (std::size_t k = 0; k < depths.size(); ++k) {
            bent.advance(depths[k], [] {});
            const std::array<double, 4> shift = bent.shift(camera);
            for (std::size_t c = 0; c < 4; ++c) sum[k][c] += shift[c] / static_cast<double>(disc.size());
        }
        if (without_index != nullptr && bent.without_index()) *without_index = true;
    }
    std::vector<Node> nodes;
    for (const auto& s : sum) nodes.push_back(as_node(s));
    return nodes;
}

}  // namespace

DisplacementGrid BentRays::grid(const Camera& camera) const {
    DisplacementGrid grid;
    grid.perspective = camera.projection == Projection::Perspective;
    grid.interpolation = DepthInterpolation::Hermite;
    grid.spacing = spacing;
    grid.depths = depths;
    return grid;
}

void BentRays::fill(DisplacementGrid& grid, const Camera& camera) const {
    const std::vector<dvec2> disc = aperture_points(aperture, cell);
    for (int r = 0; r < grid.rows; ++r)
        for (int c = 0; c < grid.columns; ++c) {
            check_stop(stop);
            const StraightRay ray =
                straight_ray(camera, (grid.column0 + c) * grid.spacing + 0.5, (grid.row0 + r) * grid.spacing + 0.5);
            bool without_index = false;
            const std::vector<Node> nodes = bundle(*this, disc, camera, ray, grid.depths, &without_index);
            if (without_index)
                throw FrameError(
                    "second-order: rays come to where the index of refraction is not positive; lower "
                    "optics.exaggeration or `gain`");
            for (std::size_t k = 0; k < nodes.size(); ++k) grid.row(r, k)[c] += nodes[k];
        }
}

BentPixel bent_pixel(const BentRays& model, const Camera& camera, int x, int y, double farthest) {
    check_stop(model.stop);
    DisplacementGrid grid = model.grid(camera);
    grid.spacing = 1;
    grid.depths.clear();
    const StraightRay ray = straight_ray(camera, x + 0.5, y + 0.5);
    std::vector<Node> nodes;
    BentRay central(model, ray);
    central.advance(farthest, [&] {
        if (!grid.depths.empty() && !(central.depth() > grid.depths.back())) return;
        grid.depths.push_back(central.depth());
        nodes.push_back(as_node(central.shift(camera)));
    });
    if (model.aperture > 0)
        nodes = bundle(model, aperture_points(model.aperture, model.cell), camera, ray, grid.depths);
    grid.cover({x, y, 1, 1});
    grid.nodes = std::move(nodes);
    return {std::move(grid), central.lost_at()};
}

}  // namespace eikonal
