#include "warp/displace/media/any_medium/any_medium_bend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "warp/displace/grid/aperture.h"
#include "warp/displace/media/sampled_variance.h"
#include "warp/displace/models/first_order.h"
#include "warp/displace/models/second_order.h"

namespace eikonal {
namespace {

/// Safe steps are asked for on kProbeRays × kProbeRays rays across the picture, at kProbePoints points of each.
constexpr int kProbeRays = 5, kProbePoints = 64;
/// The smallest feature is assumed to be this many times as wide as the safe step is long.
constexpr double kStepsPerFeature = 2;
/// A step ends this far before an edge of the force, or begins this far behind it, as a part of the path. The distance
/// is larger than rounding errors.
constexpr double kHair = 1e-9;

/// The smallest feature that the rays of a view may cross, and the depths between which they cross the medium [m].
struct Features {
    double smallest = std::numeric_limits<double>::infinity();
    double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
};

Features probe(const MediumInstant& air, const FrameView& frame, const PixelWindow& picture) {
    Features features;
    for (int j = 0; j < kProbeRays; ++j)
        for (int i = 0; i < kProbeRays; ++i) {
            const StraightRay ray = straight_ray(frame.camera, picture.width * (i + 0.5) / kProbeRays,
                                                 picture.height * (j + 0.5) / kProbeRays);
            const dvec3 d = ray.direction / ray.length;
            for (int k = 0; k < kProbePoints; ++k) {
                const double z = frame.farthest * (k + 0.5) / kProbePoints;
                const dvec3 x = ray.at(z);
                const double clear = air.clear_way(x, d) / ray.length;
                const double met = z + clear;
                if (!(met < frame.farthest)) continue;
                features.smallest =
                    std::min(features.smallest, kStepsPerFeature * air.longest_step(ray.at(met + kHair * met), d));
                features.nearest = std::min(features.nearest, met);
                features.farthest = std::max(features.farthest, met);
            }
        }
    return features;
}

/// ∫∫F along one straight ray, up to an axial depth that grows.
class RayIntegral {
  public:
    RayIntegral(const MediumInstant& air, double strength, const StraightRay& ray)
        : air_(air), strength_(strength), ray_(ray), direction_(ray.direction / ray.length) {}

    void advance(double target) {
        for (int step = 0; z_ < target && step < kMostFirstOrderSteps; ++step) {
            const dvec3 x = ray_.at(z_);
            const double left = target - z_, hair = kHair * target;
            if (const double clear = air_.clear_way(x, direction_) / ray_.length; clear > 0) {
                drift(std::min(left, clear + hair));
                continue;
            }
            const double edge = air_.way_to_edge(x, direction_) / ray_.length;
            if (edge <= 2 * hair)
                drift(std::min(left, edge + hair));
            else
                integrate(std::min({left, air_.longest_step(x, direction_) / ray_.length, edge - hair}));
        }
        if (z_ < target) drift(target - z_);  // the largest number of steps is reached: the rest is straight
    }
    /// L² ∫∫F, and its derivative by depth.
    dvec3 bend() const { return ray_.length * ray_.length * bend_; }
    dvec3 slope() const { return ray_.length * ray_.length * slope_; }

  private:
    dvec3 force(double z) const {
        const dvec3 x = ray_.at(z);
        return air_.has_index() ? strength_ * air_.sample(x).gradient : air_.force(x, direction_);
    }
    void drift(double h) {
        bend_ += h * slope_;
        z_ += h;
    }
    void integrate(double h) {
        constexpr double kGauss = 0.21132486540518711775;  // (1 - 1/√3)/2
        const dvec3 f1 = force(z_ + kGauss * h), f2 = force(z_ + (1 - kGauss) * h);
        bend_ += h * slope_ + (0.5 * h * h) * ((1 - kGauss) * f1 + kGauss * f2);
        slope_ += (0.5 * h) * (f1 + f2);
        z_ += h;
    }

