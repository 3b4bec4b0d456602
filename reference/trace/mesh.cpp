#include "reference/trace/mesh.h"

#include <fmt/format.h>
#define TINYOBJLOADER_USE_DOUBLE
#include <tiny_obj_loader.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <numeric>
#include <sstream>
#include <utility>

#include "noise/base/error.h"
#include "warp/scene/scene.h"

namespace eikonal::reference {
namespace {

/// The first word of a line of numbers, and the least count of its numbers.
constexpr std::pair<std::string_view, int> kNumbers[] = {{"v", 3}, {"vn", 3}, {"vt", 1}, {"Kd", 3}, {"Ke", 3}};

/// Checks the indices of faces into v, vt and vn.
class FaceCheck {
  public:
    explicit FaceCheck(const std::filesystem::path& file) : file_(file) {}

    /// Takes one line. kind: its first word. words: the rest of the line, which is read for a face.
    void take(std::string_view kind, std::istream& words, long line) {
        for (List& list : lists_) list.count += kind == list.name;
        if (kind != "f") return;
        for (std::string corner; words >> corner;) {
            std::size_t from = 0;
            for (std::size_t k = 0; k < lists_.size() && from <= corner.size(); ++k) {
                const std::size_t slash = std::min(corner.find('/', from), corner.size());
                // The second of three indices may be left out.
                if (const std::string text = corner.substr(from, slash - from);
                    k != 1 || !text.empty() || slash == corner.size())
                    note(lists_[k], text, corner, line);
                from = slash + 1;
            }
            if (from <= corner.size()) refuse(corner, line);
        }
    }

    /// Checks all faces. To be called after the last line, since a face may use what comes after it.
    void finish() const {
        for (const List& list : lists_)
            if (list.largest > list.count) refuse_entry(list, list.largest, list.line);
    }

  private:
    struct List {
        const char* name;
        long count = 0, largest = 0, line = 0;  ///< largest: the largest index, on line `line`
    };

    void note(List& list, const std::string& text, const std::string& corner, long line) {
        int index = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
        if (error != std::errc() || end != text.data() + text.size() || index == 0) refuse(corner, line);
        if (index < 0 && -static_cast<long>(index) > list.count) refuse_entry(list, index, line);
        if (index > list.largest) {
            list.largest = index;
            list.line = line;
        }
    }
    [[noreturn]] void refuse(const std::string& corner, long line) const {
        throw UserError(
            fmt::format("{}:{}: f: '{}' is no corner: give whole numbers from 1 to 2147483647, or from -1 "
                        "backwards, as in 3, 3/1, 3//2 or 3/1/2",
                        file_.string(), line, corner));
    }
    [[noreturn]] void refuse_entry(const List& list, long index, long line) const {
        throw UserError(fmt::format("{}:{}: f: there is no {} {}, the file has {}{}: repair the mesh", file_.string(),
                                    line, list.name, index, list.count, index < 0 ? " before it" : ""));
    }

