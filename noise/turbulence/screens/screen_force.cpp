#include "noise/turbulence/screens/screen_force.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "noise/math/ray_bounds.h"
#include "noise/turbulence/parameters/falloff.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {
namespace {

using glm::dmat3;
using glm::dvec2;

/// The largest bend that steps allow for, in standard deviations, and the part of a cell that the meeting point may
/// move within a step.
constexpr double kLargestBend = 6, kPartOfCell = 0.5;
/// Of the whole way: what a straight walk over the ends of slabs may lose to rounding.
constexpr double kWalked = 1e-12;

}  // namespace

/// The point where a ray's tangent meets the screen of its slab, and the derivatives of gψ there along the frame's
/// axes.
struct ScreenForce::Meeting {
    dvec2 slope;    ///< s = p⊥/p_z
    double length;  ///< L
    double ahead;   ///< w - z
    double factor;  ///< strength/(√L δ)
    dvec2 gradient;
    double xx, xy, yy;  ///< Hessian
};

ScreenForce::ScreenForce(const ScreenField& field, std::vector<ScreenInstant> screens, const ShotFrame& frame,
                         const std::optional<Falloff>& falloff, double strength)
    : frame_(frame), falloff_(falloff), strength_(strength), screens_(std::move(screens)) {
    ends_.push_back(screens_.front().w() - 0.5 * screens_.front().thickness());
    for (std::size_t m = 0; m < screens_.size(); ++m) {
        const double thickness = screens_[m].thickness();
        ends_.push_back(screens_[m].w() + 0.5 * thickness);
        // A bend grows to `largest` over the slab. It moves the meeting point by at most half a slab times `largest`.
        const double largest = kLargestBend * std::abs(strength) * std::sqrt(field.gradient_variance(m));
        steps_.push_back(largest > 0 ? std::min(thickness, kPartOfCell * screens_[m].cell() / (0.5 * largest))
                                     : thickness);
    }
}

double ScreenForce::depth(const dvec3& x) const {
    return glm::dot(x - frame_.origin, frame_.forward);
}

double ScreenForce::rate(const dvec3& d) const {
    return glm::dot(d, frame_.forward);
}

std::optional<ScreenForce::Meeting> ScreenForce::meet(const dvec3& x, const dvec3& p) const {
    const double z = depth(x), pz = rate(p), length = glm::length(p);
    if (!(std::abs(pz) * kSteepestRay >= length) || pz == 0) return {};
    const auto end =
        pz > 0 ? std::upper_bound(ends_.begin(), ends_.end(), z) : std::lower_bound(ends_.begin(), ends_.end(), z);
    if (end == ends_.begin() || end == ends_.end()) return {};
    const ScreenInstant& screen = screens_[static_cast<std::size_t>(end - ends_.begin()) - 1];
    Meeting m;
    m.slope = dvec2(glm::dot(p, frame_.right), glm::dot(p, frame_.up)) / pz;
    m.length = length / std::abs(pz);
    m.ahead = screen.w() - z;
    m.factor = strength_ / (std::sqrt(m.length) * screen.thickness());
    const dvec3 from = x - frame_.origin;
    const dvec2 q = dvec2(glm::dot(from, frame_.right), glm::dot(from, frame_.up)) + m.ahead * m.slope;
    const PeriodicSpline2::Jet psi = screen.jet(q.x, q.y);
    m.gradient = {psi.dx, psi.dy};
    m.xx = psi.dxx, m.xy = psi.dxy, m.yy = psi.dyy;
    if (!falloff_) return m;
    const dvec3 &e1 = frame_.right, &e2 = frame_.up;
    const IndexJet g = falloff_jet(*falloff_, frame_.origin + q.x * e1 + q.y * e2 + screen.w() * frame_.forward);
    const dvec2 fall(glm::dot(g.gradient, e1), glm::dot(g.gradient, e2));
    m.gradient = g.n * m.gradient + psi.value * fall;
    m.xx = g.n * psi.dxx + 2 * fall.x * psi.dx + psi.value * glm::dot(e1, g.hessian * e1);
    m.xy = g.n * psi.dxy + fall.x * psi.dy + fall.y * psi.dx + psi.value * glm::dot(e1, g.hessian * e2);
    m.yy = g.n * psi.dyy + 2 * fall.y * psi.dy + psi.value * glm::dot(e2, g.hessian * e2);
    return m;
}

