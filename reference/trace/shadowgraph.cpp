#include "reference/trace/shadowgraph.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "noise/blobs/blobs.h"
#include "reference/trace/direction.h"

namespace eikonal::reference {
namespace {

/// Beyond the quad's outline, in parts of its diagonal, light may be bent onto it.
constexpr double kMargin = 0.05;

/// Greatest distance from a point to what the scene is about.
double reach_from(const Scene& scene, const dvec3& from) {
    double reach = glm::distance(from, scene.camera.position);
    for (const ObjectSpec& o : scene.objects) {
        if (o.shape == ObjectShape::Quad)
            reach = std::max(reach, glm::distance(from, o.origin) + o.size[0] + o.size[1]);
        if (o.shape == ObjectShape::Sphere) reach = std::max(reach, glm::distance(from, o.center) + o.radius);
    }
    for (const MediumSpec& medium : scene.media) {
        if (const auto* blobs = std::get_if<BlobsSpec>(&medium))
            for (const BlobHome& home : BlobCloud(*blobs, index_law(scene.optics), "medium").homes())
                reach = std::max(
                    reach, glm::distance(from, home.largest.center) + home.radius + kBlobReach * home.largest.sigma);
        if (const auto* lens = std::get_if<ProfileSpec>(&medium); lens && lens->profile == ProfileKind::Luneburg)
            reach = std::max(reach, glm::distance(from, lens->center) + lens->radius);
    }
    return reach;
}

/// Where a light ray of the grid met the quad: texture coordinates.
struct Landing {
    bool met = false;
    dvec2 uv{0, 0};
};

}  // namespace

Shadowgraph::Shadowgraph(const Scene& scene, const Geometry& geometry, const AirInstant& field,
                         const TraceSettings& camera_trace, int light_rays, Cancelled cancelled,
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
        // The grid lies in the quad's own plane, moved back along the light: every ray then stands for the same area.
        const double diagonal = std::sqrt(quad.size[0] * quad.size[0] + quad.size[1] * quad.size[1]);
        const double back = reach_from(scene, quad.origin);
        // A whole number of rays a texel, so that even light gives an even map; beyond the outline by whole rays.
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
                check_cancelled(cancelled);
                const BentHit end = reference::trace(field, &geometry, aim - back * light, light, trace, nullptr,
                                                     reference::watch(cancelled));
                if (end.hit && end.surface.object == static_cast<int>(index))
                    landings[j * columns + i] = {true, end.surface.uv};
            }
            if (watch.row_done) watch.row_done();
        });

        Map map{static_cast<int>(index), side, {}};
        const auto texels = static_cast<std::size_t>(side);
        map.values.assign(texels * texels, 0);
        // one after the other: sums in one order
        std::vector<double> flux(texels * texels, 0.0);
        constexpr double each = 1.0 / (kRaysPerTexel * kRaysPerTexel);
        for (const Landing& l : landings) {
            if (!l.met) continue;
            const double x = l.uv.x * side - 0.5, y = l.uv.y * side - 0.5;
            const double fx = std::floor(x), fy = std::floor(y);
            for (int k = 0; k < 4; ++k) {
                const int i = static_cast<int>(fx) + (k & 1), j = static_cast<int>(fy) + (k >> 1);
                const double weight = ((k & 1) ? x - fx : 1 - (x - fx)) * ((k >> 1) ? y - fy : 1 - (y - fy));
                // light at the very edge stays on its texel
                const auto column = static_cast<std::size_t>(std::clamp(i, 0, side - 1));
                const auto row = static_cast<std::size_t>(std::clamp(j, 0, side - 1));
                flux[row * texels + column] += weight * each;
            }
        }
        for (std::size_t k = 0; k < flux.size(); ++k) map.values[k] = static_cast<float>(flux[k]);
        maps_.push_back(std::move(map));
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
