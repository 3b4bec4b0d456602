/// Mirages against an integration of the ray equation in long double that shares no code with them.
#include "warp/displace/media/surface/mirage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "noise/base/error.h"
#include "noise/medium/optics.h"
#include "noise/surface/surface_spec.h"
#include "tests/warp/displace/media/surface/mirage_scenes.h"

namespace eikonal {
namespace {

using Real = long double;
using Vec = glm::vec<3, Real>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Eqs. 3 and 4 and the ray equation, written anew.
struct SurfaceAir {
    Real d0, surface, ambient = 293.15L, n_ambient, excess;  ///< excess: exaggerated n_a - 1
    bool paper;

    SurfaceAir(const SurfaceSpec& spec, double exaggeration, RayEquation equation)
        : d0(spec.dropoff),
          surface(spec.surface_temperature),
          n_ambient(1 + static_cast<Real>(index_law({}).ambient())),
          excess(static_cast<Real>(exaggeration) * index_law({}).ambient()),
          paper(equation == RayEquation::Paper) {}

    Real temperature(Real h) const { return ambient + (surface - ambient) * std::exp(-h / d0); }
    Real n(Real h) const { return n_ambient + excess * (ambient / temperature(h) - 1); }
    Real force(Real h) const {
        const Real T = temperature(h);
        const Real slope = excess * ambient / (T * T) * (surface - ambient) * std::exp(-h / d0) / d0;
        return paper ? slope / 2 : n(h) * slope;
    }
    Real speed(Real h) const { return paper ? std::sqrt(n(h)) : n(h); }
};

/// A ray in space over a plane through the origin: x, p = dx/du.
struct Path {
    Vec x, p;
};

/// One step of Runge, Kutta and Nyström.
Path step(const SurfaceAir& air, Vec normal, const Path& at, Real du) {
    const auto force = [&](Vec x) { return air.force(glm::dot(x, normal)) * normal; };
    const Vec k1 = force(at.x), k2 = force(at.x + du / 2 * at.p);
    const Vec k3 = force(at.x + du / 2 * at.p + du * du / 4 * k1), k4 = force(at.x + du * at.p + du * du / 2 * k2);
    return {at.x + du * at.p + du * du / 6 * (k1 + k2 + k3), at.p + du / 6 * (k1 + Real(2) * (k2 + k3) + k4)};
}

/// Follows a ray until `ahead`, which grows along it, is `goal`, or the ray meets the plane.
template <class Ahead>
Path follow(const SurfaceAir& air, Vec normal, Path at, Real goal, const Ahead& ahead) {
    for (;;) {
        const Real h = glm::dot(at.x, normal), sink = std::abs(glm::dot(at.p, normal));
        // a part of the layer's thickness or curvature; far above it, most of the way down to it or all the way
        const Real rate = std::sqrt(2 * air.excess) + sink;
        Real du = std::max(Real(0.02) * air.d0 / rate, Real(0.1) * (h - 30 * air.d0) / std::max(sink, Real(1e-4)));
        const auto end = [&](const Path& q) { return ahead(q) >= goal || glm::dot(q.x, normal) < 0; };
        if (const Path next = step(air, normal, at, du); !end(next)) {
            at = next;
            continue;
        }
        Real low = 0, high = du;
        for (int i = 0; i < 64; ++i) {
            const Real middle = (low + high) / 2;
            (end(step(air, normal, at, middle)) ? high : low) = middle;
        }
        return step(air, normal, at, low);
    }
}

TEST(Mirage, RaysAgreeWithIntegration) {
    const Vec up{0, 1, 0};
    for (const RayEquation equation : {RayEquation::Physical, RayEquation::Paper})
        for (const double T : {250.0, 305.0, 400.0})
            for (const double exaggeration : {1.0, 50.0})
                for (const double d0 : {1e-3, 0.03, 10.0})
                    for (const double H : {0.05, 1.5})
                        for (const double w : {-0.3, -0.02, -0.0075, -0.004, 0.0, 0.01}) {
                            const SurfaceSpec spec = surface(T, d0);
                            const SurfaceOptics optics(spec, index_law({}), exaggeration, equation);
                            const SurfaceRay ray(optics, H, w);
                            const SurfaceAir air(spec, exaggeration, equation);
                            Path path{{0, H, 0}, air.speed(H) * Vec{std::sqrt(1 - Real(w) * Real(w)), w, 0}};
                            SCOPED_TRACE(testing::Message() << "T " << T << " exaggeration " << exaggeration << " d0 "
                                                            << d0 << " H " << H << " w " << w);
                            for (Real way = 0.01L; way < 3000; way *= 2.3L) {
                                const Real along = way * std::sqrt(1 - Real(w) * Real(w));
                                path = follow(air, up, path, along, [](const Path& q) { return q.x.x; });
                                if (path.x.x < along * (1 - 1e-12L)) {
                                    const Real hit = path.x.x * way / along;
                                    EXPECT_NEAR(ray.hit() / static_cast<double>(hit), 1, 1e-8);
                                    break;
                                }
                                const auto expected = static_cast<double>(path.x.y - (Real(H) + Real(w) * way));
                                const auto at = static_cast<double>(way);
                                EXPECT_GT(ray.hit(), at);
                                EXPECT_NEAR(ray.rise(at) / at, expected / at, kSurfaceRayError) << " way " << at;
                            }
                        }
}

/// A rolled camera that looks down upon a tilted plane: the whole way to the pixel, to kMirageError.
TEST(Mirage, ImageAgreesWithIntegration) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0, 1);
    double worst = 0;
    int moved = 0;
    for (int trial = 0; trial < 400; ++trial) {
        SurfaceSpec spec = surface(250 + 150 * uniform(random), std::pow(10, -3 + 4 * uniform(random)));
        const double tilt = 0.3 * (uniform(random) - 0.5);
        spec.normal = glm::normalize(dvec3(tilt, 1, 0.2 * tilt));
        const double exaggeration = trial % 3 ? 1 : 1 + 49 * uniform(random);
        const RayEquation equation = trial % 4 ? RayEquation::Physical : RayEquation::Paper;
        Camera camera = level(0, 2000 + 18000 * uniform(random), 1920, 1080);
        camera.pixel_aspect = trial % 2 ? 1 : 2;
        camera.position = (0.05 + 2 * uniform(random)) * spec.normal;
        // looks near the plane's horizon
        const auto axes =
            view_axes({0, 0, 0}, {0.1 * uniform(random), 0.02 * (uniform(random) - 0.8) - 0.2 * tilt * -1, -1},
                      {0.5 * (uniform(random) - 0.5), 1, 0});
        camera.right = (*axes)[0];
        camera.up = (*axes)[1];
        camera.forward = (*axes)[2];
        const Mirage mirage = mirage_of(spec, camera, 2000, exaggeration, equation);
        const SurfaceAir air(spec, exaggeration, equation);
        for (int ray = 0; ray < 3; ++ray) {
            const int x = static_cast<int>(1920 * uniform(random)), y = static_cast<int>(1080 * uniform(random));
            const double z = std::pow(10, 3.3 * uniform(random));
            const StraightRay straight = straight_ray(camera, x + 0.5, y + 0.5);
            const Vec start = camera.position, n = spec.normal, forward = camera.forward;
            const Path end =
                follow(air, n, {start, air.speed(glm::dot(start, n)) * glm::normalize(Vec(straight.direction))}, z,
                       [&](const Path& q) { return glm::dot(q.x - start, forward); });
            const dvec3 seen = end.x - start;
            const dvec2 pixel = camera.pixel(dvec2{glm::dot(seen, camera.right), glm::dot(seen, camera.up)} /
                                             glm::dot(seen, camera.forward));
            Mirage::PixelRay bent;
            const Shift d = mirage.ray(x, y, bent) ? mirage.shift(bent, z) : Shift{};
            moved += d.y != 0;
            worst = std::max({worst, std::abs(pixel.x - x - 0.5 - static_cast<double>(d.x)),
                              std::abs(pixel.y - y - 0.5 - static_cast<double>(d.y))});
        }
    }
    EXPECT_GT(moved, 400);
    EXPECT_LT(worst, kMirageError);
}

