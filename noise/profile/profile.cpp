#include "noise/profile/profile.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "noise/math/portable_math.h"
#include "noise/math/ray_bounds.h"
#include "noise/profile/profile_spec.h"

namespace eikonal {
namespace {

using glm::dmat3;

const dmat3 kIdentity(1.0);

/// n with its first two derivatives in a scalar coordinate.
struct Derivatives {
    double n, first, second;
};

/// n and its derivatives from those of n²: n' = (n²)'/(2n), n'' = ((n²)''/2 - n'²)/n.
Derivatives of_square(double square, double first, double second) {
    if (!(square > 0)) return {0, 0, 0};
    const double n = std::sqrt(square), slope = first / (2 * n);
    return {n, slope, (0.5 * second - slope * slope) / n};
}

/// The jet of an index that varies along the unit vector `axis` only.
IndexJet layered(const Derivatives& f, const dvec3& axis) {
    return {f.n - 1, f.first * axis, f.second * glm::outerProduct(axis, axis)};
}

/// The jet of an index that varies with the distance from a point or line, in the coordinate q = |v|²: ∇n = 2 n' v,
/// Hessian = 2 n' P + 4 n'' v vᵀ. P is the projection that gave v from x - center.
IndexJet round(const Derivatives& f, const dvec3& v, const dmat3& P) {
    return {f.n - 1, 2 * f.first * v, 2 * f.first * P + (4 * f.second) * glm::outerProduct(v, v)};
}

dvec3 across(const dvec3& v, const dvec3& axis) {
    return v - glm::dot(v, axis) * axis;
}

/// n0 sech(g √q) in q = ρ²: with y = gρ, n' = -g² n tanh y/(2y), n'' = g⁴ n (…)/(4y²).
Derivatives sech(double n0, double g, double q) {
    const double y = std::abs(g) * std::sqrt(q), e = portable::exp(-y), e2 = e * e;
    const double n = 2 * n0 * e / (1 + e2), g2 = g * g;
    if (!(n > 0)) return {0, 0, 0};
    if (y < 0.1) {
        // tanh y/y and its derivative by y², as series in z = y²
        const double z = y * y;
        const double ratio =
            1 - z * (1.0 / 3 - z * (2.0 / 15 - z * (17.0 / 315 - z * (62.0 / 2835 - z * (1382.0 / 155925 -
                                                                                         z * (21844.0 / 6081075))))));
        const double change =
            -1.0 / 3 +
            z * (4.0 / 15 - z * (51.0 / 315 - z * (248.0 / 2835 - z * (6910.0 / 155925 - z * (131064.0 / 6081075)))));
        return {n, -0.5 * g2 * n * ratio, n * (0.25 * g2 * g2) * (ratio * ratio) - 0.5 * g2 * g2 * n * change};
    }
    const double tanh = (1 - e2) / (1 + e2), ratio = tanh / y;
    // d(tanh y/y)/d(y²) = (sech² y - tanh y/y)/(2y²)
    const double sech2 = 4 * e2 / ((1 + e2) * (1 + e2)), change = (sech2 - ratio) / (2 * y * y);
    return {n, -0.5 * g2 * n * ratio, n * (0.25 * g2 * g2) * (ratio * ratio) - 0.5 * g2 * g2 * n * change};
}

bool finite(const IndexJet& jet) {
    bool ok = std::isfinite(jet.n);
    for (int i = 0; i < 3; ++i) {
        ok = ok && std::isfinite(jet.gradient[i]);
        for (int j = 0; j < 3; ++j) ok = ok && std::isfinite(jet.hessian[i][j]);
    }
    return ok;
}

}  // namespace

IndexJet Profile::jet(const dvec3& x) const {
    const dvec3 v = x - spec_.center;
    const double s = glm::dot(v, spec_.axis), inverse2 = 1 / (spec_.radius * spec_.radius), g2 = spec_.g * spec_.g;
    const double n0 = spec_.n0, slope = spec_.slope;
    IndexJet result;
    switch (spec_.profile) {
        case ProfileKind::Luneburg: {
            const double q = glm::dot(v, v) * inverse2;
            result = q < 1 ? round(of_square(2 - q, -inverse2, 0), v, kIdentity) : IndexJet{};
            break;
        }
        case ProfileKind::FishEye: {
            const double h = 1 / (1 + glm::dot(v, v) * inverse2), n = n0 * h;
            result = round({n, -n * h * inverse2, 2 * n * h * h * inverse2 * inverse2}, v, kIdentity);
            break;
        }
        case ProfileKind::Linear:
            result = layered({n0 + slope * s, slope, 0}, spec_.axis);
            break;
        case ProfileKind::LinearSquared:
            result = layered(of_square(n0 * n0 + slope * s, slope, 0), spec_.axis);
            break;
        case ProfileKind::Exponential: {
            const double n = n0 * portable::exp(slope * s);
            result = layered({n, n * slope, n * slope * slope}, spec_.axis);
            break;
        }
        case ProfileKind::Rod:
        case ProfileKind::Sech: {
            const dvec3 b = across(v, spec_.axis);
            const double q = glm::dot(b, b);
            const Derivatives f = spec_.profile == ProfileKind::Sech
                                      ? sech(n0, spec_.g, q)
                                      : of_square(n0 * n0 * (1 - g2 * q), -n0 * n0 * g2, 0);
            result = round(f, b, kIdentity - glm::outerProduct(spec_.axis, spec_.axis));
            break;
        }
    }
    if (!(result.n > -1)) return {-1, dvec3(0), dmat3(0)};
    if (!(result.n < kLargestIndex)) return {kLargestIndex, dvec3(0), dmat3(0)};
    return finite(result) ? result : IndexJet{result.n, dvec3(0), dmat3(0)};
}

double Profile::scale(const dvec3& x) const {
    const double r = glm::length(x - spec_.center), n0 = spec_.n0, slope = std::abs(spec_.slope);
    switch (spec_.profile) {
        case ProfileKind::Luneburg:
            return spec_.radius + std::max(0.0, r - spec_.radius);
        case ProfileKind::FishEye:
            return spec_.radius + r;
        case ProfileKind::Linear:
            return n0 / slope;
        case ProfileKind::LinearSquared:
            return n0 * n0 / slope;
        case ProfileKind::Exponential:
            return 1 / slope;
        case ProfileKind::Rod:
        case ProfileKind::Sech:
            break;
    }
    return 1 / std::abs(spec_.g);
}

double Profile::clear_way(const dvec3& x, const dvec3& d) const {
    if (spec_.profile != ProfileKind::Luneburg) return 0;
    return Chord(x - spec_.center, d, spec_.radius).into();
}

double Profile::way_to_edge(const dvec3& x, const dvec3& d) const {
    const dvec3 v = x - spec_.center;
    const double s = glm::dot(v, spec_.axis), rate = glm::dot(d, spec_.axis), n0 = spec_.n0, slope = spec_.slope;
    switch (spec_.profile) {
        case ProfileKind::Luneburg:
            return Chord(v, d, spec_.radius).next();
        case ProfileKind::Linear:
            return way_to_plane(n0 + slope * s, slope * rate);
        case ProfileKind::LinearSquared:
            return way_to_plane(n0 * n0 + slope * s, slope * rate);
        case ProfileKind::Rod:
            return Chord(across(v, spec_.axis), across(d, spec_.axis), 1 / std::abs(spec_.g)).next();
        case ProfileKind::FishEye:
        case ProfileKind::Exponential:
        case ProfileKind::Sech:
            break;
    }
    return kNever;
}

}  // namespace eikonal
