/// The objects of a scene as one thing that segments can be tested against, by Embree (3 or 4).
///
/// Positions and directions are double, in world metres. Embree works in float. It gets everything relative to an
/// anchor, which is the camera of the first frame. A float is there within 6e-8 of the distance, which is an angle of
/// 6e-8 rad as seen from the anchor. Embree only chooses the triangle or sphere. The place where the segment meets it
/// is then solved in double. Infinite planes do not go to Embree. Objects are two-sided.
///
/// Accuracy: the distance of a hit is within kHitAccuracy (relative) of the closed form for planes, quads and spheres,
/// except for segments that are nearly tangent. A segment through the common edge of two triangles may meet either, and
/// the choice may depend on the processor, as Embree's own arithmetic does. The point does not depend on it.
///
/// Failures: UserError for an empty scene and, with the key, for meshes that cannot be read. Intersection never fails:
/// a segment that is not finite meets nothing.
#pragma once

#include <memory>
#include <optional>

#include "reference/trace/mesh.h"
#include "warp/scene/scene.h"

struct RTCDeviceTy;
struct RTCSceneTy;

namespace eikonal::reference {

inline constexpr double kHitAccuracy = 1e-10;

/// The look of a surface without light. Colours are linear.
struct Material {
    dvec3 color{0.5, 0.5, 0.5};
    dvec3 emission{0, 0, 0};
    std::optional<std::filesystem::path> texture;  ///< multiplies `color`
    bool unlit = false;                            ///< shows its colour in any light
    double mirror = 0;                             ///< part of the light that it reflects, 0 … 1
    std::optional<double> refractive_index;        ///< set for glass
    int object = 0;                                ///< index in Scene::objects
};

/// Where a segment origin + t direction first meets a surface.
struct Hit {
    double t = 0;
    dvec3 point{0, 0, 0};
    dvec3 normal{0, 1, 0};          ///< unit, geometric, on the side of the segment's origin
    dvec3 shading_normal{0, 1, 0};  ///< unit, interpolated from the mesh's normals, on the same side
    dvec3 color{1, 1, 1};           ///< of the vertices. It multiplies the material's colour.
    dvec2 uv{0, 0};                 ///< texture coordinates, v up
    int object = 0;                 ///< index in Scene::objects
    int material = 0;               ///< index in materials()
};

/// The surface that a segment meets first, without its look.
struct Contact {
    double t = 0;
    int plane = -1;                        ///< index of Geometry's planes. -1: Embree's geometry
    unsigned geometry = 0, primitive = 0;  ///< Embree's indices
};

class Geometry {
  public:
    /// anchor: where rays mostly start (see above).
    Geometry(const Scene& scene, dvec3 anchor);
    ~Geometry();
    Geometry(const Geometry&) = delete;
    Geometry& operator=(const Geometry&) = delete;

    /// The first surface at t_min < t < t_max. `direction` may have any length.
    std::optional<Hit> intersect(dvec3 origin, dvec3 direction, double t_min, double t_max) const;

    /// The same in two parts, for callers that may need the distance only.
    std::optional<Contact> nearest(dvec3 origin, dvec3 direction, double t_min, double t_max) const;
    void look(const Contact& contact, dvec3 origin, dvec3 direction, Hit& hit) const;

    /// Whether anything lies at t_min < t < t_max.
    bool occluded(dvec3 origin, dvec3 direction, double t_min, double t_max) const;

    /// A point just off the surface at `hit`, on the side of its normal, from which a new ray may start. It is as far
    /// off as Embree's float positions may err there.
    dvec3 leave(const Hit& hit) const;

    /// A lower bound of the way from a point to any surface [m]. Infinity if there is no surface.
    double clearance(const dvec3& point) const;

    /// Index of a sphere or closed mesh that a point lies within. A point lies within a mesh if at least six of seven
    /// ways out pass the mesh's closed parts an odd number of times. Surfaces within a hundred-thousandth of their
    /// distance count as one.
    std::optional<int> object_around(dvec3 point) const;

    const std::vector<Material>& materials() const { return materials_; }

  private:
    struct Plane {
        dvec3 origin, normal, right, up;  ///< unit, orthogonal
        std::array<double, 2> size;       ///< size of one repeat of the texture [m]
        int object, material;
    };
    struct Sphere {
        dvec3 center;
        double radius;
        int object, material;
    };
    struct MeshEntry {
        Mesh mesh;
        int object;
        int material;        ///< of triangles without a material of their own
        int first_material;  ///< place of the mesh's own list in materials_
    };

    int add_material(const ObjectSpec& object, int index);
    void add_mesh(const Scene& scene, int index);
    void attach_mesh(const MeshEntry& entry);
    void attach_spheres();
    std::optional<double> plane_distance(const Plane& plane, dvec3 origin, dvec3 direction, double t_min,
                                         double t_max) const;
    void plane_hit(const Plane& plane, Hit& hit) const;
    void mesh_hit(const MeshEntry& entry, unsigned triangle, Hit& hit) const;
    void sphere_hit(const Sphere& sphere, Hit& hit) const;

    dvec3 anchor_;
    std::vector<Material> materials_;
    std::vector<Plane> planes_;
    std::vector<Sphere> spheres_;
    std::vector<MeshEntry> meshes_;  ///< Embree's geometry i is meshes_[i]. The next one, if any, holds the spheres.
    std::unique_ptr<RTCDeviceTy, void (*)(RTCDeviceTy*)> device_;
    std::unique_ptr<RTCSceneTy, void (*)(RTCSceneTy*)> scene_;
};

}  // namespace eikonal::reference
