/// Scenes, and comparisons of frames, that the tests of rendered pictures share. Pictures have kWidth × kHeight pixels.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "reference/trace/render.h"

namespace eikonal::reference {

inline constexpr int kWidth = 48, kHeight = 36;

inline RenderSettings settings(int samples = 1) {
    RenderSettings s;
    s.samples = samples;
    return s;
}

inline RenderSettings straight(int samples = 1) {
    RenderSettings s = settings(samples);
    s.straight = true;
    return s;
}

/// A camera at the height of 1.5 m that looks along -z.
inline Scene scene_with(std::vector<ObjectSpec> objects, double fov = 20) {
    Scene scene;
    scene.file = "scene.toml";
    scene.camera.resolution = {kWidth, kHeight};
    scene.camera.position = {0, 1.5, 0};
    scene.camera.look_at = {0, 1.5, -1};
    scene.camera.horizontal_fov = fov;
    scene.objects = std::move(objects);
    return scene;
}

inline ObjectSpec quad(dvec3 center, dvec3 normal, double side, dvec3 color = dvec3(0.5)) {
    ObjectSpec o;
    o.shape = ObjectShape::Quad;
    o.origin = center;
    o.normal = normal;
    o.size = {side, side};
    o.color = color;
    return o;
}

inline ObjectSpec sphere(dvec3 center, double radius, dvec3 color = dvec3(0.5)) {
    ObjectSpec o;
    o.shape = ObjectShape::Sphere;
    o.center = center;
    o.radius = radius;
    o.color = color;
    return o;
}

inline ObjectSpec glass(ObjectSpec o, double index) {
    o.refractive_index = index;
    return o;
}

inline Camera camera_of(const Scene& scene) {
    return CameraPath(scene.camera, kWidth, kHeight).at(1);
}

inline std::size_t at(int x, int y) {
    return static_cast<std::size_t>(y * kWidth + x);
}

inline dvec3 colour(const RenderedFrame& frame, int x, int y) {
    const std::size_t i = 4 * at(x, y);
    return {frame.color[i], frame.color[i + 1], frame.color[i + 2]};
}

inline bool same(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0);
}

inline bool same(const RenderedFrame& a, const RenderedFrame& b) {
    return same(a.color, b.color) && same(a.depth, b.depth) && same(a.length, b.length) && same(a.u, b.u) &&
           same(a.v, b.v) && same(a.id, b.id) && same(a.steps, b.steps) && same(a.error, b.error) &&
           same(a.magnification, b.magnification);
}

inline void expect_finite(const RenderedFrame& frame) {
    for (const auto* plane : {&frame.color, &frame.u, &frame.v, &frame.id, &frame.steps, &frame.error})
        for (const float value : *plane) ASSERT_TRUE(std::isfinite(value));
    for (const auto* plane : {&frame.depth, &frame.length})
        for (const float value : *plane) ASSERT_FALSE(std::isnan(value));
}

/// Mirage of a hot road, in which the lower part of the far wall appears mirrored.
inline Scene mirage() {
    Scene scene = scene_with({quad({0, 0, -400}, {0, 0, 1}, 100)}, 2);
    scene.objects.emplace_back();  // the road, a plane
    scene.camera.look_at = {0, 1.5, -400};
    scene.media = {SurfaceSpec{.surface_temperature = 340, .dropoff = 0.05}};
    return scene;
}

}  // namespace eikonal::reference
