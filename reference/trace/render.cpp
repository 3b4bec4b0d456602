#include "reference/trace/render.h"

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "noise/base/error.h"
#include "noise/math/random.h"
#include "reference/trace/frame_air.h"
#include "reference/trace/sampler.h"
#include "warp/image/pixel_codec.h"
#include "warp/scene/background.h"

namespace eikonal::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Small pictures get small tiles, so that there are enough of them for all threads.
constexpr int kTileSize = 32, kSmallTile = 8, kSmallPicture = 256 * 256;
constexpr int kSightRays = 33;
constexpr float kTrappedId = -1, kNoIndexId = -2, kUnfinishedId = -3;
/// Largest displacement that rounding alone may give a straight ray [px].
constexpr double kRoundingShift = 1e-7;

int tiles_across(int pixels, int side) {
    return (pixels + side - 1) / side;
}

float storable(double radiance) {
    return std::min(radiance > 0 ? static_cast<float>(radiance) : 0.0f, kLargestHalf);  // NaN becomes 0
}

std::size_t count(const std::vector<float>& values, float wanted) {
    return static_cast<std::size_t>(std::count(values.begin(), values.end(), wanted));
}

}  // namespace

std::size_t RenderedFrame::trapped() const {
    return count(id, kTrappedId) + unfinished();
}
std::size_t RenderedFrame::unfinished() const {
    return count(id, kUnfinishedId);
}
std::size_t RenderedFrame::without_index() const {
    return count(id, kNoIndexId);
}
std::size_t RenderedFrame::folded() const {
    return static_cast<std::size_t>(
        std::count_if(magnification.begin(), magnification.end(), [](float m) { return m < 0; }));
}

Renderer::Renderer(const Scene& scene, const RenderSettings& settings)
    : scene_(scene),
      settings_(settings),
      width_(scene.camera.resolution.value_or(kDefaultResolution)[0]),
      height_(scene.camera.resolution.value_or(kDefaultResolution)[1]),
      path_(scene.camera, width_, height_),
      geometry_(scene_, path_.reference().position),
      shading_(scene_, geometry_) {
    if (!settings.straight) air_.emplace(scene_, settings.rays, ray_ends());
    const bool quads = std::any_of(scene_.objects.begin(), scene_.objects.end(),
                                   [](const ObjectSpec& o) { return o.shape == ObjectShape::Quad; });
    if (settings.light_rays > 0 && (!scene_.light || !quads))
        throw UserError(
            fmt::format("`light_rays` {}: there is no {} in the scene; sunlight is followed onto quads under a "
                        "[light]",
                        settings.light_rays, !scene_.light ? "[light]" : "[[object]] of shape quad"));
}

/// The longest way of kSightRays² straight rays to what they meet [m]. A ray that meets nothing counts as `open`.
double Renderer::longest_way(const Camera& camera, double open) const {
    double longest = 0;
    for (int j = 0; j < kSightRays; ++j)
        for (int i = 0; i < kSightRays; ++i) {
            const CameraRay ray = camera_ray(camera, (i + 0.5) / kSightRays * width_, (j + 0.5) / kSightRays * height_);
            const auto hit = geometry_.intersect(ray.origin, glm::normalize(ray.direction), 0, kFarthestSight);
            longest = std::max(longest, hit ? hit->t : open);
        }
    return longest;
}

/// The ends of rays in the shot's narrowest view.
RayEnds Renderer::ray_ends() const {
    Camera camera = path_.reference();
    if (path_.moving()) camera.f_px = std::max(camera.f_px, path_.at(path_.frames()[1]).f_px);
    return {longest_way(camera, far_of_scene(scene_)), settings_.rays.tolerance_px / camera.f_px,
            camera.projection == Projection::Perspective};
}

int Renderer::tile_size() const {
    return width_ * height_ < kSmallPicture ? kSmallTile : kTileSize;
}

int Renderer::tile_count() const {
    return tiles_across(width_, tile_size()) * tiles_across(height_, tile_size());
}

