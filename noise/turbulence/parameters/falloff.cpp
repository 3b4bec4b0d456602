#include "noise/turbulence/parameters/falloff.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "noise/math/portable_math.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {

IndexSample falloff_at(const Falloff& falloff, const dvec3& x) {
    const dvec3 d = x - falloff.origin;
    const double h = d.x * falloff.normal.x + d.y * falloff.normal.y + d.z * falloff.normal.z;
    if (!(h > 0)) return {1, {0, 0, 0}};
    const double g = portable::exp(-h / falloff.length);
    return {g, falloff.normal * (-g / falloff.length)};
}

IndexJet falloff_jet(const Falloff& falloff, const dvec3& x) {
    const IndexSample g = falloff_at(falloff, x);
    return {g.n, g.gradient, glm::outerProduct(g.gradient, falloff.normal * (-1 / falloff.length))};
}

IndexSample with_falloff(const std::optional<Falloff>& falloff, const dvec3& x, const IndexSample& field) {
    if (!falloff) return field;
    const IndexSample g = falloff_at(*falloff, x);
    return {field.n * g.n, field.gradient * g.n + g.gradient * field.n};
}

IndexJet with_falloff(const std::optional<Falloff>& falloff, const dvec3& x, const IndexJet& field) {
    if (!falloff) return field;
    const IndexJet g = falloff_jet(*falloff, x);
    return {field.n * g.n, field.gradient * g.n + g.gradient * field.n,
            field.hessian * g.n + glm::outerProduct(field.gradient, g.gradient) +
                glm::outerProduct(g.gradient, field.gradient) + g.hessian * field.n};
}

}  // namespace eikonal
