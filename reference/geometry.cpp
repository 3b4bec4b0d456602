#include "reference/geometry.h"

#include <fmt/format.h>

#if EIKONAL_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>

#include "noise/error.h"
#include "reference/direction.h"

namespace eikonal::reference {
namespace {

void check(RTCDevice device) {
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw std::runtime_error("Embree could not build the scene");
}

RTCRay embree_ray(dvec3 origin, dvec3 direction, double t_min, double t_max) {
    RTCRay ray{};
    ray.org_x = static_cast<float>(origin.x);
    ray.org_y = static_cast<float>(origin.y);
    ray.org_z = static_cast<float>(origin.z);
    ray.dir_x = static_cast<float>(direction.x);
    ray.dir_y = static_cast<float>(direction.y);
    ray.dir_z = static_cast<float>(direction.z);
    ray.tnear = static_cast<float>(t_min);
    ray.tfar = static_cast<float>(t_max);
    ray.mask = ~0u;
    return ray;
}

bool finite(dvec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Both normals to the side the segment comes from.
void face(dvec3 direction, Hit& hit) {
    if (glm::dot(hit.normal, direction) > 0) hit.normal = -hit.normal;
    if (glm::dot(hit.shading_normal, hit.normal) < 0) hit.shading_normal = -hit.shading_normal;
}

}  // namespace

Geometry::Geometry(const Scene& scene, dvec3 anchor)
    : anchor_(anchor), device_(rtcNewDevice(nullptr), rtcReleaseDevice), scene_(nullptr, rtcReleaseScene) {
    if (scene.objects.empty())
        throw UserError(fmt::format("{}: the scene has no [[object]]: nothing to render", scene.file.string()));
    if (!device_) throw std::runtime_error("Embree does not start on this machine");
    scene_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const ObjectSpec& object = scene.objects[i];
        const int index = static_cast<int>(i);
        switch (object.shape) {
            case ObjectShape::Plane: {
                const dvec3 normal = glm::normalize(object.normal);
                Plane plane{object.origin, normal, {}, {}, object.size, index, add_material(object)};
                perpendicular_axes(normal, object.up, plane.right, plane.up);
                planes_.push_back(plane);
                break;
            }
            case ObjectShape::Sphere:
                spheres_.push_back({object.center, object.radius, index, add_material(object)});
                break;
            case ObjectShape::Quad:
            case ObjectShape::Mesh:
                add_mesh(object, index);
                break;
        }
    }
    for (const MeshEntry& entry : meshes_) attach_mesh(entry);
    attach_spheres();
    rtcCommitScene(scene_.get());
    check(device_.get());
}

Geometry::~Geometry() = default;

int Geometry::add_material(const ObjectSpec& object) {
    materials_.push_back({object.texture ? dvec3(1) : object.color, dvec3(0), object.texture, object.emissive,
                          object.mirror, object.refractive_index});
    return static_cast<int>(materials_.size()) - 1;
}

void Geometry::add_mesh(const ObjectSpec& object, int index) {
    MeshEntry entry{{}, index, add_material(object), static_cast<int>(materials_.size())};
    if (object.shape == ObjectShape::Quad) {
        dvec3 right, up;
        perpendicular_axes(glm::normalize(object.normal), object.up, right, up);
        right *= object.size[0];
        up *= object.size[1];
        entry.mesh = make_quad(object.origin - 0.5 * (right + up), right, up);
    } else {
        entry.mesh = read_mesh(object.file.value(), object.scale, object.center);
    }
    for (const MeshMaterial& m : entry.mesh.materials)
        materials_.push_back(
            {m.diffuse, m.emission, m.texture, object.emissive, object.mirror, object.refractive_index});
    meshes_.push_back(std::move(entry));
}

void Geometry::attach_mesh(const MeshEntry& entry) {
    const Mesh& mesh = entry.mesh;
    const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.positions.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), mesh.triangles.size()));
    check(device_.get());
    for (const dvec3& position : mesh.positions)
        for (int k = 0; k < 3; ++k) *vertices++ = static_cast<float>(position[k] - anchor_[k]);
    for (const Mesh::Triangle& triangle : mesh.triangles)
        for (const std::uint32_t vertex : triangle.vertex) *indices++ = vertex;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
}

void Geometry::attach_spheres() {
    if (spheres_.empty()) return;
    const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_SPHERE_POINT);
    auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                                               4 * sizeof(float), spheres_.size()));
    check(device_.get());
    for (const Sphere& sphere : spheres_) {
        for (int k = 0; k < 3; ++k) *points++ = static_cast<float>(sphere.center[k] - anchor_[k]);
        *points++ = static_cast<float>(sphere.radius);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
}

std::optional<Hit> Geometry::intersect(dvec3 origin, dvec3 direction, double t_min, double t_max) const {
    if (!finite(origin) || !finite(direction)) return {};
    Hit best;
    bool found = false;
    RTCRayHit record{};
    record.ray = embree_ray(origin - anchor_, direction, t_min, t_max);
    record.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    record.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if EIKONAL_EMBREE_MAJOR >= 4
    rtcIntersect1(scene_.get(), &record);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_.get(), &context, &record);
