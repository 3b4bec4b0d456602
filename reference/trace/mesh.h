/// Triangle meshes from Wavefront OBJ files with their MTL materials.
///
/// The reader takes v (with optional r g b, a vertex colour that multiplies the material's), vt, vn, f (polygons are
/// triangulated), mtllib and usemtl, and Kd, Ke and map_Kd of a material. It ignores everything else. Colours are
/// linear. Coordinates are metres after `scale` and `offset`. Triangles without area are left out.
///
/// Failures: UserError with the file's name, for a mesh or material library that is missing, unreadable or without
/// triangles. UserError with file and line, for a v, vt, vn, Kd or Ke that is not a list of finite numbers, and for an
/// f whose indices are not whole numbers or lie outside their lists.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

namespace eikonal::reference {

using glm::dvec2;
using glm::dvec3;

/// A material as its file states it.
struct MeshMaterial {
    dvec3 diffuse{0.5, 0.5, 0.5};                  ///< Kd, linear; multiplies the texture
    dvec3 emission{0, 0, 0};                       ///< Ke, linear, radiance
    std::optional<std::filesystem::path> texture;  ///< map_Kd, resolved against the folder of its file
};

/// Indexed triangles. `normals`, `uvs` and `materials` may be empty.
struct Mesh {
    struct Triangle {
        std::array<std::uint32_t, 3> vertex;  ///< into positions and colors
        std::array<std::int32_t, 3> normal;   ///< into normals; -1: none at this corner
        std::array<std::int32_t, 3> uv;       ///< into uvs; -1: none
        std::int32_t material = -1;           ///< into materials; -1: the object's material
        /// Whether it belongs to a part that encloses space: each edge of the part belongs to two triangles, if corners
        /// at the same place count as one.
        bool closed = false;
    };
    std::vector<dvec3> positions;  ///< [m], world
    std::vector<dvec3> colors;     ///< per position; 1 where the file has none
    std::vector<dvec3> normals;    ///< as the file has them, not normalised
    std::vector<dvec2> uvs;        ///< v up
    std::vector<Triangle> triangles;
    std::vector<MeshMaterial> materials;
};

/// Reads `file`. A position p of the file becomes offset + scale p.
Mesh read_mesh(const std::filesystem::path& file, double scale, dvec3 offset);

/// A rectangle as two triangles. Corner c0 has uv (0, 0), c0 + u has (1, 0), and c0 + u + v has (1, 1). The normal is
/// u x v.
Mesh make_quad(dvec3 c0, dvec3 u, dvec3 v);

}  // namespace eikonal::reference
