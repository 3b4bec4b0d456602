#include "reference/trace/geometry.h"

#include <fmt/format.h>

#if EIKONAL_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <emmintrin.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>

#include "noise/base/error.h"
#include "reference/trace/direction.h"

namespace eikonal::reference {
namespace {

void check(RTCDevice device) {
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw std::runtime_error("Embree could not build the scene");
}

/// Stores four floats at a time, as Embree reads them. Embree would have to wait for single stores.
void set(RTCRay& ray, const dvec3& origin, const dvec3& direction, double t_min, double t_max) {
    const auto four = [](double x, double y, double z, double w) {
        return _mm_movelh_ps(_mm_cvtpd_ps(_mm_set_pd(y, x)), _mm_cvtpd_ps(_mm_set_pd(w, z)));
    };
    _mm_store_ps(&ray.org_x, four(origin.x, origin.y, origin.z, t_min));
    _mm_store_ps(&ray.dir_x, four(direction.x, direction.y, direction.z, 0));  // and time
    ray.tfar = static_cast<float>(t_max);
    ray.mask = ~0u;
    ray.id = ray.flags = 0;
}

/// A surface closer behind another than this, relative to its distance plus 1 m, counts as the same one.
constexpr double kSameSurface = 1e-5;

bool finite(dvec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Turns both normals to the side of the segment's origin.
void face(dvec3 direction, Hit& hit) {
    if (glm::dot(hit.normal, direction) > 0) hit.normal = -hit.normal;
    if (glm::dot(hit.shading_normal, hit.normal) < 0) hit.shading_normal = -hit.shading_normal;
}

/// Distance to the plane of a triangle that Embree has met at about `near`.
double triangle_distance(const Mesh& mesh, unsigned triangle, const dvec3& origin, const dvec3& direction,
                         double near) {
    const std::array<std::uint32_t, 3>& vertex = mesh.triangles[triangle].vertex;
    const dvec3 a = mesh.positions[vertex[0]];
    const dvec3 n = glm::cross(mesh.positions[vertex[1]] - a, mesh.positions[vertex[2]] - a);
    const double exact = glm::dot(a - origin, n) / glm::dot(direction, n);
    return std::isfinite(exact) ? exact : near;
}

/// Distance to a sphere that Embree has met at about `near`.
double sphere_distance(const dvec3& center, double radius, const dvec3& origin, const dvec3& direction, double near) {
    // Solves |origin - c + t d|² = r². The perpendicular part comes first, so that a distant sphere loses no digits.
    const double d2 = glm::dot(direction, direction);
    const double middle = glm::dot(center - origin, direction) / d2;
    const dvec3 perpendicular = origin + middle * direction - center;
    const double h2 = radius * radius - glm::dot(perpendicular, perpendicular);
    const double half = std::sqrt(std::max(h2, 0.0) / d2);
    // Embree has chosen the near root from outside and the far one from within.
    return near < middle ? middle - half : middle + half;
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
                Plane plane{object.origin, normal, {}, {}, object.size, index, add_material(object, index)};
                perpendicular_axes(normal, object.up, plane.right, plane.up);
                planes_.push_back(plane);
                break;
            }
            case ObjectShape::Sphere:
                spheres_.push_back({object.center, object.radius, index, add_material(object, index)});
                break;
            case ObjectShape::Quad:
            case ObjectShape::Mesh:
                add_mesh(scene, index);
                break;
        }
    }
    for (const MeshEntry& entry : meshes_) attach_mesh(entry);
    attach_spheres();
    rtcCommitScene(scene_.get());
    check(device_.get());
}

Geometry::~Geometry() = default;

int Geometry::add_material(const ObjectSpec& object, int index) {
    materials_.push_back({object.texture ? dvec3(1) : object.color, dvec3(0), object.texture, object.emissive,
                          object.mirror, object.refractive_index, index});
    return static_cast<int>(materials_.size()) - 1;
}

void Geometry::add_mesh(const Scene& scene, int index) {
    const ObjectSpec& object = scene.objects[static_cast<std::size_t>(index)];
    MeshEntry entry{{}, index, add_material(object, index), static_cast<int>(materials_.size())};
    if (object.shape == ObjectShape::Quad) {
        dvec3 right, up;
        perpendicular_axes(glm::normalize(object.normal), object.up, right, up);
        right *= object.size[0];
        up *= object.size[1];
        entry.mesh = make_quad(object.origin - 0.5 * (right + up), right, up);
    } else {
        const std::filesystem::path& file = object.file.value();
        try {
            entry.mesh = read_mesh(file, object.scale, object.center);
        } catch (const UserError& error) {
            throw UserError(fmt::format("object.{}.file: {}", index, error.what()));
        }
    }
    for (const MeshMaterial& m : entry.mesh.materials)
        materials_.push_back(
            {m.diffuse, m.emission, m.texture, object.emissive, object.mirror, object.refractive_index, index});
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

std::optional<Contact> Geometry::nearest(dvec3 origin, dvec3 direction, double t_min, double t_max) const {
    std::optional<Contact> best;
    if (!finite(origin) || !finite(direction)) return best;
    RTCRayHit record;
    set(record.ray, origin - anchor_, direction, t_min, t_max);
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
        const double near = static_cast<double>(record.ray.tfar);
        double t = 0;
        if (record.hit.geomID < meshes_.size()) {
            t = triangle_distance(meshes_[record.hit.geomID].mesh, record.hit.primID, origin, direction, near);
        } else {
            const Sphere& sphere = spheres_[record.hit.primID];
            t = sphere_distance(sphere.center, sphere.radius, origin, direction, near);
        }
        best.emplace(Contact{t, -1, record.hit.geomID, record.hit.primID});
    }
    for (std::size_t i = 0; i < planes_.size(); ++i)
        if (const auto t = plane_distance(planes_[i], origin, direction, t_min, best ? best->t : t_max))
            best.emplace(Contact{*t, static_cast<int>(i), 0, 0});
    return best;
}

