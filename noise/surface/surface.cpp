#include "noise/surface/surface.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "noise/math/portable_math.h"
#include "noise/medium/optics.h"
#include "noise/surface/surface_spec.h"

namespace eikonal {
namespace {

/// 1 - e^{-x} for x >= 0, with a relative error of a few 1e-16.
double one_minus_exp(double x) {
    if (x > 0.5) return 1 - portable::exp(-x);
    // x (1 - x/2 (1 - x/3 (…))). The first term left out is below 1e-17 of the sum.
    double sum = 1;
    for (int k = 16; k >= 2; --k) sum = 1 - x / k * sum;
    return x * sum;
}

/// T_a + D gives T without loss of digits unless T_a is many times T_S. Within this ratio the relative error is 1e-14.
constexpr double kPlainRatio = 16;

/// asin s for 0 <= s <= 1/√2, by Newton's method applied to the sine.
double arcsine(double s) {
    double x = s * (1 + s * s * (1.0 / 6));
    for (int i = 0; i < 5; ++i) {
        double sine, cosine;
        portable::sincos(x, sine, cosine);
        x -= (sine - s) / cosine;
    }
    return x;
}

}  // namespace

SurfaceIndex::SurfaceIndex(const SurfaceSpec& spec, const IndexLaw& law)
    : origin_(spec.origin),
      normal_(spec.normal),
      dropoff_(spec.dropoff),
      inverse_dropoff_(1 / spec.dropoff),
      surface_(spec.surface_temperature),
      ambient_(law.ambient_temperature),
      excess_(surface_ - ambient_),
      inverse_ambient_(1 / ambient_),
      scale_(law.refractivity * law.T0),
      plain_(ambient_ <= kPlainRatio * surface_) {
    // |n - n_a| ∝ e/(T_a + excess e) has fallen to the part kNegligibleIndex at e = kNegligibleIndex T_a/(T_S - …).
    const double part = (surface_ - kNegligibleIndex * excess_) / (kNegligibleIndex * ambient_);
    top_ = dropoff_ * std::max(0.0, portable::log(part));
    knee_ = dropoff_ * std::max(0.0, portable::log(surface_ / ambient_));
    // |D|/T² is largest at T = 2 T_a (D = T_a) if the surface is hotter than that, else at the surface.
    largest_slope_ = surface_ > 2 * ambient_ ? scale_ / (4 * ambient_ * dropoff_) : std::abs(slope(0));
}

[[gnu::always_inline]] inline SurfaceIndex::State SurfaceIndex::state(double h) const {
    const double x = h * inverse_dropoff_;
    const double e = portable::exp(-x), D = excess_ * e;
    const double T = plain_ ? ambient_ + D : surface_ * e + ambient_ * one_minus_exp(x);
    return {T, D, 1 / T};
}

double SurfaceIndex::above_ambient(const State& s) const {
    return -scale_ * (s.D * s.inverse_T * inverse_ambient_);
}

double SurfaceIndex::slope(const State& s) const {
    return scale_ * (s.D * s.inverse_T * s.inverse_T * inverse_dropoff_);
}

double SurfaceIndex::curvature(const State& s) const {
    return slope(s) * ((s.D - ambient_) * s.inverse_T * inverse_dropoff_);
}

double SurfaceIndex::height(const dvec3& x) const {
    return glm::dot(x - origin_, normal_);
}

double SurfaceIndex::climb(const dvec3& direction) const {
    return glm::dot(direction, normal_);
}

double SurfaceIndex::above_ambient(double h) const {
    return above_ambient(state(std::max(h, 0.0)));
}

double SurfaceIndex::slope(double h) const {
    return h >= 0 ? slope(state(h)) : 0;
}

double SurfaceIndex::curvature(double h) const {
    return h >= 0 ? curvature(state(h)) : 0;
}

IndexSample SurfaceIndex::sample(const dvec3& x) const {
    const double h = height(x);
    const State s = state(std::max(h, 0.0));
    return {above_ambient(s), (h >= 0 ? slope(s) : 0) * normal_};
}

IndexJet SurfaceIndex::jet(const dvec3& x) const {
    const double h = height(x);
    const State s = state(std::max(h, 0.0));
    if (!(h >= 0)) return {above_ambient(s)};
    return {above_ambient(s), slope(s) * normal_, curvature(s) * glm::outerProduct(normal_, normal_)};
}

double SurfaceIndex::critical_slope(double camera_height, double exaggeration, RayEquation equation) const {
    const double H = std::max(camera_height, 0.0);
    // n(H) - n(0) = A (1/T - 1/T_S) = A (T_S - T)/(T T_S), and T_S - T = excess (1 - e).
    const double T = state(H).T;
    const double rise = exaggeration * (scale_ * (excess_ * one_minus_exp(H / dropoff_) / T / surface_));
    const double n = 1 + scale_ / ambient_ + exaggeration * above_ambient(H);
    if (!(rise > 0)) return 0;
    double part = rise < n ? rise / n : 1.0;  // 1 - n(0)/n(H)
    if (equation == RayEquation::Paper) part /= 1 + std::sqrt(1 - part);
    return 2 * arcsine(std::sqrt(0.5 * part));
}

}  // namespace eikonal
