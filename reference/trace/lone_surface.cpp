#include "reference/trace/lone_surface.h"

#include <algorithm>
#include <cmath>

#include "noise/math/portable_math.h"
#include "noise/math/ray_bounds.h"
#include "noise/medium/optics.h"
#include "noise/surface/surface_spec.h"

namespace eikonal::reference {
namespace {

/// The least change of height for the closed form [dropoffs]. Its cancellation grows with the inverse square of it.
constexpr double kLeastChange = 0.02;
/// A ray that ends on the surface may be below it by rounding, by at most this [dropoffs].
constexpr double kBelow = 1e-6;
/// Lower heights than this count as on the surface [dropoffs].
constexpr double kOnSurface = 1e-12;

}  // namespace

LoneSurface::LoneSurface(const SurfaceSpec& spec, const OpticsSpec& optics)
    : layer_(spec, index_law(optics)),
      law_(index_law(optics)),
      equation_(optics.ray_equation),
      exaggeration_(optics.exaggeration),
      has_index_(1 + law_.ambient() + std::min(0.0, exaggeration_ * layer_.above_ambient(0)) > 0.25),
      surface_(at(0.0)) {
    const double n = 1 + law_.ambient() + std::abs(exaggeration_ * layer_.above_ambient(0));
    largest_force_ = std::abs(force_strength(optics)) * layer_.largest_slope() * n;
}

/// Height above which |F| is below `force` [1/m], at most the top of the layer. Above the knee |n'| falls at least as
/// e^{-h/d0}. The logarithm is rounded up to that of the next power of two.
double LoneSurface::quiet_height(double force) const {
    constexpr double kLn2 = 0.6931471805599453;
    const double ratio = largest_force_ / force;
    if (!(ratio > 1)) return 0;
    if (!std::isfinite(ratio)) return layer_.top();
    return std::min(layer_.top(), layer_.knee() + layer_.dropoff() * kLn2 * (std::ilogb(ratio) + 1));
}

/// A force F all along the way L displaces by an angle of at most F L/2. All the air above a ray that climbs by c a
/// metre turns it by at most F d0/c.
double LoneSurface::clear_way(const dvec3& x, const dvec3& d, double turn, double longest) const {
    const double climb = layer_.climb(d);
    const double top = quiet_height(turn * std::max(2 / longest, std::abs(climb) / layer_.dropoff()));
    const double above = layer_.height(x) - top;
    return above > kTouch * top ? way_to_plane(above, climb) : 0;
}

bool LoneSurface::is_quiet(double height, const dvec3& d, double distance, double force) const {
    const double lowest = std::min(height, height + layer_.climb(d) * distance);
    return lowest > kBelow * layer_.dropoff() && lowest > quiet_height(force);
}

/// A height below the surface gives the values of the surface.
LoneSurface::AtHeight LoneSurface::at(double h) const {
    const double A = exaggeration_ * law_.refractivity * law_.T0, Ta = law_.ambient_temperature;
    const double excess = layer_.above_ambient(h), q = exaggeration_ * excess;
    // T_a/T = 1 + T_a q/A
    const double logarithm = -portable::log(1 + Ta * excess / (law_.refractivity * law_.T0));
    const double scale = A * layer_.dropoff() / Ta, Q = scale * logarithm;
    if (equation_ == RayEquation::Paper) return {h, 0.5 * q, 0.5 * Q};
    const double n = 1 + law_.ambient();
    return {h, n * q + 0.5 * q * q, n * Q - 0.5 * scale * (A * logarithm / Ta + q)};
}

std::optional<dvec3> LoneSurface::pull(const AtHeight& from, const dvec3& d, double distance) const {
    const double c = layer_.climb(d), h0 = from.height, h1 = h0 + c * distance;
    const double below = -kBelow * layer_.dropoff();
    if (!(has_index_ && h0 >= 0 && h1 >= below && std::abs(h1 - h0) >= kLeastChange * layer_.dropoff())) return {};
    const AtHeight to = h1 <= kOnSurface * layer_.dropoff() ? surface_ : at(h1);
    return ((to.P - from.P) / c - distance * from.g) / c * layer_.normal();
}

}  // namespace eikonal::reference