void Geometry::look(const Contact& contact, dvec3 origin, dvec3 direction, Hit& hit) const {
    hit.t = contact.t;
    hit.point = origin + contact.t * direction;
    if (contact.plane >= 0)
        plane_hit(planes_[static_cast<std::size_t>(contact.plane)], hit);
    else if (contact.geometry < meshes_.size())
        mesh_hit(meshes_[contact.geometry], contact.primitive, hit);
    else
        sphere_hit(spheres_[contact.primitive], hit);
    face(direction, hit);
}

std::optional<Hit> Geometry::intersect(dvec3 origin, dvec3 direction, double t_min, double t_max) const {
    std::optional<Hit> hit;
    if (const std::optional<Contact> contact = nearest(origin, direction, t_min, t_max))
        look(*contact, origin, direction, hit.emplace());
    return hit;
}

bool Geometry::occluded(dvec3 origin, dvec3 direction, double t_min, double t_max) const {
    if (!finite(origin) || !finite(direction)) return false;
    for (const Plane& plane : planes_)
        if (plane_distance(plane, origin, direction, t_min, t_max)) return true;
    RTCRay ray;
    set(ray, origin - anchor_, direction, t_min, t_max);
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

double Geometry::clearance(const dvec3& point) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Plane& plane : planes_) least = std::min(least, std::abs(glm::dot(point - plane.origin, plane.normal)));
    if (meshes_.empty() && spheres_.empty()) return least;
    RTCBounds bounds;
    rtcGetSceneBounds(scene_.get(), &bounds);
    const dvec3 low = anchor_ + dvec3(bounds.lower_x, bounds.lower_y, bounds.lower_z);
    const dvec3 high = anchor_ + dvec3(bounds.upper_x, bounds.upper_y, bounds.upper_z);
    return std::min(least, glm::length(glm::max(glm::max(low - point, point - high), dvec3(0))));
}

std::optional<int> Geometry::object_around(dvec3 point) const {
    for (const Sphere& sphere : spheres_)
        if (glm::distance(point, sphere.center) < sphere.radius) return sphere.object;
    if (meshes_.empty() || !finite(point)) return {};
    // Every way out of a closed mesh passes its surface an odd number of times.
    constexpr int kWays = 7, kMostSurfaces = 10000;
    std::vector<int> odd(meshes_.size(), 0);
    for (int way = 0; way < kWays; ++way) {
        const double y = (2 * way + 1) / double{kWays} - 1, x = std::sqrt(1 - y * y) * (way % 2 ? 0.612 : -0.791);
        const dvec3 direction = glm::normalize(dvec3(x, y, (way % 3 - 1) + 0.137));
        std::vector<int> passed(meshes_.size(), 0);
        double from = 0;
        for (int i = 0; i < kMostSurfaces; ++i) {
            const auto contact = nearest(point, direction, from, std::numeric_limits<double>::infinity());
            if (!contact) break;
            if (contact->plane < 0 && contact->geometry < meshes_.size() &&
                meshes_[contact->geometry].mesh.triangles[contact->primitive].closed)
                ++passed[contact->geometry];
            from = contact->t + kSameSurface * (1 + contact->t);
        }
        for (std::size_t i = 0; i < passed.size(); ++i) odd[i] += passed[i] % 2;
    }
    // One of the ways may have gone through an edge.
    for (std::size_t i = 0; i < odd.size(); ++i)
        if (odd[i] >= kWays - 1) return meshes_[i].object;
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

void Geometry::mesh_hit(const MeshEntry& entry, unsigned triangle, Hit& hit) const {
    const Mesh& mesh = entry.mesh;
    const Mesh::Triangle& t = mesh.triangles[triangle];
    const dvec3 a = mesh.positions[t.vertex[0]];
    const dvec3 ab = mesh.positions[t.vertex[1]] - a, ac = mesh.positions[t.vertex[2]] - a;
    const dvec3 n = glm::cross(ab, ac);
    // Barycentric coordinates of the point, by areas.
    const dvec3 ap = hit.point - a;
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

void Geometry::sphere_hit(const Sphere& sphere, Hit& hit) const {
    hit.normal = hit.shading_normal = glm::normalize(hit.point - sphere.center);
    hit.uv = latitude_longitude(hit.normal);
    hit.color = dvec3(1);
    hit.object = sphere.object;
    hit.material = sphere.material;
}

}  // namespace eikonal::reference