    const std::filesystem::path& file_;
    std::array<List, 3> lists_{{{"v"}, {"vt"}, {"vn"}}};
};

/// Escapes the spaces in the name of a material library. Any other line is returned as it is.
std::string with_whole_name(const std::string& line, const std::filesystem::path& folder) {
    constexpr std::string_view kLibrary = "mtllib ";
    if (!line.starts_with(kLibrary)) return line;
    const std::string name = line.substr(kLibrary.size());
    std::error_code ignored;
    if (name.find(' ') == name.npos || !std::filesystem::is_regular_file(folder / name, ignored)) return line;
    std::string result(kLibrary);
    for (const char c : name) result += c == ' ' ? "\\ " : std::string(1, c);
    return result;
}

/// The text of a file in `folder`, without a byte order mark. A line that ends in a backslash is joined to the next,
/// except for comments. The number of lines stays the same.
std::stringstream joined(std::istream& stream, const std::filesystem::path& folder) {
    constexpr std::string_view kMark = "\xEF\xBB\xBF";
    std::stringstream result;
    std::string text, owed;
    for (bool first = true; std::getline(stream, text); first = false) {
        if (first && text.starts_with(kMark)) text.erase(0, kMark.size());
        if (text.ends_with('\r')) text.pop_back();
        text = with_whole_name(text, folder);
        // tinyobjloader does not accept a comment behind a face.
        if (text.starts_with("f ") && text.find('#') != text.npos) text.erase(text.find('#'));
        if (text.ends_with('\\') && text.find('#') == text.npos) {
            text.back() = ' ';
            result << text;
            owed += '\n';
            continue;
        }
        result << text << '\n' << std::exchange(owed, {});
    }
    result << owed;
    return result;
}

/// UserError if a line of numbers or indices holds anything else. tinyobjloader would read it as 0. Leaves the stream
/// at its start.
void check_numbers(std::istream& stream, const std::filesystem::path& file) {
    FaceCheck faces(file);
    std::string text;
    for (long line = 1; std::getline(stream, text); ++line) {
        std::istringstream words(text.substr(0, text.find('#')));
        std::string word;
        words >> word;
        faces.take(word, words, line);
        const auto* const kind = std::find_if(std::begin(kNumbers), std::end(kNumbers),
                                              [&](const auto& entry) { return entry.first == word; });
        if (kind == std::end(kNumbers)) continue;
        int count = 0;
        for (; words >> word; ++count) {
            const char *first = word.data() + (word.front() == '+'), *last = word.data() + word.size();
            double value = 0;
            const auto [end, error] = std::from_chars(first, last, value);
            if (error != std::errc() || end != last || !(std::abs(value) <= kLargestValue))
                throw UserError(fmt::format("{}:{}: {}: '{}' is not a number of at most {:g} in magnitude: repair it",
                                            file.string(), line, kind->first, word, kLargestValue));
        }
        if (count < kind->second)
            throw UserError(fmt::format("{}:{}: {} needs {} numbers and has {}: repair it", file.string(), line,
                                        kind->first, kind->second, count));
    }
    faces.finish();
    stream.clear();
    stream.seekg(0);
}

/// Reads material libraries and remembers those that it could not open. tinyobjloader would only warn of them.
class MaterialReader : public tinyobj::MaterialReader {
  public:
    explicit MaterialReader(std::filesystem::path folder) : folder_(std::move(folder)) {}

    bool operator()(const std::string& name, std::vector<tinyobj::material_t>* materials,
                    std::map<std::string, int>* index, std::string* warnings, std::string* errors) override {
        std::ifstream stream(folder_ / name);
        if (!stream) {
            missing_ = folder_ / name;
            return false;
        }
        check_numbers(stream, folder_ / name);
        tinyobj::LoadMtl(index, materials, &stream, warnings, errors);
        return true;
    }

    const std::optional<std::filesystem::path>& missing() const { return missing_; }