RenderedFrame Renderer::planes(int width, int height, bool colour) const {
    const auto area = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    RenderedFrame result;
    result.width = width;
    result.height = height;
    if (colour) result.color.resize(4 * area);
    result.depth.resize(area);
    if (settings_.straight) return result;
    for (auto* plane : {&result.length, &result.u, &result.v, &result.id, &result.steps, &result.error})
        plane->resize(area);
    if (settings_.magnification) result.magnification.resize(area);
    return result;
}

void Renderer::check_camera(int frame) const {
    const dvec3 at = camera(frame).position;
    if (const auto below = air_ ? air_->below_surface(at) : std::nullopt)
        throw UserError(fmt::format(
            "medium.{}.origin: at frame {} the camera at ({:g}, {:g}, {:g}) is {:g} m below this surface; it "
            "must be above it: lower the surface, or turn its normal towards the camera",
            below->medium, frame, at.x, at.y, at.z, below->depth));
}

std::optional<Renderer::FrameAir> Renderer::air_at(int frame, const Camera& camera) const {
    if (settings_.straight) return std::nullopt;
    FrameAir air{air_->at(frame), air_->trace_settings(camera), {}, {}};
    if (air.trace.perspective) air.trace.start_at(air.field, camera.position);
    const double far = far_of_scene(scene_);
    air.trace.sight = air.trace.perspective ? air.trace.far : std::max(far, longest_way(camera, far));
    return air;
}

RenderedFrame Renderer::render(int frame, const FrameWatch& watch, std::optional<double> background) const {
    RenderedFrame result = planes(width_, height_, settings_.colour);
    const Camera camera = path_.at(frame);
    std::optional<FrameAir> air = air_at(frame, camera);
    if (air) air->background = background;
    if (air && watch.probed) {
        Probe probe = try_rays(camera, frame, &*air, {});
        if (settings_.rays.integrator == Integrator::Adaptive) try_again(camera, frame, *air, probe);
        watch.probed(probe);
    }
    if (air && settings_.light_rays > 0 && scene_.light && settings_.colour)
        air->sunlight.emplace(scene_, geometry_, *air_, air->field, air->trace, settings_.light_rays, settings_.stop,
                              watch.light);
    if (watch.tiles_begin) watch.tiles_begin();
    tbb::parallel_for(0, tile_count(), [&](int index) {
        const int side = tile_size(), columns = tiles_across(width_, side);
        const int x0 = index % columns * side, y0 = index / columns * side;
        render_tile(camera, frame, {x0, y0, std::min(x0 + side, width_), std::min(y0 + side, height_)},
                    air ? &*air : nullptr, result);
        if (watch.tile_done) watch.tile_done();
    });
    return result;
}

void Renderer::render_tile(const Camera& camera, int frame, const Tile& tile, const FrameAir* air,
                           RenderedFrame& into) const {
    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x)
            render_pixel(camera, frame, x, y, air, settings_.colour ? settings_.samples : 0,
                         static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x),
                         into);
}

/// Renders pixel (x, y) into place i. 0 samples: without colour. Returns the end of its centre's bent ray.
BentHit Renderer::render_pixel(const Camera& camera, int frame, int x, int y, const FrameAir* air, int samples,
                               std::size_t i, RenderedFrame& into) const {
    BentHit end;
    if (air)
        end = center_bent(camera, x, y, *air, i, into);
    else
        center_straight(camera, x, y, i, into);
    if (samples > 0) {
        const dvec3 c = colour(camera, frame, x, y, air, samples, end.ended());
        for (int k = 0; k < 3; ++k) into.color[4 * i + static_cast<std::size_t>(k)] = storable(c[k]);
        into.color[4 * i + 3] = 1;
    }
    return end;
}