/// The first row that shows the background mirrored is at the critical angle √(2B) (PHYSICS.md#heated-surface).
TEST(Mirage, CriticalAngle) {
    for (const double T : {300.0, 320.0, 400.0}) {
        const Camera camera = level(1.5, 1e6, 640, 100000);
        const SurfaceSpec spec = surface(T, 0.01);
        const Mirage mirage = mirage_of(spec, camera);
        const double critical = std::sqrt(-2 * index_law({}).above_ambient(T));
        int last = 0;
        for (int y = 50000; y < 100000; ++y) {
            Mirage::PixelRay ray;
            if (mirage.ray(320, y, ray) && mirage.shift(ray, 5000).y < -0.5 * (y - 50000)) last = y;
        }
        EXPECT_NEAR((last - 50000) / camera.f_px, critical, 1e-3 * critical);
    }
}

/// Tiny dropoff: the plane mirrors. A pixel v below the horizon shows, at distance D, what the mirrored camera sees.
TEST(Mirage, SmallDropoffIsAMirror) {
    const double H = 1.5, f = 10000, D = 2000;
    const Mirage mirage = mirage_of(surface(330, 1e-5), level(H, f));
    for (int y = 200; y < 250; ++y) {
        Mirage::PixelRay ray;
        ASSERT_TRUE(mirage.ray(320, y, ray));
        const double v = y + 0.5 - 180, source = v + static_cast<double>(mirage.shift(ray, D).y);
        EXPECT_NEAR(source, 2 * H * f / D - v, 0.02);
        EXPECT_EQ(ray.end, kInfinity);
    }
}

