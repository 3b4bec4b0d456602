#include "noise/surface.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "noise/portable_math.h"

namespace eikonal {
namespace {

/// 1 - e^{-x} for x >= 0, to a few 1e-16 relative.
double one_minus_exp(double x) {
    if (x > 0.5) return 1 - portable::exp(-x);
    // x (1 - x/2 (1 - x/3 (…))): the first term left out is below 1e-17 of the sum
    double sum = 1;
    for (int k = 16; k >= 2; --k) sum = 1 - x / k * sum;
    return x * sum;
}

/// asin s for 0 <= s <= 1/√2, by Newton's method on the sine.
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

SurfaceLayer::SurfaceLayer(const SurfaceSpec& spec, const IndexLaw& law)
    : origin_(spec.origin),
      normal_(spec.normal),
      dropoff_(spec.dropoff),
      surface_(spec.surface_temperature),
      ambient_(law.ambient_temperature),
      excess_(surface_ - ambient_),
      scale_(law.refractivity * law.T0) {
    // |n - n_a| ∝ e/(T_a + excess e) falls to kNegligibleIndex of itself at e = kNegligibleIndex T_a/(T_S - …).
    const double part = (surface_ - kNegligibleIndex * excess_) / (kNegligibleIndex * ambient_);
    top_ = dropoff_ * std::max(0.0, portable::log(part));
    knee_ = dropoff_ * std::max(0.0, portable::log(surface_ / ambient_));
    // |D|/T² has its only maximum at T = 2 T_a (D = T_a), if the surface is hotter, else at the surface.
    largest_slope_ = surface_ > 2 * ambient_ ? scale_ / (4 * ambient_ * dropoff_) : std::abs(slope(0));
}

SurfaceLayer::State SurfaceLayer::state(double h) const {
    const double x = h / dropoff_;
    const double e = portable::exp(-x);
    return {surface_ * e + ambient_ * one_minus_exp(x), excess_ * e};
}

double SurfaceLayer::height(const dvec3& x) const {
    return glm::dot(x - origin_, normal_);
}

double SurfaceLayer::climb(const dvec3& direction) const {
    return glm::dot(direction, normal_);
}

double SurfaceLayer::above_ambient(double h) const {
    const State s = state(std::max(h, 0.0));
    return -scale_ * (s.D / s.T / ambient_);
}

double SurfaceLayer::slope(double h) const {
    if (!(h >= 0)) return 0;
    const State s = state(h);
    return scale_ * (s.D / s.T / s.T / dropoff_);
}

double SurfaceLayer::curvature(double h) const {
    if (!(h >= 0)) return 0;
    const State s = state(h);
    return scale_ * (s.D / s.T / s.T / dropoff_) * ((s.D - ambient_) / s.T / dropoff_);
}

IndexSample SurfaceLayer::sample(const dvec3& x) const {
    const double h = height(x);
    return {above_ambient(h), slope(h) * normal_};
}

IndexJet SurfaceLayer::jet(const dvec3& x) const {
    const double h = height(x);
    return {above_ambient(h), slope(h) * normal_, curvature(h) * glm::outerProduct(normal_, normal_)};
}

double SurfaceLayer::critical_slope(double camera_height, double exaggeration, RayEquation equation) const {
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
