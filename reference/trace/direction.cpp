#include "reference/trace/direction.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "noise/math/portable_math.h"

namespace eikonal::reference {

double angle_turns(double y, double x) {
    const double ax = std::abs(x), ay = std::abs(y);
    const double large = ax > ay ? ax : ay;
    if (!(large > 0)) return 0;
    const double t = (ax > ay ? ay : ax) / large;
    // The start is within 5e-3 rad of atan t. The rest of the angle is atan((t c - s) / (c + t s)), a short series.
    const double guess = t * (portable::kPi / 4 + 0.273 * (1 - t));
    double s, c;
    portable::sincos(guess, s, c);
    const double r = (t * c - s) / (c + t * s);
    const double r2 = r * r;
    const double rest = r * (1 - r2 * (1.0 / 3 - r2 * (1.0 / 5)));
    double turns = (guess + rest) / portable::kTwoPi;
    if (ay > ax) turns = 0.25 - turns;
    if (x < 0) turns = 0.5 - turns;
    return y < 0 ? -turns : turns;
}

void perpendicular_axes(glm::dvec3 normal, const std::optional<glm::dvec3>& hint, glm::dvec3& right, glm::dvec3& up) {
    const glm::dvec3 fallback = std::abs(normal.y) < 0.999 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1);
    up = hint ? *hint - glm::dot(*hint, normal) * normal : glm::dvec3(0);
    if (glm::length(up) < 1e-9) up = fallback - glm::dot(fallback, normal) * normal;
    up = glm::normalize(up);
    right = glm::cross(up, normal);
}

glm::dvec2 latitude_longitude(glm::dvec3 d) {
    return {0.5 + angle_turns(d.x, -d.z), 0.5 + 2 * angle_turns(d.y, std::sqrt(d.x * d.x + d.z * d.z))};
}

}  // namespace eikonal::reference
