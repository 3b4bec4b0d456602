// Displacement at the ends of every range (noise/README.md, "Extremes"). It agrees with quadrature of Eq. 7 in long
// double, or with the same scene at another scale, or it is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <string>

#include "noise/base/error.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/medium/medium_spec.h"
#include "noise/medium/refractivity.h"
#include "noise/surface/surface_spec.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "tests/noise/trigonometric_sum.h"
#include "tests/warp/displace/displacement_scenes.h"
#include "warp/displace/models/first_order.h"
#include "warp/displace/models/lattice_tables.h"
#include "warp/displace/models/second_order.h"

namespace eikonal {
namespace {

using Force = std::function<dvec3(const dvec3&)>;

/// Eq. 7 by Gauss' rule of two points on even steps between two axial depths, of the ray of pixel (x, y), for an
/// object at depth D, and its projection to first order.
dvec2 quadrature(const Force& force, const Camera& camera, int x, int y, double D, double from, double to, int steps) {
    const dvec2 s = camera.slope(x + 0.5, y + 0.5);
    const bool perspective = camera.projection == Projection::Perspective;
    const dvec3 across = s.x * camera.right + s.y * camera.up;
    const dvec3 origin = camera.position + (perspective ? dvec3(0) : across);
    const dvec3 direction = camera.forward + (perspective ? across : dvec3(0));
    glm::tvec3<long double> sum{0, 0, 0};
    const double h = (to - from) / steps;
    for (int i = 0; i < steps; ++i)
        for (const double g : {0.21132486540518711775, 0.78867513459481288225}) {
            const double w = from + (i + g) * h;
            sum += glm::tvec3<long double>((D - w) * 0.5 * h * force(origin + w * direction));
        }
    const dvec3 x1 = glm::dot(direction, direction) * dvec3(sum);
    const double along = perspective ? glm::dot(x1, camera.forward) : 0, scale = perspective ? 1 / D : 1;
    return scale * camera.f_px *
           dvec2(glm::dot(x1, camera.right) - s.x * along,
                 -camera.pixel_aspect * (glm::dot(x1, camera.up) - s.y * along));
}

Force force_of(const BlobSpec& blob, const IndexLaw& law) {
    return [blob, n = law.above_ambient(blob.temperature)](const dvec3& x) {
        const dvec3 r = (x - blob.center) / blob.sigma;
        return -2 * n / blob.sigma * std::exp(-glm::dot(r, r)) * r;
    };
}

Scene from_origin() {
    Scene scene;
    scene.camera.position = {0, 0, 0};
    scene.camera.look_at = {0, 0, -1};
    return scene;
}

double degrees(double slope) {
    return 360 / M_PI * std::atan(slope);
}

// One blob beside the axis, where it bends most, halfway to the object. The closed form in float and bent rays in
// double are compared with quadrature. The picture is the one pixel on the axis, so that any focal length in pixels is
// possible.
TEST(Extremes, ABlobOfAnySizeAtAnyDistanceForAnyLens) {
    int seen = 0;
    for (const double sigma : {1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9})
        for (const double D : {1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9})
            for (const double f_px : {1.0, 1e3, 1e7})
                for (const double T : {1.0, 20.0, 1e5}) {
                    const BlobSpec blob{{sigma * std::sqrt(0.5), 0, -0.5 * D}, sigma, T};
                    Scene scene = from_origin();
                    scene.media = {BlobsSpec{1, {blob}, {}, {}}};
                    DisplacerSettings settings = sized(1, 1, D);
                    settings.fov = degrees(0.5 / f_px);
                    const double from = std::max(0.0, 0.5 * D - 7 * sigma), to = std::min(D, 0.5 * D + 7 * sigma);
                    const auto shift = [&] {
                        const Displacer displacer(scene, settings);
                        const Map map = map_of(displacer, 1, {0, 0, 1, 1}, D);
                        const dvec2 exact = quadrature(force_of(blob, index_law(scene.optics)), displacer.camera(1), 0,
                                                       0, D, from, to, 2000);
                        return std::array{dvec2(map[0], map[1]), exact};
                    };
                    const auto [d, exact] = shift();
                    EXPECT_NEAR(d.x, exact.x, 1e-4 * std::abs(exact.x) + kNegligibleShift)
                        << sigma << ' ' << D << ' ' << f_px << ' ' << T;
                    EXPECT_EQ(d.y, 0);
                    if (std::abs(exact.x) < 0.05) continue;
                    ++seen;
                    // Bends must be gentle, and a ray's place must be exact to a part of the blob.
                    if (T < 1e5 || sigma < 1e-7 * D) continue;
                    settings.model = Model::SecondOrder;
                    const dvec2 bent = shift()[0];
                    EXPECT_NEAR(bent.x, exact.x, 4 * kSecondOrderError * std::abs(exact.x))
                        << "second-order " << sigma << ' ' << D << ' ' << f_px;
                }
    EXPECT_GT(seen, 60) << "most are too weak to tell anything";
}

// ---- no scale of their own ----

/// A scene of one medium; every length is multiplied by s.
struct Scaled {
    const char* name;
    std::function<MediumSpec(double s)> medium;
    std::optional<Model> model = {};
    bool orthographic = false;
};

Map map_at(const Scaled& c, double s, double part) {
    constexpr double kFar = 128;
    Scene scene = from_origin();
    scene.camera.position = {0, 1.5 * s, 0};
    scene.camera.look_at = {0, 1.5 * s, -s};
    scene.media = {c.medium(s)};
    if (c.orthographic) {
        scene.camera.projection = Projection::Orthographic;
        scene.camera.width = 8 * s;
    } else {
        scene.camera.horizontal_fov = 4;
    }
    DisplacerSettings settings = sized(12, 9, kFar * s);
    settings.model = c.model;
    const double D = part * kFar * s;
    return map_of(Displacer(scene, settings), 13, {0, 0, 12, 9}, D);
}

// A scene with `far` at 128 m is scaled to 2e-6 m and to 1e9 m. All lengths are multiplied by a power of two, Cn² by
// length^(-2/3), and rates are kept. Code that contains an absolute length fails.
TEST(Extremes, DistancesFromAMicrometreToAMillionKilometres) {
    const auto turbulence = [](TurbulenceForm form) {
        return [form](double s) {
            TurbulenceSpec spec;
            spec.form = form;
            spec.cn2 = 1e-11 * std::pow(s, -2.0 / 3);
            spec.outer_scale = 8 * s;
            spec.inner_scale = 2 * s;
            spec.alpha = 0.3 * s * s;
            spec.velocity = {0.25 * s, 0.5 * s, 0};
            if (form == TurbulenceForm::Lattice) {
                spec.lattice = {{16, 16, 16, 4}};
                spec.period = {{16 * s, 16 * s, 128 * s, 4.0}};
            }
            return spec;
        };
    };
    const auto blobs = [](double s) {
        BlobsSpec spec;
        spec.blobs = {{{20 * s, 1.5 * s, -50 * s}, 40 * s, 600}, {{-10 * s, 8 * s, -80 * s}, 60 * s, 350}};
        return spec;
    };
    const auto surface = [](double s) {
        SurfaceSpec spec;
        spec.dropoff = 0.02 * s;
        spec.surface_temperature = 400;
        return spec;
    };
    const auto screens = turbulence(TurbulenceForm::Screens), lattice = turbulence(TurbulenceForm::Lattice),
               noise = turbulence(TurbulenceForm::GradientNoise);
    const Scaled cases[] = {{"screens", screens},
                            {"screens, orthographic", screens, {}, true},
                            {"lattice", lattice},
                            {"table", lattice, Model::Table},
                            {"tables", lattice, Model::Tables},
                            {"spectral", lattice, Model::Spectral, true},
                            {"noise", noise},
                            {"blobs", blobs},
                            {"blobs, orthographic", blobs, {}, true},
                            {"surface", surface},
                            {"lattice, second-order", lattice, Model::SecondOrder},
                            {"screens, second-order", screens, Model::SecondOrder},
                            {"noise, second-order", noise, Model::SecondOrder},
                            {"blobs, second-order", blobs, Model::SecondOrder}};
    for (const Scaled& c : cases)
        for (const double part : {1.0, 0.3}) {
            const Map unit = map_at(c, 1, part);
            double largest = 0;
            for (const float v : unit) largest = std::max(largest, std::abs(double{v}));
            EXPECT_GT(part == 1 ? largest : 1, 5e-4) << c.name;
            for (const double s : {0x1p-25, 0x1p-10, 0x1p10, 0x1p23}) {
                const Map map = map_at(c, s, part);
                double worst = 0;
                for (std::size_t i = 0; i < map.size(); ++i)
                    worst = std::max(worst, std::abs(double{map[i]} - unit[i]));
                EXPECT_LE(worst, 2e-4 * largest) << c.name << ", scale " << s << ", part " << part;
            }
        }
}

// ---- wide views, long paths ----

// The ray of the corner is 140 times as long as that of the axis, and crosses more than ten periods.
TEST(Extremes, AViewOf179DegreesIsTheQuadrature) {
    TurbulenceSpec spec = lattice_spec();
    spec.lattice = {{8, 8, 8, 1}};
    Scene scene = scene_with(spec);
    const double D = 0.2;
    DisplacerSettings settings = small(D);
    settings.fov = 179;
    const Displacer displacer(scene, settings);
    const Camera camera = displacer.camera(1);
    const LatticeField field(spec, choose_lattice(spec));
    const TrigonometricSum sum(field.spectrum_at(0), field.geometry());
    const Map map = map_of(displacer, 1, kSmall, D);
    double error = 0, power = 0;
    for (const auto& [x, y] : {std::array{0, 0}, {23, 17}, {23, 0}, {0, 9}, {12, 0}, {12, 9}}) {
        const dvec2 exact =
            quadrature([&](const dvec3& p) { return sum.sample(p).gradient; }, camera, x, y, D, 0, D, 600);
        const float* d = &map[2 * static_cast<std::size_t>(y * 24 + x)];
        error += glm::dot(exact - dvec2(d[0], d[1]), exact - dvec2(d[0], d[1]));
        power += glm::dot(exact, exact);
    }
    EXPECT_LT(std::sqrt(error / power), kFirstOrderError);
    // a blob on the corner's ray
    Scene hot = from_origin();
    DisplacerSettings wide = small(10);
    wide.fov = 179;
    wide.negligible = kNegligibleShift;
    const dvec2 s = camera.slope(0.5, 0.5);
    const BlobSpec blob{{5 * s.x + 0.7, 5 * s.y, -5}, 1, 1};
    hot.media = {BlobsSpec{1, {blob}, {}, {}}};
    const Displacer hot_view(hot, wide);
    const Map moved = map_of(hot_view, 1, {0, 0, 1, 1}, 10);
    const dvec2 exact = quadrature(force_of(blob, index_law(hot.optics)), hot_view.camera(1), 0, 0, 10, 0, 10, 20000);
    EXPECT_GT(glm::length(exact), 0.1);
    EXPECT_LT(glm::distance(exact, dvec2(moved[0], moved[1])), 1e-3 * glm::length(exact) + kNegligibleShift);
}

TEST(Extremes, APathOfTwentyPeriodsIsTheQuadratureAndWarnedOf) {
    TurbulenceSpec spec = lattice_spec();
    spec.lattice = {{8, 8, 8, 1}};
    const LatticeField field(spec, choose_lattice(spec));
    const TrigonometricSum sum(field.spectrum_at(0), field.geometry());
    constexpr double D = 40;
    for (const auto& [model, allowed] :
         {std::pair{Model::Spectral, kPathTableError}, {Model::FirstOrder, kFirstOrderError}}) {
        const Displacer displacer(orthographic(spec, {0, 0, -1}, {0, 1, 0}), small(D, model));
        ASSERT_EQ(displacer.warnings().size(), 1 + (displacer.focusing_variance(D) > 0.5));
        EXPECT_NE(displacer.warnings().back().find("longer than the lattice period"), std::string::npos);
        const Map map = map_of(displacer, 1, kSmall, D);
        double error = 0, power = 0;
        for (int i = 0; i < 12; ++i) {
            const int x = i * 7 % 24, y = i * 5 % 18;
            const dvec2 exact = quadrature([&](const dvec3& p) { return sum.sample(p).gradient; }, displacer.camera(1),
                                           x, y, D, 0, D, 1000);
            const float* d = &map[2 * static_cast<std::size_t>(y * 24 + x)];
            error += glm::dot(exact - dvec2(d[0], d[1]), exact - dvec2(d[0], d[1]));
            power += glm::dot(exact, exact);
        }
        EXPECT_LT(std::sqrt(error / power), allowed) << name_of(model);
    }
}

// ---- what is left out, what is refused ----

// A medium that is left out because it is weak would have moved no pixel by more than the limit, however wide the view.
TEST(Extremes, WhatIsLeftOutOfAWideViewMovesNothing) {
    for (const auto form : {TurbulenceForm::Screens, TurbulenceForm::Lattice, TurbulenceForm::GradientNoise})
        for (const double fov : {20.0, 150.0, 178.0})
            for (const double cn2 : {5e-324, 1e-18, 1e-16, 1e-14, 1e-12, 1e-10}) {
                TurbulenceSpec spec = lattice_spec();
                spec.form = form;
                spec.cn2 = cn2;
                spec.inner_scale = 0.3;
                if (form != TurbulenceForm::Lattice) spec.lattice.reset(), spec.period.reset();
                const Scene scene = scene_with(spec);
                DisplacerSettings settings = small(2);
                settings.fov = fov;
                settings.negligible = kNegligibleShift;
                if (!Displacer(scene, settings).models().empty()) continue;
                settings.negligible = 0;
                for (const float v : map_of(Displacer(scene, settings), 1, kSmall, 2))
                    ASSERT_LE(std::abs(v), kNegligibleShift) << static_cast<int>(form) << ' ' << fov << ' ' << cn2;
            }
}

TEST(Extremes, WhatNoMapHoldsIsRefusedNotCut) {
    TurbulenceSpec spec = lattice_spec();
    spec.cn2 = 1e12;
    for (const auto form : {TurbulenceForm::Screens, TurbulenceForm::Lattice, TurbulenceForm::GradientNoise}) {
        spec.form = form;
        if (form == TurbulenceForm::Screens)
            spec.lattice.reset(), spec.period.reset();
        else
            spec.lattice = lattice_spec().lattice, spec.period = lattice_spec().period;
        Scene scene = scene_with(spec);
        scene.optics.exaggeration = 1e6;
        try {
            const Displacer displacer(scene, small(1.8));
            FAIL() << "not refused";
        } catch (const UserError& error) {
            const std::string message = error.what();
            EXPECT_TRUE(message.starts_with("medium.0: ")) << message;
            EXPECT_NE(message.find("1e+06 px"), std::string::npos) << message;
            EXPECT_NE(message.find("cn2"), std::string::npos) << message;
        }
    }
    const Displacer gentle(scene_with(lattice_spec()), small(1.8));
    EXPECT_NO_THROW(map_of(gentle, 1, kSmall, 1.8, 1e3));
    for (const double gain : {1e15, 1e300}) EXPECT_THROW(map_of(gentle, 1, kSmall, 1.8, gain), FrameError) << gain;
}

}  // namespace
}  // namespace eikonal