dvec3 ScreenForce::force(const dvec3& x, const dvec3& p) const {
    const std::optional<Meeting> m = meet(x, p);
    if (!m) return dvec3(0);
    const dvec2 bend = slanted_bend(m->slope, m->length, m->gradient);
    return m->factor * (bend.x * frame_.right + bend.y * frame_.up);
}

ForceJet ScreenForce::force_jet(const dvec3& x, const dvec3& p) const {
    const std::optional<Meeting> m = meet(x, p);
    if (!m) return {};
    const dvec3 &e1 = frame_.right, &e2 = frame_.up, &e3 = frame_.forward;
    const dvec2 &s = m->slope, &g = m->gradient;
    const double L = m->length, along = glm::dot(s, g), pz = rate(p);
    const auto in_world = [&](const dvec2& v) { return v.x * e1 + v.y * e2; };
    const dvec3 h = in_world(slanted_bend(s, L, g));
    // The columns of the Hessian, and its product with the slope.
    const dvec3 h1 = in_world(slanted_bend(s, L, {m->xx, m->xy})), h2 = in_world(slanted_bend(s, L, {m->xy, m->yy}));
    const dvec3 hs = s.x * h1 + s.y * h2;
    const dmat3 by_meeting = glm::outerProduct(h1, e1) + glm::outerProduct(h2, e2) - glm::outerProduct(hs, e3);
    // ∂(s (s·g)/(L + 1))/∂s_i, with ∂s_i/∂p = (e_i - s_i e3)/p_z.
    const auto by_slope = [&](int i) {
        dvec2 d = s * (g[i] - along * s[i] / (L * (L + 1)));
        d[i] += along;
        return in_world(d / (L + 1));
    };
    const dmat3 by_slant =
        glm::outerProduct(by_slope(0), (e1 - s.x * e3) / pz) + glm::outerProduct(by_slope(1), (e2 - s.y * e3) / pz);
    // ∂q/∂p is ahead/p_z times ∂q/∂x, and ∂ ln(1/√L)/∂p = -(p/|p|² - forward/p_z)/2.
    const dvec3 slant = -0.5 * (p / glm::dot(p, p) - e3 / pz);
    return {m->factor * h, m->factor * by_meeting,
            m->factor * ((m->ahead / pz) * by_meeting + glm::outerProduct(h, slant) + by_slant)};
}

double ScreenForce::longest_step(const dvec3& x, const dvec3&) const {
    const double z = depth(x);
    if (z < ends_.front()) return ends_.front() - z + steps_.front();
    if (z >= ends_.back()) return z - ends_.back() + steps_.back();
    const auto end = std::upper_bound(ends_.begin(), ends_.end(), z);
    return steps_[static_cast<std::size_t>(end - ends_.begin()) - 1];
}

double ScreenForce::clear_way(const dvec3& x, const dvec3& d) const {
    return way_into_layer(depth(x), rate(d), ends_.front(), ends_.back());
}

double ScreenForce::way_to_edge(const dvec3& x, const dvec3& d) const {
    const double z = depth(x), along = rate(d);
    if (along == 0) return kNever;
    const auto end =
        along > 0 ? std::upper_bound(ends_.begin(), ends_.end(), z) : std::lower_bound(ends_.begin(), ends_.end(), z);
    if (along > 0) return end == ends_.end() ? kNever : (*end - z) / along;
    return end == ends_.begin() ? kNever : (z - *(end - 1)) / -along;
}

bool ScreenForce::add_bend(const dvec3& x, const dvec3& d, double distance, double, StraightBend& sum) const {
    for (double w = 0; w < distance;) {
        const double way = std::min(way_to_edge(x + w * d, d), distance - w);
        sum.value += way * (distance - w - 0.5 * way) * force(x + (w + 0.5 * way) * d, d);
        w += way + kWalked * distance;
    }
    return true;
}

}  // namespace eikonal