#endif
    if (record.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
        found = true;
        best.t = static_cast<double>(record.ray.tfar);
        if (record.hit.geomID < meshes_.size())
            mesh_hit(meshes_[record.hit.geomID], record.hit.primID, origin, direction, best);
        else
            sphere_hit(spheres_[record.hit.primID], origin, direction, best);
    }
    const Plane* nearest = nullptr;
    for (const Plane& plane : planes_) {
        if (const auto t = plane_distance(plane, origin, direction, t_min, found ? best.t : t_max)) {
            best.t = *t;
            nearest = &plane;
            found = true;
        }
    }
    if (!found) return {};
    best.point = origin + best.t * direction;
    if (nearest) plane_hit(*nearest, best);
    face(direction, best);
    return best;
}

bool Geometry::occluded(dvec3 origin, dvec3 direction, double t_min, double t_max) const {
    if (!finite(origin) || !finite(direction)) return false;
    for (const Plane& plane : planes_)
        if (plane_distance(plane, origin, direction, t_min, t_max)) return true;
    RTCRay ray = embree_ray(origin - anchor_, direction, t_min, t_max);
#if EIKONAL_EMBREE_MAJOR >= 4
    rtcOccluded1(scene_.get(), &ray);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_.get(), &context, &ray);
#endif
    return ray.tfar < 0;
}

dvec3 Geometry::leave(const Hit& hit) const {
    const dvec3 p = glm::abs(hit.point - anchor_);
    // A few units in the last place of a float at the largest coordinate, and 10 µm at the anchor itself.
    return hit.point + (1e-5 + 8 * 6e-8 * std::max(p.x, std::max(p.y, p.z))) * hit.normal;
}

std::optional<int> Geometry::sphere_around(dvec3 point) const {
    for (const Sphere& sphere : spheres_)
        if (glm::distance(point, sphere.center) < sphere.radius) return sphere.object;
    return {};
}

std::optional<double> Geometry::plane_distance(const Plane& plane, dvec3 origin, dvec3 direction, double t_min,
                                               double t_max) const {
    const double t = glm::dot(plane.origin - origin, plane.normal) / glm::dot(direction, plane.normal);
    if (t > t_min && t < t_max) return t;  // false for a parallel segment, whose t is infinite or NaN
    return {};
}

void Geometry::plane_hit(const Plane& plane, Hit& hit) const {
    const dvec3 p = hit.point - plane.origin;
    hit.normal = hit.shading_normal = plane.normal;
    hit.uv = {glm::dot(p, plane.right) / plane.size[0], glm::dot(p, plane.up) / plane.size[1]};
    hit.color = dvec3(1);
    hit.object = plane.object;
    hit.material = plane.material;
}

void Geometry::mesh_hit(const MeshEntry& entry, unsigned triangle, dvec3 origin, dvec3 direction, Hit& hit) const {
    const Mesh& mesh = entry.mesh;
    const Mesh::Triangle& t = mesh.triangles[triangle];
    const dvec3 a = mesh.positions[t.vertex[0]];
    const dvec3 ab = mesh.positions[t.vertex[1]] - a, ac = mesh.positions[t.vertex[2]] - a;
    const dvec3 n = glm::cross(ab, ac);
    const double exact = glm::dot(a - origin, n) / glm::dot(direction, n);
    if (std::isfinite(exact)) hit.t = exact;
    // Barycentric coordinates of the point, by areas.
    const dvec3 ap = origin + hit.t * direction - a;
    const double area2 = glm::dot(n, n);
    const double wb = glm::dot(glm::cross(ap, ac), n) / area2;
    const double wc = glm::dot(glm::cross(ab, ap), n) / area2;
    const std::array<double, 3> weight{1 - wb - wc, wb, wc};
    hit.normal = glm::normalize(n);
    dvec3 shading(0), color(0);
    dvec2 uv(0);
    for (std::size_t k = 0; k < 3; ++k) {
        if (t.normal[k] >= 0) shading += weight[k] * mesh.normals[static_cast<std::size_t>(t.normal[k])];
        if (t.uv[k] >= 0) uv += weight[k] * mesh.uvs[static_cast<std::size_t>(t.uv[k])];
        color += weight[k] * mesh.colors[t.vertex[k]];
    }
    const double length = glm::length(shading);
    hit.shading_normal = length > 1e-12 ? shading / length : hit.normal;
    hit.uv = uv;
    hit.color = glm::max(color, dvec3(0));
    hit.object = entry.object;
    hit.material = t.material >= 0 ? entry.first_material + t.material : entry.material;
}

void Geometry::sphere_hit(const Sphere& sphere, dvec3 origin, dvec3 direction, Hit& hit) const {
    // |origin - c + t d|² = r². The perpendicular part first, so that a distant sphere loses no digits.
    const double d2 = glm::dot(direction, direction);
    const double middle = glm::dot(sphere.center - origin, direction) / d2;
    const dvec3 perpendicular = origin + middle * direction - sphere.center;
    const double h2 = sphere.radius * sphere.radius - glm::dot(perpendicular, perpendicular);
    const double half = std::sqrt(std::max(h2, 0.0) / d2);
    // The root that Embree chose: the near one from outside, the far one from within.
    hit.t = hit.t < middle ? middle - half : middle + half;
    hit.normal = hit.shading_normal = glm::normalize(origin + hit.t * direction - sphere.center);
    hit.uv = latitude_longitude(hit.normal);
    hit.color = dvec3(1);
    hit.object = sphere.object;
    hit.material = sphere.material;
}

}  // namespace eikonal::reference