/// Large dropoff: near parabolas, δ = n'(H) σ²/2.
TEST(Mirage, LargeDropoffIsParabolic) {
    const double H = 1.5, d0 = 500, n_slope = -index_law({}).above_ambient(320) * (293.15 / 320) / d0;
    const SurfaceSpec spec = surface(320, d0);
    const SurfaceOptics optics(spec, index_law({}), 1, RayEquation::Physical);
    for (const double w : {-0.001, 0.0, 0.002})
        for (const double way : {10.0, 100.0, 500.0})
            EXPECT_NEAR(SurfaceRay(optics, H, w).rise(way) / (n_slope * way * way / 2), 1, 0.01);
}

/// Cold surfaces lift what lies behind, and the ground itself.
TEST(Mirage, ColdSurfaceLiftsImages) {
    const Mirage mirage = mirage_of(surface(270, 1), level(1.5, 5000));
    for (const int y : {150, 175, 179, 185, 220}) {
        Mirage::PixelRay ray;
        ASSERT_TRUE(mirage.ray(320, y, ray));
        EXPECT_GT(mirage.shift(ray, 1000).y, 0) << y;
    }
    Mirage::PixelRay above;
    ASSERT_TRUE(mirage.ray(320, 178, above));
    EXPECT_LT(above.end, 5000) << "a ray that would miss the ground is bent down to it";
}

TEST(Mirage, NothingWithoutStrength) {
    const Camera camera = level(1.5, 5000);
    const PixelWindow window{0, 0, 640, 360};
    for (const Mirage& mirage :
         {mirage_of(surface(293.15, 0.01), camera), mirage_of(surface(320, 0.01), camera, 1000, 0)}) {
        EXPECT_FALSE(mirage.touches(window));
        EXPECT_EQ(mirage.largest_shift(window), 0);
        Mirage::PixelRay ray;
        for (int y = 0; y < 360; ++y) EXPECT_FALSE(mirage.ray(100, y, ray));
    }
}