    const MediumInstant& air_;
    double strength_;
    StraightRay ray_;
    dvec3 direction_;
    double z_ = 0;
    dvec3 bend_{0, 0, 0}, slope_{0, 0, 0};
};

class Instant final : public LaidOutInstant {
  public:
    Instant(const ShotContext& shot, std::shared_ptr<const Medium> any, const FrameView& frame)
        : LaidOutInstant(frame.camera, frame.gain),
          any_(std::move(any)),
          air_(any_->at(frame.t, {.law = shot.law})),
          strength_(shot.strength),
          aperture_(shot.scene.optics.aperture),
          focus_(shot.settings.far),
          t_(frame.t),
          stop_(shot.settings.stop) {
        const Features features = probe(*air_, frame, shot.picture());
        const bool is_met = std::isfinite(features.smallest);
        cell_ = dvec3(is_met ? features.smallest : frame.farthest);
        FirstOrderRays rays{strength_, cell_, aperture_, focus_};
        DisplacementGrid grid = rays.grid(frame.camera, frame.nearest, frame.farthest);
        // X changes its course at the depths where the medium begins and ends.
        for (const double z : {features.nearest, features.farthest})
            if (is_met && z > frame.nearest && z < frame.farthest) grid.depths.push_back(z);
        std::sort(grid.depths.begin(), grid.depths.end());
        grid.depths.erase(std::unique(grid.depths.begin(), grid.depths.end()), grid.depths.end());
        lay_out({std::move(grid)});
    }
    std::shared_ptr<const MediumInstant> air(const InstantSettings& settings) const override {
        return any_->at(t_, settings);
    }
    std::optional<dvec3> averaged_cells() const override { return cell_; }
    double bent_step() const override { return 1; }

  private:
    void fill(DisplacementGrid& grid) const override {
        const std::vector<dvec2> disc = aperture_points(aperture_, cell_.x);
        for (int r = 0; r < grid.rows; ++r)
            for (int c = 0; c < grid.columns; ++c) {
                check_stop(stop_);
                for (const dvec2& q : disc) add_ray(grid, r, c, q, 1 / static_cast<double>(disc.size()));
            }
    }
    void add_ray(DisplacementGrid& grid, int row, int column, const dvec2& lens, double weight) const {
        const Camera& view = camera();
        const StraightRay ray =
            straight_ray(view, (grid.column0 + column) * grid.spacing + 0.5, (grid.row0 + row) * grid.spacing + 0.5);
        StraightRay part = ray;
        const dvec3 aside = 0.5 * aperture_ * (lens.x * view.right + lens.y * view.up);
        part.origin += aside;
        if (grid.perspective) part.direction -= aside / focus_;
        part.length = glm::length(part.direction);
        RayIntegral integral(*air_, strength_, part);
        for (std::size_t k = 0; k < grid.depths.size(); ++k) {
            integral.advance(grid.depths[k]);
            const dvec2 x = weight * image_shift(view, ray, integral.bend());
            const dvec2 s = weight * image_shift(view, ray, integral.slope());
            grid.row(row, k)[column] += Node{static_cast<float>(x.x), static_cast<float>(x.y), static_cast<float>(s.x),
                                             static_cast<float>(s.y)};
        }
    }

    std::shared_ptr<const Medium> any_;
    std::shared_ptr<const MediumInstant> air_;
    double strength_, aperture_, focus_, t_;
    dvec3 cell_{1, 1, 1};
    std::stop_token stop_;
};

}  // namespace

AnyMediumBend::AnyMediumBend(const ShotContext& shot, std::size_t medium, std::shared_ptr<const Medium> any)
    : MediumBend(shot, medium, shot.own_model(Model::FirstOrder)), any_(std::move(any)) {
    told_.note =
        fmt::format("{}: model {}: {}", name(),
                    shot.second_order() ? "second-order (through all media together)" : "first-order", any_->note());
}

std::unique_ptr<const BendInstant> AnyMediumBend::at(const FrameView& frame) const {
    return std::make_unique<const Instant>(shot_, any_, frame);
}

double AnyMediumBend::expected_variance(double D, bool) const {
    return sampled_variance(shot_, *this, D, kProbePoints).shift;
}

double AnyMediumBend::focusing_variance(double D) const {
    return sampled_variance(shot_, *this, D, kProbePoints).slope;
}

}  // namespace eikonal
