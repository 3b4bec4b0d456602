#include "reference/render.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "noise/random.h"
#include "reference/sampler.h"
#include "warp/image/picture.h"
#include "warp/image/pixel_codec.h"

namespace eikonal::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kTileSize = 32;

int tiles_across(int pixels) {
    return (pixels + kTileSize - 1) / kTileSize;
}

std::array<int, 2> resolution(const Scene& scene) {
    return scene.camera.resolution.value_or(std::array{1920, 1080});
}

float storable(double radiance) {
    return std::min(radiance > 0 ? static_cast<float>(radiance) : 0.0f, kLargestHalf);  // NaN becomes 0
}

/// To 18 significant bits: the last six of the mantissa are zero, which packs well. Infinity stays.
float rounded_depth(float z) {
    return std::bit_cast<float>((std::bit_cast<std::uint32_t>(z) + 32u) & ~63u);
}

}  // namespace

CameraRay camera_ray(const Camera& camera, double px, double py) {
    const dvec2 s = camera.slope(px, py);
    const dvec3 across = s.x * camera.right + s.y * camera.up;
    if (camera.projection == Projection::Orthographic) return {camera.position + across, camera.forward};
    return {camera.position, camera.forward + across};
}

Renderer::Renderer(const Scene& scene, int samples)
    : scene_(scene),
      width_(resolution(scene)[0]),
      height_(resolution(scene)[1]),
      samples_(samples),
      path_(scene.camera, width_, height_),
      geometry_(scene_, path_.reference().position),
      shading_(scene_, geometry_) {}

int Renderer::tile_count() const {
    return tiles_across(width_) * tiles_across(height_);
}

RenderedFrame Renderer::render(int frame, const std::function<void()>& tile_done) const {
    const auto area = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    RenderedFrame result{width_, height_, std::vector<float>(4 * area), std::vector<float>(area)};
    const Camera camera = path_.at(frame);
    tbb::parallel_for(0, tile_count(), [&](int index) {
        const int x0 = index % tiles_across(width_) * kTileSize, y0 = index / tiles_across(width_) * kTileSize;
        render_tile(camera, frame, {x0, y0, std::min(x0 + kTileSize, width_), std::min(y0 + kTileSize, height_)},
                    result);
        if (tile_done) tile_done();
    });
    return result;
}

void Renderer::render_tile(const Camera& camera, int frame, const Tile& tile, RenderedFrame& into) const {
    const RandomStream in_pixel(0, "pixel position", static_cast<std::uint64_t>(frame));
    const RandomStream in_sun(0, "sun direction", static_cast<std::uint64_t>(frame));
    const RandomStream in_sky(0, "sky direction", static_cast<std::uint64_t>(frame));
    for (int y = tile.y0; y < tile.y1; ++y) {
        for (int x = tile.x0; x < tile.x1; ++x) {
            const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
            const std::uint64_t pixel_bits = in_pixel.bits(i), sun_bits = in_sun.bits(i), sky_bits = in_sky.bits(i);
            dvec3 sum(0);
            for (int k = 0; k < samples_; ++k) {
                const auto sample = static_cast<std::uint32_t>(k);
                const dvec2 p = spread_point(sample, pixel_bits);
                const CameraRay ray = camera_ray(camera, x + p.x, y + p.y);
                const auto hit = geometry_.intersect(ray.origin, ray.direction, 0, kInfinity);
                sum += hit ? shading_.surface(*hit, {spread_point(sample, sun_bits), spread_point(sample, sky_bits)})
                           : shading_.background(ray.direction);
            }
            const CameraRay center = camera_ray(camera, x + 0.5, y + 0.5);
            const auto hit = geometry_.intersect(center.origin, center.direction, 0, kInfinity);
            for (int c = 0; c < 3; ++c) into.color[4 * i + static_cast<std::size_t>(c)] = storable(sum[c] / samples_);
            into.color[4 * i + 3] = 1;
            into.depth[i] = static_cast<float>(hit ? hit->t : kInfinity);
        }
    }
}

void write_frame(const std::filesystem::path& file, const RenderedFrame& frame, Storage storage) {
    constexpr std::size_t kColorBytes = 8, kPixelBytes = kColorBytes + sizeof(float);
    Part part;
    part.spec = OIIO::ImageSpec(frame.width, frame.height, 5, OIIO::TypeDesc::HALF);
    part.spec.channelformats = {OIIO::TypeDesc::HALF, OIIO::TypeDesc::HALF, OIIO::TypeDesc::HALF, OIIO::TypeDesc::HALF,
                                OIIO::TypeDesc::FLOAT};
    part.spec.channelnames = {"R", "G", "B", "A", "Z"};
    part.spec.alpha_channel = 3;
    part.spec.z_channel = 4;
    part.spec.attribute("compression", storage == Storage::Exact ? "zip" : "dwaa:45");
    part.spec.attribute("oiio:ColorSpace", "Linear");
    part.pixels.resize(frame.depth.size() * kPixelBytes);
    for (std::size_t c = 0; c < 4; ++c)
        encode_values(OIIO::TypeDesc::HALF, frame.color.data() + c, 4, part.pixels.data() + 2 * c, kPixelBytes,
                      frame.depth.size());
    for (std::size_t i = 0; i < frame.depth.size(); ++i) {
        const float z = storage == Storage::Exact ? frame.depth[i] : rounded_depth(frame.depth[i]);
        std::memcpy(part.pixels.data() + i * kPixelBytes + kColorBytes, &z, sizeof z);
    }
    write_picture(file, {{std::move(part)}, "openexr"});
}

}  // namespace eikonal::reference