  private:
    std::filesystem::path folder_;
    std::optional<std::filesystem::path> missing_;
};

std::string first_line(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

std::vector<dvec3> vectors(const std::vector<double>& values) {
    std::vector<dvec3> result(values.size() / 3);
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
    return result;
}

bool has_area(const Mesh& mesh, const Mesh::Triangle& t) {
    const dvec3 a = mesh.positions[t.vertex[0]], b = mesh.positions[t.vertex[1]], c = mesh.positions[t.vertex[2]];
    const dvec3 n = glm::cross(b - a, c - a);
    return glm::dot(n, n) > 0;
}

/// Sets Triangle::closed of all triangles.
void mark_closed(Mesh& mesh) {
    using Index = std::uint32_t;
    const auto place = [&](Index i) {
        const dvec3& p = mesh.positions[i];
        return std::array{p.x, p.y, p.z};
    };
    std::vector<Index> order(mesh.positions.size()), same(order.size()), part(order.size());
    std::iota(order.begin(), order.end(), Index{0});
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return place(a) < place(b); });
    for (std::size_t i = 0; i < order.size(); ++i)
        same[order[i]] = i > 0 && place(order[i]) == place(order[i - 1]) ? same[order[i - 1]] : order[i];
    std::iota(part.begin(), part.end(), Index{0});
    const auto part_of = [&](Index i) {
        while (part[i] != i) i = part[i] = part[part[i]];
        return i;
    };
    std::vector<std::pair<Index, Index>> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (const Mesh::Triangle& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Index a = same[t.vertex[k]], b = same[t.vertex[(k + 1) % 3]];
            if (a == b) continue;
            edges.emplace_back(std::minmax(a, b));
            part[part_of(a)] = part_of(b);
        }
    }
    std::sort(edges.begin(), edges.end());
    std::vector<bool> open(part.size(), false);
    for (auto edge = edges.begin(); edge != edges.end();) {
        const auto next = std::find_if(edge, edges.end(), [&](const auto& other) { return other != *edge; });
        if (next - edge != 2) open[part_of(edge->first)] = true;
        edge = next;
    }
    for (Mesh::Triangle& t : mesh.triangles) t.closed = !open[part_of(same[t.vertex[0]])];
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& file, double scale, dvec3 offset) {
    std::ifstream opened(file);
    if (!opened || std::filesystem::is_directory(file))
        throw UserError(fmt::format("cannot read the mesh {}: give an existing .obj file", file.string()));
    std::stringstream stream = joined(opened, file.parent_path());
    check_numbers(stream, file);
    tinyobj::attrib_t attrib;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
    std::string warnings, errors;
    MaterialReader material_reader(file.parent_path());
    const bool ok = tinyobj::LoadObj(&attrib, &shapes, &materials, &warnings, &errors, &stream, &material_reader);
    if (material_reader.missing())
        throw UserError(fmt::format("{}: cannot read its material library {}: put it there or remove its mtllib line",
                                    file.string(), material_reader.missing()->string()));
    if (!ok) throw UserError(fmt::format("{}: not a valid OBJ file: {}", file.string(), first_line(errors)));

    Mesh mesh;
    mesh.positions = vectors(attrib.vertices);
    for (dvec3& p : mesh.positions) p = offset + scale * p;
    mesh.colors = vectors(attrib.colors);
    mesh.colors.resize(mesh.positions.size(), dvec3(1));
    mesh.normals = vectors(attrib.normals);
    mesh.uvs.resize(attrib.texcoords.size() / 2);
    for (std::size_t i = 0; i < mesh.uvs.size(); ++i)
        mesh.uvs[i] = {attrib.texcoords[2 * i], attrib.texcoords[2 * i + 1]};
    for (const tinyobj::material_t& m : materials) {
        MeshMaterial material{
            {m.diffuse[0], m.diffuse[1], m.diffuse[2]}, {m.emission[0], m.emission[1], m.emission[2]}, {}};
        if (!m.diffuse_texname.empty()) material.texture = file.parent_path() / m.diffuse_texname;
        mesh.materials.push_back(std::move(material));
    }
    for (const tinyobj::shape_t& shape : shapes) {
        const tinyobj::mesh_t& m = shape.mesh;
        for (std::size_t i = 0; 3 * i + 2 < m.indices.size(); ++i) {
            Mesh::Triangle t{};
            for (std::size_t k = 0; k < 3; ++k) {
                const tinyobj::index_t& corner = m.indices[3 * i + k];
                t.vertex[k] = static_cast<std::uint32_t>(corner.vertex_index);
                t.normal[k] = corner.normal_index;
                t.uv[k] = corner.texcoord_index;
            }
            t.material = m.material_ids[i];
            mesh.triangles.push_back(t);
        }
    }
    mark_closed(mesh);
    std::erase_if(mesh.triangles, [&](const Mesh::Triangle& t) { return !has_area(mesh, t); });
    if (mesh.triangles.empty())
        throw UserError(fmt::format("{}: the mesh has no triangle with an area: nothing to render", file.string()));
    return mesh;
}

Mesh make_quad(dvec3 c0, dvec3 u, dvec3 v) {
    Mesh mesh;
    mesh.positions = {c0, c0 + u, c0 + u + v, c0 + v};
    mesh.colors.assign(4, dvec3(1));
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = {{{0, 1, 2}, {-1, -1, -1}, {0, 1, 2}, -1}, {{0, 2, 3}, {-1, -1, -1}, {0, 2, 3}, -1}};
    return mesh;
}

}  // namespace eikonal::reference
