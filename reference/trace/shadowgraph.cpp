#include "reference/trace/shadowgraph.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "reference/trace/direction.h"

namespace eikonal::reference {
namespace {

/// Light within this part of the diagonal beyond the quad's outline may be bent onto the quad.
constexpr double kMargin = 0.05;

/// The greatest distance from a point to anything in the scene.
double reach_from(const Scene& scene, const SceneAir& air, const dvec3& from) {
    double reach = glm::distance(from, scene.camera.position);
    for (const ObjectSpec& o : scene.objects) {
        if (o.shape == ObjectShape::Quad)
            reach = std::max(reach, glm::distance(from, o.origin) + o.size[0] + o.size[1]);
        if (o.shape == ObjectShape::Sphere) reach = std::max(reach, glm::distance(from, o.center) + o.radius);
    }
    return std::max(reach, air.farthest_part(from));
}

/// Where a light ray of the grid met the quad, in texture coordinates.
struct Landing {
    bool met = false;
    dvec2 uv{0, 0};
};

/// The irradiance of side × side texels, row by row of v: every landing spreads its light over the nearest four.
std::vector<float> irradiance_map(const std::vector<Landing>& landings, int side) {
    const auto texels = static_cast<std::size_t>(side);
    std::vector<double> flux(texels * texels, 0.0);
    constexpr double each = 1.0 / (kRaysPerTexel * kRaysPerTexel);
    // One landing after the other, so that sums always run in the same order.
    for (const Landing& l : landings) {
        if (!l.met) continue;
        const double x = l.uv.x * side - 0.5, y = l.uv.y * side - 0.5;
        const double fx = std::floor(x), fy = std::floor(y);
        for (int k = 0; k < 4; ++k) {
            const int i = static_cast<int>(fx) + (k & 1), j = static_cast<int>(fy) + (k >> 1);
            const double weight = ((k & 1) ? x - fx : 1 - (x - fx)) * ((k >> 1) ? y - fy : 1 - (y - fy));
            // The outermost texels take the light that would go beyond the edge.
            const auto column = static_cast<std::size_t>(std::clamp(i, 0, side - 1));
            const auto row = static_cast<std::size_t>(std::clamp(j, 0, side - 1));
            flux[row * texels + column] += weight * each;
        }
    }
    return {flux.begin(), flux.end()};
}

}  // namespace

Shadowgraph::Shadowgraph(const Scene& scene, const Geometry& geometry, const SceneAir& air, const AirInstant& field,
                         const TraceSettings& camera_trace, int light_rays, const std::stop_token& stop,
                         const LightWatch& watch) {
    const dvec3 light = glm::normalize(scene.light.value().direction);
    const int side = std::max(2, light_rays / kRaysPerTexel);
    for (std::size_t index = 0; index < scene.objects.size(); ++index) {
        const ObjectSpec& quad = scene.objects[index];
        if (quad.shape != ObjectShape::Quad || quad.emissive) continue;
        dvec3 right, up;
        const dvec3 normal = glm::normalize(quad.normal);
        perpendicular_axes(normal, quad.up, right, up);
        const double facing = std::abs(glm::dot(normal, light));
        if (facing < 1e-6) continue;
        // The grid lies in the quad's own plane, moved back along the light. Every ray then stands for the same area.
        const double diagonal = std::sqrt(quad.size[0] * quad.size[0] + quad.size[1] * quad.size[1]);
        const double back = reach_from(scene, air, quad.origin);
        // Each texel has a whole number of rays, so that even light gives an even map. The margin has whole rays, too.
        const int across = side * kRaysPerTexel;
        const std::array<double, 2> spacing{quad.size[0] / across, quad.size[1] / across};
        const auto beyond = [&](double gap) {
            return std::min(kMostLightRays, static_cast<int>(std::ceil(kMargin * diagonal / gap)));
        };
        const std::array<int, 2> margin{beyond(spacing[0]), beyond(spacing[1])};
        TraceSettings trace = camera_trace;
        trace.perspective = false;
        trace.pixel = diagonal / side;
        trace.far = 2 * back + diagonal;

        const auto columns = static_cast<std::size_t>(across + 2 * margin[0]);
        const auto rows = static_cast<std::size_t>(across + 2 * margin[1]);
        std::vector<Landing> landings(columns * rows);
        if (watch.begins) watch.begins(static_cast<int>(index), static_cast<int>(rows));
        tbb::parallel_for(std::size_t{0}, rows, [&](std::size_t j) {
            const double b = (static_cast<double>(j) + 0.5 - 0.5 * static_cast<double>(rows)) * spacing[1];
            for (std::size_t i = 0; i < columns; ++i) {
                const double a = (static_cast<double>(i) + 0.5 - 0.5 * static_cast<double>(columns)) * spacing[0];
                const dvec3 aim = quad.origin + a * right + b * up;
                check_stop(stop);
                const BentHit end = reference::trace(field, &geometry, aim - back * light, light, trace, nullptr,
                                                     reference::watch(stop));
                if (end.hit && end.surface.object == static_cast<int>(index))
                    landings[j * columns + i] = {true, end.surface.uv};
            }
            if (watch.row_done) watch.row_done();
        });

        maps_.push_back({static_cast<int>(index), side, irradiance_map(landings, side)});
    }
}

double Shadowgraph::Map::at(double u, double v) const {
    const double x = std::clamp(u * side - 0.5, 0.0, side - 1.0), y = std::clamp(v * side - 0.5, 0.0, side - 1.0);
    const int i = std::min(static_cast<int>(x), side - 2), j = std::min(static_cast<int>(y), side - 2);
    const double fx = x - i, fy = y - j;
    const auto value = [&](int column, int row) {
        return double{
            values[static_cast<std::size_t>(row) * static_cast<std::size_t>(side) + static_cast<std::size_t>(column)]};
    };
    return (1 - fy) * ((1 - fx) * value(i, j) + fx * value(i + 1, j)) +
           fy * ((1 - fx) * value(i, j + 1) + fx * value(i + 1, j + 1));
}

std::optional<double> Shadowgraph::irradiance(const Hit& hit) const {
    for (const Map& map : maps_)
        if (map.object == hit.object) return map.at(hit.uv.x, hit.uv.y);
    return std::nullopt;
}

}  // namespace eikonal::reference