TEST(Mirage, RefusesWhatItCannotDo) {
    SurfaceSpec spec = surface(320, 0.01);
    spec.origin.y = 2;
    try {
        mirage_of(spec, level(1.5, 5000));
        FAIL();
    } catch (const UserError& e) {
        EXPECT_NE(std::string(e.what()).find("medium.3.origin"), std::string::npos) << e.what();
    }
    EXPECT_THROW(mirage_of(surface(400, 0.01), level(1.5, 5000), 1000, 1e5), UserError);
    SurfaceSpec wall = surface(320, 0.01);
    wall.origin = {-5, 0, 0};
    wall.normal = {1, 0, 0};
    const Camera camera = level(1.5, 5000);
    const std::array names{std::string("medium.0"), std::string("medium.1")};
    const std::vector road_and_wall{mirage_of(surface(320, 0.01), camera), mirage_of(wall, camera)};
    EXPECT_NO_THROW(check_surfaces(road_and_wall, names));
    const std::vector twice{mirage_of(surface(320, 0.01), camera), mirage_of(surface(300, 0.2), camera)};
    EXPECT_THROW(check_surfaces(twice, names), UserError);
}

/// Finite for every finite scene; the bound over a window holds; windows that are left out do not move.
TEST(Mirage, FiniteAndBounded) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(0, 1);
    const auto power = [&](double low, double high) { return std::pow(10, low + (high - low) * uniform(random)); };
    for (int trial = 0; trial < 600; ++trial) {
        const bool wild = trial % 2;
        SurfaceSpec spec =
            wild ? surface(power(-3, 6), power(-12, 12)) : surface(250 + 150 * uniform(random), power(-3, 1));
        Camera camera = level(wild ? power(-12, 6) : power(-2, 1.5), wild ? power(0, 7) : power(3, 4.3));
        if (trial % 3 == 0) {
            const auto axes = view_axes({0, 0, 0}, {uniform(random) - 0.5, uniform(random) - 0.7, -1}, {0.3, 1, 0});
            camera.right = (*axes)[0];
            camera.up = (*axes)[1];
            camera.forward = (*axes)[2];
        }
        if (trial % 5 == 0) {
            camera.projection = Projection::Orthographic;
            camera.f_px = power(1, 3);
        }
        const double farthest = wild ? power(-3, 9) : 3000;
        std::optional<Mirage> mirage;
        try {
            mirage.emplace(mirage_of(spec, camera, farthest, wild ? power(-3, 3) : 1));
        } catch (const UserError&) {
            continue;
        }
        const PixelWindow window{64 * (trial % 10), 40 * (trial % 9), 64, 40};
        const bool touched = mirage->touches(window);
        const double bound = mirage->largest_shift(window);
        EXPECT_TRUE(std::isfinite(bound));
        for (int i = 0; i < 60; ++i) {
            Mirage::PixelRay ray;
            if (!mirage->ray(window.x0 + static_cast<int>(64 * uniform(random)),
                             window.y0 + static_cast<int>(40 * uniform(random)), ray))
                continue;
            const double z = i % 3 ? farthest * uniform(random) : wild ? power(-30, 30) : farthest;
            const Shift d = mirage->shift(ray, z);
            ASSERT_TRUE(std::isfinite(d.x) && std::isfinite(d.y))
                << trial << " T " << spec.surface_temperature << " d0 " << spec.dropoff << " z " << z;
            if (wild || z > farthest) continue;
            const double size = std::max(std::abs(d.x), std::abs(d.y));
            EXPECT_LE(size, bound + kMirageThreshold) << trial;
            if (!touched) {
                EXPECT_LE(size, kMirageThreshold) << trial;
            }
        }
    }
}

}  // namespace
}  // namespace eikonal
