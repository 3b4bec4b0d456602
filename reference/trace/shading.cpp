#include "reference/trace/shading.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>

#include "noise/base/error.h"
#include "noise/math/portable_math.h"
#include "reference/trace/direction.h"
#include "reference/trace/shadowgraph.h"
#include "warp/image/picture.h"

namespace eikonal::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

int wrapped(int i, int n) {
    const int r = i % n;
    return r < 0 ? r + n : r;
}

/// key: the scene's key that names the texture, or the file that names it.
Texture read_texture(const std::filesystem::path& file, const std::string& key) {
    try {
        return Texture(file);
    } catch (const FrameError& error) {
        throw UserError(fmt::format("{}: cannot use the texture {}: {}", key, file.string(), error.what()));
    }
}

/// The texture of a material, which the scene names or a material of its mesh.
Texture texture_of(const Scene& scene, const Material& material) {
    const ObjectSpec& object = scene.objects[static_cast<std::size_t>(material.object)];
    const bool own = object.texture == material.texture;
    return read_texture(*material.texture, fmt::format("object.{}.{}", material.object, own ? "texture" : "file"));
}

}  // namespace

Texture::Texture(const std::filesystem::path& file) {
    const Picture picture = read_picture(file);
    const Part& part = picture.parts.front();
    if (part.groups.empty() || part.groups.front().count == 0) throw FrameError("it has no colour channel");
    const LinearImage image = load_group(part, part.groups.front());
    const bool gray = part.groups.front().count == 1;
    width_ = image.data.width;
    height_ = image.data.height;
    rgb_.resize(image.data.area() * 3);
    for (std::size_t i = 0; i < image.data.area(); ++i)
        for (std::size_t c = 0; c < 3; ++c) rgb_[3 * i + c] = image.pixels[4 * i + (gray ? 0 : c)];
}

dvec3 Texture::at(dvec2 uv, bool wrap_v) const {
    // Only the fraction matters where the texture repeats. It also keeps the conversion to int in range.
    const double u = uv.x - std::floor(uv.x);
    const double v = wrap_v ? uv.y - std::floor(uv.y) : uv.y;
    if (!std::isfinite(u) || !std::isfinite(v)) return dvec3(0);
    const double x = u * width_ - 0.5, y = (1 - v) * height_ - 0.5;
    const double fx = std::floor(x), fy = std::floor(y);
    const auto column = [&](int i) { return wrapped(i, width_); };
    const auto row = [&](int i) { return wrap_v ? wrapped(i, height_) : std::min(std::max(i, 0), height_ - 1); };
    const auto pixel = [&](int i, int j) {
        const std::size_t k = 3 * (static_cast<std::size_t>(row(j)) * static_cast<std::size_t>(width_) +
                                   static_cast<std::size_t>(column(i)));
        return dvec3(rgb_[k], rgb_[k + 1], rgb_[k + 2]);
    };
    const int i = static_cast<int>(fx), j = static_cast<int>(fy);
    const double a = x - fx, b = y - fy;
    return (1 - b) * ((1 - a) * pixel(i, j) + a * pixel(i + 1, j)) +
           b * ((1 - a) * pixel(i, j + 1) + a * pixel(i + 1, j + 1));
}

Shading::Shading(const Scene& scene, const Geometry& geometry) : scene_(scene), geometry_(geometry) {
    if (scene.light) {
        to_sun_ = -glm::normalize(scene.light->direction);
        perpendicular_axes(to_sun_, {}, sun_right_, sun_up_);
        sun_right_ *= kSunRadius;
        sun_up_ *= kSunRadius;
    }
    std::map<std::filesystem::path, int> known;
    for (const Material& material : geometry.materials()) {
        int index = -1;
        if (material.texture) {
            const auto [entry, added] = known.try_emplace(*material.texture, static_cast<int>(textures_.size()));
            if (added) textures_.push_back(texture_of(scene, material));
            index = entry->second;
        }
        texture_of_material_.push_back(index);
    }
    if (scene.background.image) sky_ = read_texture(*scene.background.image, "background.image");
}

dvec3 Shading::surface(const Hit& hit, const LightSample& sample, const Shadowgraph* bent) const {
    const Material& material = geometry_.materials()[static_cast<std::size_t>(hit.material)];
    const dvec3 color = albedo(hit);
    if (!scene_.light || material.unlit) return color + material.emission;
    const dvec3 to_sun = sun_direction(sample.sun);
    return material.emission + color * (sunlight(hit, to_sun, bent) + skylight(hit, to_sun, sample.sky));
}

dvec3 Shading::background(dvec3 direction) const {
    return sky_ ? sky_->at(latitude_longitude(direction), false) : scene_.background.color;
}

dvec3 Shading::albedo(const Hit& hit) const {
    const auto i = static_cast<std::size_t>(hit.material);
    dvec3 color = geometry_.materials()[i].color * hit.color;
    if (const int texture = texture_of_material_[i]; texture >= 0)
        color *= textures_[static_cast<std::size_t>(texture)].at(hit.uv);
    return color;
}

dvec3 Shading::sun_direction(dvec2 sample) const {
    double s, c;
    portable::sincos_turns(sample.x, s, c);
    const double r = std::sqrt(sample.y);
    return to_sun_ + r * (c * sun_right_ + s * sun_up_);
}

dvec3 Shading::sunlight(const Hit& hit, dvec3 to_sun, const Shadowgraph* bent) const {
    const double cosine = glm::dot(hit.shading_normal, to_sun);
    if (cosine <= 0 || glm::dot(hit.normal, to_sun) <= 0) return dvec3(0);
    if (bent)
        if (const auto irradiance = bent->irradiance(hit)) return *irradiance * cosine * scene_.light->color;
    if (geometry_.occluded(geometry_.leave(hit), to_sun, 0, kInfinity)) return dvec3(0);
    return cosine * scene_.light->color;
}

dvec3 Shading::skylight(const Hit& hit, dvec3 to_sun, dvec2 sample) const {
    // A cosine-weighted direction about n is n plus a point on the unit sphere.
    double s, c;
    portable::sincos_turns(sample.x, s, c);
    const double z = 1 - 2 * sample.y;
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    const dvec3 direction = hit.shading_normal + dvec3(r * c, z, r * s);
    const double above = glm::dot(direction, hit.normal);
    if (above <= 1e-9) return dvec3(0);
    const auto next = geometry_.intersect(geometry_.leave(hit), direction, 0, kInfinity);
    if (!next) return scene_.light->ambient;
    const Material& material = geometry_.materials()[static_cast<std::size_t>(next->material)];
    const dvec3 color = albedo(*next);
    // Emission is left out. A lamp of a few pixels, found by chance, would only speckle the picture.
    if (material.unlit) return color;
    return color * (sunlight(*next, to_sun) + scene_.light->ambient);
}

}  // namespace eikonal::reference
