/// Scenes, settings and the call of the tracer that its tests share.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "noise/blobs/blobs_spec.h"
#include "noise/medium/medium_spec.h"
#include "noise/medium/optics.h"
#include "noise/profile/profile_spec.h"
#include "noise/surface/surface_spec.h"
#include "reference/trace/bent_ray.h"

namespace eikonal::reference {

using std::numbers::pi;
inline constexpr double kNever = std::numeric_limits<double>::infinity();
inline constexpr auto kTrueIntegrators = {Integrator::Adaptive, Integrator::Rk4, Integrator::Leapfrog,
                                          Integrator::Euler};

/// A scene of media at t = 0.
struct TestAir {
    Air field;
    AirInstant now;
    explicit TestAir(const std::vector<MediumSpec>& media, const OpticsSpec& optics = {})
        : field(media, optics, {.memory_limit = std::uint64_t{1} << 30}), now(field.at(0)) {}
};

inline ProfileSpec profile(ProfileKind kind) {
    ProfileSpec spec;
    spec.profile = kind;
    return spec;
}

inline ObjectSpec plane(dvec3 origin, dvec3 normal) {
    ObjectSpec object;
    object.shape = ObjectShape::Plane;
    object.origin = origin;
    object.normal = normal;
    return object;
}

inline ObjectSpec sphere(dvec3 center, double radius) {
    ObjectSpec object;
    object.shape = ObjectShape::Sphere;
    object.center = center;
    object.radius = radius;
    return object;
}

inline ObjectSpec quad(dvec3 center, dvec3 normal, double side) {
    ObjectSpec object;
    object.shape = ObjectShape::Quad;
    object.origin = center;
    object.normal = normal;
    object.size = {side, side};
    return object;
}

inline std::unique_ptr<Geometry> geometry(std::vector<ObjectSpec> objects) {
    Scene scene;
    scene.objects = std::move(objects);
    return std::make_unique<Geometry>(scene, dvec3(0));
}

inline TraceSettings finest() {
    TraceSettings settings;
    settings.tolerance_px = 1e-12;
    settings.pixel = 1;
    return settings;
}

/// Settings with the default tolerance of a render.
inline TraceSettings usual() {
    TraceSettings settings;
    settings.pixel = 4e-4;
    return settings;
}

inline TraceSettings fixed(Integrator integrator, double step) {
    TraceSettings settings = finest();
    settings.integrator = integrator;
    settings.step = step;
    settings.tolerance_px = 1e3;
    return settings;
}

inline RayState end_of(const TestAir& air, dvec3 origin, dvec3 direction, TraceSettings settings, double u) {
    settings.u_end = u;
    const BentHit result = trace(air.now, nullptr, origin, direction, settings);
    EXPECT_EQ(result.end, BentHit::End::Escaped);
    EXPECT_NEAR(result.at.u, u, 1e-11);
    return result.at;
}

inline double distance(const RayState& at, dvec3 x, dvec3 p) {
    return std::max(glm::length(at.x - x), glm::length(at.p - p));
}

inline SurfaceSpec road(double dropoff, double temperature = 305) {
    SurfaceSpec spec;
    spec.surface_temperature = temperature;
    spec.dropoff = dropoff;
    return spec;
}

inline OpticsSpec at_zero() {
    OpticsSpec optics;
    optics.ambient_temperature = 273;
    return optics;
}

inline BlobsSpec one_blob(dvec3 center, double sigma, double temperature = 1000) {
    BlobsSpec spec;
    spec.blobs = {{center, sigma, temperature}};
    return spec;
}

}  // namespace eikonal::reference