dvec3 Renderer::colour(const Camera& camera, int frame, int x, int y, const FrameAir* air, int samples,
                       bool has_end) const {
    const auto pixel =
        static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(width_) + static_cast<std::uint64_t>(x);
    const auto bits = [&](std::string_view name) {
        return RandomStream(0, name, static_cast<std::uint64_t>(frame)).bits(pixel);
    };
    const std::uint64_t pixel_bits = bits("pixel position"), sun_bits = bits("sun direction"),
                        sky_bits = bits("sky direction");
    const RayTree tree(geometry_, shading_, air ? &air->field : nullptr,
                       air && air->sunlight ? &*air->sunlight : nullptr, settings_.stop);
    const TraceSettings straight;
    dvec3 sum(0);
    for (int k = 0; k < samples && (has_end || k < kTriedSamples); ++k) {
        const auto sample = static_cast<std::uint32_t>(k);
        const dvec2 p = spread_point(sample, pixel_bits);
        const CameraRay ray = camera_ray(camera, x + p.x, y + p.y);
        LightSample light{};
        if (scene_.light) light = {spread_point(sample, sun_bits), spread_point(sample, sky_bits)};
        const auto seen = tree.radiance(ray.origin, ray.direction, air ? air->trace : straight, light);
        has_end = has_end || seen;
        sum += seen.value_or(dvec3(0));
    }
    return sum / static_cast<double>(samples);
}

void Renderer::center_straight(const Camera& camera, int x, int y, std::size_t i, RenderedFrame& into) const {
    check_stop(settings_.stop);
    const CameraRay ray = camera_ray(camera, x + 0.5, y + 0.5);
    const auto hit = geometry_.intersect(ray.origin, ray.direction, 0, kInfinity);
    into.depth[i] = static_cast<float>(hit ? hit->t : kInfinity);
}

BentHit Renderer::center_bent(const Camera& camera, int x, int y, const FrameAir& air, std::size_t i,
                              RenderedFrame& into) const {
    const dvec2 center{x + 0.5, y + 0.5};
    const CameraRay ray = camera_ray(camera, center.x, center.y);
    const dvec3 direction = glm::normalize(ray.direction);
    const bool bundled = settings_.magnification && follows_bundles(settings_.rays.integrator);
    Bundle bundle{};
    const Bundle pixels = pixel_bundle(camera, center.x, center.y);
    if (bundled) bundle = pixels;
    check_stop(settings_.stop);
    const BentHit end = trace(air.field, &geometry_, ray.origin, direction, air.trace, bundled ? &bundle : nullptr,
                              watch(settings_.stop));
    into.steps[i] = static_cast<float>(end.steps);
    into.error[i] = static_cast<float>(end.error_px);
    into.depth[i] = into.length[i] = static_cast<float>(kInfinity);
    if (settings_.magnification) into.magnification[i] = 1;
    if (!end.ended()) {
        into.id[i] = end.end == BentHit::End::Trapped   ? kTrappedId
                     : end.end == BentHit::End::NoIndex ? kNoIndexId
                                                        : kUnfinishedId;
        return end;
    }
    const bool perspective = camera.projection == Projection::Perspective;
    // What is seen, relative to the camera: a point, or the direction of an infinitely far background.
    dvec3 seen = end.at.x - camera.position;
    if (end.hit) {
        into.id[i] = static_cast<float>(end.surface.object + 1);
        into.depth[i] = static_cast<float>(glm::dot(seen, camera.forward));
        into.length[i] = static_cast<float>(end.length);
    } else if (perspective && air.background) {
        TraceSettings up_to_it = air.trace;
        up_to_it.far = *air.background * glm::length(ray.direction);
        seen = trace(air.field, nullptr, ray.origin, direction, up_to_it).at.x - camera.position;
    } else if (perspective) {
        seen = end.at.p;
    }
    const double forward = glm::dot(seen, camera.forward);
    const double scale = perspective ? 1 / forward : 1;
    if (!perspective || forward > 0) {
        const dvec2 shown = camera.pixel({glm::dot(seen, camera.right) * scale, glm::dot(seen, camera.up) * scale});
        // The rounding of a straight ray is no displacement.
        const dvec2 d = shown - center;
        into.u[i] = std::abs(d.x) < kRoundingShift ? 0.0f : static_cast<float>(d.x);
        into.v[i] = std::abs(d.y) < kRoundingShift ? 0.0f : static_cast<float>(d.y);
    }
    if (bundled)
        into.magnification[i] = static_cast<float>(magnification(pixels, direction, end.at, bundle, end.length));
    return end;
}

}  // namespace eikonal::reference
