#include "warp/displace/second_order.h"

#include <algorithm>
#include <cmath>

#include "warp/displace/model.h"

namespace eikonal {
namespace {

/// A ray's bend, by axial depth z of the straight ray.
struct Bend {
    double z = 0;
    dvec3 x1{0, 0, 0}, slope{0, 0, 0};
};

class NodeRay {
  public:
    NodeRay(const FieldInstant& field, const StraightRay& ray) : field_(field), ray_(ray) {}

    /// Follows the ray to depth z.
    void advance(double target) {
        while (bend_.z < target && !ended_) {
            const dvec3 x = ray_.at(bend_.z) + bend_.x1, p = ray_.direction + bend_.slope;
            const double length = glm::length(p);
            const dvec3 direction = p / length;
            const double left = target - bend_.z;
            if (const double clear = field_.clear_way(x, direction) / length; clear > 0) {
                drift(std::min(clear, left));
                if (clear < left) continue;
                return;
            }
            const double edge = field_.way_to_edge(x, direction) / length;
            const double safe = field_.longest_step(x, direction) / length;
            if (++steps_ > kMostSteps) ended_ = true;
            step(std::min({left, edge > 1e-9 * (1 + bend_.z) ? edge : left, std::max(safe, left / kMostSteps)}));
            if (!(glm::length(bend_.slope) < kSteepestBend * ray_.length)) ended_ = true;
        }
        if (bend_.z < target) drift(target - bend_.z);
    }

    /// X and S of the bent ray where it is at the axial depth that it has been followed to: exact projection.
    Node node(const Camera& camera) const {
        const dvec3 p = ray_.direction + bend_.slope;
        const double rate = glm::dot(p, camera.forward);
        if (!(rate > 0)) return Node{};
        const dvec3 at = bend_.x1 - (glm::dot(bend_.x1, camera.forward) / rate) * p;
        const dvec3 turn = p / rate - ray_.direction;
        const double fx = camera.f_px, fy = -camera.f_px * camera.pixel_aspect;
        return Node{
            static_cast<float>(fx * glm::dot(at, camera.right)), static_cast<float>(fy * glm::dot(at, camera.up)),
            static_cast<float>(fx * glm::dot(turn, camera.right)), static_cast<float>(fy * glm::dot(turn, camera.up))};
    }

  private:
    void drift(double h) {
        bend_.x1 += h * bend_.slope;
        bend_.z += h;
    }

    dvec3 acceleration(double z, const dvec3& x1, const dvec3& slope) {
        const dvec3 x = ray_.at(z) + x1, p = ray_.direction + slope;
        const double speed = field_.speed(x);
        if (!(speed > 0)) {
            ended_ = true;
            return {0, 0, 0};
        }
        return (ray_.length * ray_.length / (speed * speed)) * field_.force(x, p);
    }

    /// Nyström's method: the force at the start, twice the middle in one, the end.
    void step(double h) {
        const dvec3 f1 = acceleration(bend_.z, bend_.x1, bend_.slope);
        const dvec3 f2 = acceleration(bend_.z + 0.5 * h, bend_.x1 + (0.5 * h) * bend_.slope + (h * h / 8) * f1,
                                      bend_.slope + (0.5 * h) * f1);
        const dvec3 f3 = acceleration(bend_.z + h, bend_.x1 + h * bend_.slope + (h * h / 2) * f2, bend_.slope + h * f2);
        bend_.x1 += h * bend_.slope + (h * h / 6) * (f1 + 2.0 * f2);
        bend_.slope += (h / 6) * (f1 + 4.0 * f2 + f3);
        bend_.z += h;
    }

    const FieldInstant& field_;
    StraightRay ray_;
    Bend bend_;
    int steps_ = 0;
    bool ended_ = false;
};

}  // namespace

void SecondOrderInstant::fill(Band& band, const Camera& camera) const {
    for (int r = 0; r < band.rows; ++r)
        for (int c = 0; c < band.columns; ++c) {
            check_cancelled(cancelled);
            NodeRay ray(field, straight_ray(camera, (band.column0 + c) * band.spacing + 0.5,
                                            (band.row0 + r) * band.spacing + 0.5));
            for (std::size_t k = 0; k < band.depths.size(); ++k) {
                ray.advance(band.depths[k]);
                band.row(r, k)[c] += ray.node(camera);
            }
        }
}

}  // namespace eikonal
