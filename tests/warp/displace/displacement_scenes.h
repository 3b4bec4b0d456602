/// Scenes, settings and maps that the tests of displacement share.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "noise/turbulence/parameters/turbulence_spec.h"
#include "warp/displace/displacer.h"

namespace eikonal {

using Map = std::vector<float>;

inline Map map_of(const Displacer& displacer, double frame, const PixelWindow& window, double D, double gain = 1) {
    Map uv(2 * window.area());
    displacer.at(frame, D, D, gain).map(window, D, DepthMeeting::Own, uv.data());
    return uv;
}

inline Map map_of(const Displacer& displacer, double frame, const PixelWindow& window, const DepthPlane& plane,
                  DepthMeeting how) {
    Map uv(2 * window.area());
    displacer.at(frame, plane.nearest(), plane.farthest()).map(window, &plane, how, uv.data());
    return uv;
}

inline double rms(const Map& uv) {
    double sum = 0;
    for (const float v : uv) sum += double{v} * v;
    return std::sqrt(2 * sum / static_cast<double>(uv.size()));
}

inline double difference(const Map& a, const Map& b) {
    Map d(a);
    for (std::size_t i = 0; i < d.size(); ++i) d[i] -= b[i];
    return rms(d);
}

inline TurbulenceSpec lattice_spec() {
    TurbulenceSpec spec;
    spec.form = TurbulenceForm::Lattice;
    spec.cn2 = 1e-11;
    spec.outer_scale = 1;
    spec.inner_scale = 0.5;
    spec.lattice = {{16, 16, 16, 1}};
    spec.period = {{2.0, 2.0, 2.0, 1.0}};
    spec.alpha = 0;
    return spec;
}

inline Scene scene_with(const TurbulenceSpec& spec) {
    Scene scene;
    scene.media = {spec};
    scene.camera.position = {0.13, 0.21, -0.07};
    scene.camera.look_at = scene.camera.position + dvec3(0, 0, -1);
    return scene;
}

inline Scene orthographic(const TurbulenceSpec& spec, const dvec3& forward, const dvec3& up) {
    Scene scene = scene_with(spec);
    scene.camera.projection = Projection::Orthographic;
    scene.camera.width = 1.7;
    scene.camera.look_at = scene.camera.position + forward;
    scene.camera.up = up;
    return scene;
}

inline DisplacerSettings small(double far, std::optional<Model> model = {}) {
    DisplacerSettings s;
    s.negligible = 0;  // scenes of any strength
    s.width = 24;
    s.height = 18;
    s.far = far;
    s.model = model;
    return s;
}
inline constexpr PixelWindow kSmall{0, 0, 24, 18};

/// A picture-like scene of screens: many eddies a view, perspective.
inline Scene long_view(double alpha = 0) {
    TurbulenceSpec spec;
    spec.cn2 = 3e-12;
    spec.outer_scale = 2;
    spec.inner_scale = 0.05;
    spec.alpha = alpha;
    spec.velocity = {0, 0, 0};
    Scene scene = scene_with(spec);
    scene.camera.horizontal_fov = 7;
    return scene;
}

inline DisplacerSettings sized(int width, int height, double far) {
    DisplacerSettings s;
    s.negligible = 0;  // scenes of any strength
    s.width = width;
    s.height = height;
    s.far = far;
    return s;
}

}  // namespace eikonal
