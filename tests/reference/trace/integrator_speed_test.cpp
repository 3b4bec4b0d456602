/// The tracer's shortcuts must not cost accuracy: long strides between blobs and through lattices against the
/// finest tolerance, and first order's closed form against its integral.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "noise/blobs/blobs_spec.h"
#include "noise/medium/medium_spec.h"
#include "noise/medium/optics.h"
#include "noise/surface/surface_spec.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "reference/trace/bent_ray.h"

namespace eikonal::reference {
namespace {

/// Media at t = 0 before a wall 100 m away, seen through a long lens.
struct Shot {
    Air field;
    AirInstant now;
    Geometry wall;
    TraceSettings settings;

    explicit Shot(const std::vector<MediumSpec>& media)
        : field(media, {}, {.memory_limit = std::uint64_t{1} << 30}), now(field.at(0)), wall(scene(), dvec3(0)) {
        settings.pixel = 7e-5;
    }

    static Scene scene() {
        ObjectSpec plane;
        plane.origin = {0, 0, -100};
        plane.normal = {0, 0, 1};
        Scene scene;
        scene.objects = {plane};
        return scene;
    }
    static dvec3 direction(int i) {
        return glm::normalize(dvec3(0.02 * std::cos(2.4 * i), 0.02 * std::sin(2.4 * i), -1));
    }
    BentHit trace_one(int i) const { return trace(now, &wall, dvec3(0), direction(i), settings); }
    /// Largest distance between the ends of the same rays, traced with two settings [px].
    double off(const TraceSettings& one, const TraceSettings& other) {
        double worst = 0;
        for (int i = 0; i < 40; ++i) {
            settings = one;
            const BentHit a = trace_one(i);
            settings = other;
            const BentHit b = trace_one(i);
            EXPECT_TRUE(a.hit && b.hit);
            worst = std::max(worst, glm::length(a.at.x - b.at.x) / 100 / one.pixel);
        }
        return worst;
    }
};

/// 200 blobs of 10 to 20 cm along the ray.
BlobsSpec crowd(double temperature) {
    BlobsSpec spec;
    for (int i = 0; i < 200; ++i) {
        const auto spread = [i](double step) { return i * step - static_cast<int>(i * step); };
        spec.blobs.push_back({{4 * spread(0.618034) - 2, 3 * spread(0.754878) - 1.5, -5 - 90 * spread(0.569840)},
                              0.1 + 0.1 * spread(0.414214),
                              temperature});
    }
    return spec;
}

TEST(Strides, KeepTheToleranceAmongBlobs) {
    for (const double temperature : {310.0, 600.0, 1500.0}) {
        Shot shot({crowd(temperature)});
        TraceSettings finest = shot.settings;
        finest.tolerance_px = 1e-6;
        for (const double tolerance : {0.1, 0.01, 1e-4}) {
            TraceSettings usual = shot.settings;
            usual.tolerance_px = tolerance;
            EXPECT_LE(shot.off(usual, finest), tolerance) << temperature;
        }
    }
}

TEST(Strides, KeepTheToleranceInALattice) {
    TurbulenceSpec spec;
    spec.form = TurbulenceForm::Lattice;
    spec.lattice = {{32, 32, 32, 1}};
    spec.period = {{8, 8, 8, 1}};
    spec.alpha = 0;
    spec.inner_scale = 0.5;
    spec.outer_scale = 4;
    spec.cn2 = 1e-11;
    Shot shot({spec});
    TraceSettings finest = shot.settings;
    finest.tolerance_px = 1e-6;
    for (const double tolerance : {0.1, 0.01, 1e-3}) {
        TraceSettings usual = shot.settings;
        usual.tolerance_px = tolerance;
        EXPECT_LE(shot.off(usual, finest), tolerance);
    }
}

TEST(Strides, AreLongButPassNoBlobOver) {
    // One small blob far away, at the largest distance from the ray that still matters.
    const double sigma = 0.01;
    for (const double b : {0.0, 0.7, 1.5, 2.0, 2.5, 3.0, 3.5}) {
        BlobsSpec spec;
        spec.blobs = {{{b * sigma, 0, -60}, sigma, 1000}};
        Shot shot({spec});
        TraceSettings finest = shot.settings, usual = shot.settings;
        finest.step = 0.1 * sigma;
        finest.integrator = Integrator::Rk4;
        const BentHit hit = trace(shot.now, &shot.wall, dvec3(0), {0, 0, -1}, usual);
        const BentHit truth = trace(shot.now, &shot.wall, dvec3(0), {0, 0, -1}, finest);
        ASSERT_TRUE(hit.hit && truth.hit);
        EXPECT_LE(glm::length(hit.at.x - truth.at.x) / 100 / usual.pixel, usual.tolerance_px) << b;
        EXPECT_LE(hit.steps, 60);
    }
}

// The force of a surface has an endless tail above it. There the air must still count as straight.
TEST(Strides, AreOneBeyondALayerOfAnyMedia) {
    SurfaceSpec surface;
    surface.surface_temperature = 330;
    surface.dropoff = 0.02;
    BlobsSpec blobs;
    blobs.blobs = {{{0, 1, -10}, 0.1, 400}};
    const Air field({surface, blobs}, {}, {.memory_limit = std::uint64_t{1} << 30});
    const AirInstant now = field.at(0);
    TraceSettings settings;
    settings.pixel = 7e-5;
    for (const Integrator integrator : {Integrator::Adaptive, Integrator::FirstOrder}) {
        settings.integrator = integrator;
        const BentHit end = trace(now, nullptr, {0, 2, 0}, glm::normalize(dvec3(0, 1e-5, -1)), settings);
        EXPECT_EQ(end.end, BentHit::End::Escaped);
        EXPECT_LT(end.steps, 50);
    }
}

TEST(KnownOrigin, ChangesNoBit) {
    SurfaceSpec surface;
    surface.surface_temperature = 330;
    surface.dropoff = 0.05;
    ObjectSpec ground, sign;
    sign.shape = ObjectShape::Quad;
    sign.origin = {0, 0, -60};
    sign.normal = {0, 0, 1};
    sign.size = {2, 2};
    Scene scene;
    scene.objects = {ground, sign};
    const Geometry geometry(scene, dvec3(0));
    const Air field({surface}, {}, {.memory_limit = std::uint64_t{1} << 30});
    const AirInstant now = field.at(0);
    TraceSettings plain;
    plain.pixel = 7e-5;
    plain.lone = std::make_shared<LoneSurface>(surface, OpticsSpec{});
    TraceSettings known = plain;
    const dvec3 eye{0, 1.5, 0};
    known.start_at(now, eye);
    for (const Integrator integrator : {Integrator::Adaptive, Integrator::FirstOrder, Integrator::SecondOrder})
        for (int i = 0; i < 50; ++i) {
            plain.integrator = known.integrator = integrator;
            const dvec3 d = glm::normalize(dvec3(0.001 * (i % 7), -0.002 * i, -1));
            const BentHit a = trace(now, &geometry, eye, d, plain), b = trace(now, &geometry, eye, d, known);
            EXPECT_EQ(a.at.x, b.at.x);
            EXPECT_EQ(a.at.p, b.at.p);
            EXPECT_EQ(a.hit, b.hit);
            // Settings that were made for another origin must give the same result.
            const dvec3 beside = eye + dvec3(0.5, 0, 0);
            EXPECT_EQ(trace(now, &geometry, beside, d, plain).at.x, trace(now, &geometry, beside, d, known).at.x);
        }
}

TEST(ClosedForm, OfBlobsIsFirstOrdersIntegral) {
    Shot shot({crowd(600)});
    TraceSettings closed = shot.settings, integral = shot.settings;
    closed.integrator = integral.integrator = Integrator::FirstOrder;
    integral.step = 0.01;
    EXPECT_LE(shot.off(closed, integral), closed.tolerance_px);
    shot.settings = closed;
    EXPECT_EQ(shot.trace_one(0).steps, 1);
    // The difference shrinks with the tolerance.
    closed.tolerance_px = 1e-3;
    EXPECT_LE(shot.off(closed, integral), closed.tolerance_px);
    // Where the closed form leaves out too much, first order integrates.
    closed.tolerance_px = 1e-6;
    shot.settings = closed;
    EXPECT_GT(shot.trace_one(0).steps, 1);
}

}  // namespace
}  // namespace eikonal::reference
