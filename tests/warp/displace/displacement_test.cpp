// Displacement maps of every model, compared with quadrature, with each other and with the expected variances.
// Length: the models are compared with each other, so their tests are in one file.
#include "warp/displace/displacer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>

#include "noise/base/error.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/turbulence/lattice/lattice.h"
#include "noise/turbulence/lattice/path_tables.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "tests/noise/trigonometric_sum.h"
#include "tests/warp/displace/displacement_scenes.h"
#include "warp/displace/grid/ray_frame.h"
#include "warp/displace/models/first_order.h"
#include "warp/displace/models/lattice_tables.h"

namespace eikonal {
namespace {

// ---- lattices ----

/// Eq. 7 by direct quadrature along the trigonometric sum: d of the ray of pixel (x, y) for an object at depth D.
dvec2 quadrature(const TrigonometricSum& field, const Camera& camera, int x, int y, double D) {
    const StraightRay ray = straight_ray(camera, x + 0.5, y + 0.5);
    constexpr int kSteps = 60;
    constexpr double kGauss = 0.21132486540518711775;
    dvec3 sum{0, 0, 0};
    for (int i = 0; i < kSteps; ++i)
        for (const double g : {kGauss, 1 - kGauss}) {
            const double w = (i + g) * D / kSteps;
            sum += (D - w) * 0.5 * D / kSteps * field.sample(ray.at(w)).gradient;
        }
    const dvec2 X = image_shift(camera, ray, ray.length * ray.length * sum);
    return camera.projection == Projection::Perspective ? X / D : X;
}

struct Difference {
    double error = 0, power = 0;
    void add(const dvec2& expected, const float* uv) {
        error += glm::dot(expected - dvec2(uv[0], uv[1]), expected - dvec2(uv[0], uv[1]));
        power += glm::dot(expected, expected);
    }
    double relative() const { return std::sqrt(error / power); }
};

TrigonometricSum trigonometric(const TurbulenceSpec& spec) {
    const LatticeField field(spec, choose_lattice(spec));
    return {field.spectrum_at(0), field.geometry()};
}

// Pixels lie between lattice nodes. With steps of 1/60 of the path the error of Gauss' rule is below 1e-6.
TEST(Displacement, SpectralIsTheQuadratureOfItsLattice) {
    TurbulenceSpec spec = lattice_spec();
    spec.lattice = {{12, 12, 12, 1}};  // term by term, at each of 46080 points
    const TrigonometricSum field = trigonometric(spec);
    const double s = std::sqrt(0.5);
    const std::pair<dvec3, dvec3> views[] = {{{0, 0, -1}, {0, 1, 0}}, {{0, 0, 1}, {s, s, 0}},
                                             {{1, 0, 0}, {0, 1, 0}},  {{-1, 0, 0}, {0, 0.6, 0.8}},
                                             {{0, 1, 0}, {0, 0, 1}},  {{0, -1, 0}, {1, 0, 0}}};
    for (const auto& [forward, up] : views) {
        const Displacer displacer(orthographic(spec, forward, up), small(1.9));
        ASSERT_EQ(displacer.models().front(), "spectral");
        const Camera camera = displacer.camera(1);
        for (const double D : {0.05, 0.8, 1.9}) {
            const Map map = map_of(displacer, 1, kSmall, D);
            Difference d;
            for (int i = 0; i < 16; ++i) {
                const int x = i * 7 % 24, y = i * 5 % 18;
                d.add(quadrature(field, camera, x, y, D), &map[2 * static_cast<std::size_t>(y * 24 + x)]);
            }
            EXPECT_LT(d.relative(), kPathTableError) << forward.x << forward.y << forward.z << ' ' << D;
        }
        // A depth plane with depths between those of the grid.
        std::vector<float> metres;
        for (std::size_t i = 0; i < kSmall.area(); ++i)
            metres.push_back(0.4f + 1.4f * static_cast<float>(i * 37 % 101) / 101);
        const DepthPlane plane(kSmall, metres);
        const Map map = map_of(displacer, 1, kSmall, plane, DepthMeeting::Own);
        Difference d;
        for (int i = 0; i < 16; ++i) {
            const int x = i * 7 % 24, y = i * 5 % 18;
            d.add(quadrature(field, camera, x, y, plane.at(x, y)), &map[2 * static_cast<std::size_t>(y * 24 + x)]);
        }
        EXPECT_LT(d.relative(), 2e-4) << "with depth";
    }
}

TEST(Displacement, FirstOrderIsTheQuadratureInPerspectiveAndTurned) {
    const TurbulenceSpec spec = lattice_spec();
    const TrigonometricSum field = trigonometric(spec);
    for (const double pan : {0.0, 0.4}) {
        Scene scene = scene_with(spec);
        scene.camera.look_at = scene.camera.position + dvec3(std::sin(pan), 0.3 * pan, -std::cos(pan));
        scene.camera.horizontal_fov = 50;
        DisplacerSettings settings = small(1.8);
        settings.pixel_aspect = 1.5;
        const Displacer displacer(scene, settings);
        ASSERT_EQ(displacer.models().front(), "first-order");
        const Camera camera = displacer.camera(1);
        for (const double D : {0.7, 1.8}) {
            const Map map = map_of(displacer, 1, kSmall, D);
            Difference d;
            for (int i = 0; i < 40; ++i) {
                const int x = i * 7 % 24, y = i * 5 % 18;
                d.add(quadrature(field, camera, x, y, D), &map[2 * static_cast<std::size_t>(y * 24 + x)]);
            }
            EXPECT_LT(d.relative(), kFirstOrderError) << pan << ' ' << D;
        }
    }
}

TEST(Displacement, FirstOrderAgreesWithSpectral) {
    const Scene scene = orthographic(lattice_spec(), {0, 0, -1}, {0, 1, 0});
    const Displacer spectral(scene, small(1.9)), first(scene, small(1.9, Model::FirstOrder));
    const Map a = map_of(spectral, 1, kSmall, 1.9), b = map_of(first, 1, kSmall, 1.9);
    EXPECT_LT(difference(a, b), kFirstOrderError * rms(a));
}

// Power up to Nyquist. The Nyquist modes of a lattice of even size bend light in neither model.
TEST(Displacement, FirstOrderAgreesWithSpectralOnThePapersSpectrum) {
    TurbulenceSpec spec = lattice_spec();
    spec.spectrum = SpectrumKind::Paper;
    spec.strength = 6e-6;
    spec.period = {{20.0, 20.0, 20.0, 8.0}};
    for (const int size : {31, 32}) {
        spec.lattice = {{size, size, size, 1}};
        Scene scene = orthographic(spec, {0, 0, -1}, {0, 1, 0});
        scene.camera.width = 16;
        DisplacerSettings settings = small(10);
        settings.width = 320;
        settings.height = 240;
        const Displacer spectral(scene, settings);
        settings.model = Model::FirstOrder;
        const Displacer first(scene, settings);
        const PixelWindow window{0, 0, 320, 240};
        const Map a = map_of(spectral, 1, window, 10), b = map_of(first, 1, window, 10);
        EXPECT_LT(difference(a, b), kFirstOrderError * rms(a)) << size;
    }
}

/// Mean square of ∂d_x/∂x and ∂d_y/∂y by differences of neighbouring pixels.
double mean_square_slope(const Map& uv, int width, int height) {
    double sum = 0;
    for (int y = 0; y + 1 < height; ++y)
        for (int x = 0; x + 1 < width; ++x) {
            const auto at = 2 * static_cast<std::size_t>(y * width + x);
            const double along = uv[at + 2] - uv[at],
                         down = uv[at + 1 + 2 * static_cast<std::size_t>(width)] - uv[at + 1];
            sum += 0.5 * (along * along + down * down);
        }
    return sum / ((width - 1) * (height - 1));
}

// 150 realisations of a few eddies each. The view is narrow, because oblique rays bend more.
TEST(Displacement, FocusingIsTheSlopeOfTheMap) {
    for (const bool perspective : {true, false})
        for (const auto form : {TurbulenceForm::Lattice, TurbulenceForm::GradientNoise}) {
            TurbulenceSpec spec = lattice_spec();
            spec.form = form;
            double sum = 0, expected = 0;
            constexpr int kSeeds = 150;
            for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
                spec.seed = seed;
                Scene scene = orthographic(spec, {0, 0, -1}, {0, 1, 0});
                if (perspective) {
                    scene.camera.projection = Projection::Perspective;
                    scene.camera.horizontal_fov = 15;
                }
                DisplacerSettings settings = small(1.8);
                settings.width = 32;
                const Displacer displacer(scene, settings);
                const PixelWindow window{0, 0, 32, 18};
                sum += mean_square_slope(map_of(displacer, 1, window, 1.8), 32, 18) / kSeeds;
                expected += displacer.focusing_variance(1.8) / kSeeds;
            }
            EXPECT_GT(expected, 0);
            EXPECT_NEAR(sum / expected, 1, 0.12) << perspective << ' ' << static_cast<int>(form);
        }
}

TEST(Displacement, FoldingLatticesAreWarnedOf) {
    TurbulenceSpec spec = lattice_spec();
    spec.cn2 = 1;
    const Displacer displacer(scene_with(spec), small(1.8));
    EXPECT_GT(displacer.focusing_variance(1.8), 1);
    ASSERT_FALSE(displacer.warnings().empty());
    EXPECT_NE(displacer.warnings().front().find("focusing variance"), std::string::npos);
}

TEST(Displacement, PathsOfTooManyCellsAreRefusedLongOnesWarnedOf) {
    TurbulenceSpec spec = lattice_spec();  // cells of 0.125 m
    for (const auto form : {TurbulenceForm::Lattice, TurbulenceForm::GradientNoise}) {
        spec.form = form;
        try {
            const Displacer displacer(scene_with(spec), small(6000));
            ADD_FAILURE();
        } catch (const UserError& error) {
            for (const char* part : {"medium.0", "steps", "6000 m", "form=\"screens\"", "`far`", "period"})
                EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
        }
        const Displacer displacer(scene_with(spec), small(1000));
        EXPECT_NE(displacer.warnings().front().find("steps"), std::string::npos);
    }
}

TEST(Displacement, AFrameEndsOnceAStopIsRequested) {
    std::stop_source stop;
    DisplacerSettings settings = small(1.8);
    settings.stop = stop.get_token();
    const Displacer displacer(scene_with(lattice_spec()), settings);
    map_of(displacer, 1, kSmall, 1.8);
    stop.request_stop();
    EXPECT_THROW(map_of(displacer, 1, kSmall, 1.8), FrameError);
}

// PHYSICS.md#first-order. Tables agree with the exact ones at their own depths. The single table is right at `far`
// only, because displacement grows as u² and then u^(3/2), not as u.
TEST(Displacement, TablesAreRightWherePromisedAndWrongElsewhere) {
    TurbulenceSpec spec = lattice_spec();
    spec.lattice = {{32, 32, 32, 1}};
    spec.period = {{4.0, 4.0, 4.0, 1.0}};
    spec.outer_scale = 0.8;
    double exact2 = 0, table2 = 0, near_exact2 = 0, near_table2 = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        spec.seed = seed;
        const Scene scene = orthographic(spec, {0, 0, -1}, {0, 1, 0});
        const double far = 3.2;
        const Displacer spectral(scene, small(far)), tables(scene, small(far, Model::Tables)),
            table(scene, small(far, Model::Table));
        for (const double D : {far / kTables, 0.5 * far, far}) {
            const Map a = map_of(spectral, 1, kSmall, D), b = map_of(tables, 1, kSmall, D);
            EXPECT_LT(difference(a, b), 0.012 * rms(a)) << "at a table's own depth";
        }
        const double between = 0.5625 * far;  // midway
        const Map a = map_of(spectral, 1, kSmall, between), b = map_of(tables, 1, kSmall, between);
        EXPECT_GT(difference(a, b), 1e-3 * rms(a));
        EXPECT_LT(difference(a, b), 0.1 * rms(a));
        const auto square = [](double v) { return v * v; };
        exact2 += square(rms(map_of(spectral, 1, kSmall, far)));
        table2 += square(rms(map_of(table, 1, kSmall, far)));
        near_exact2 += square(rms(map_of(spectral, 1, kSmall, far / 16)));
        near_table2 += square(rms(map_of(table, 1, kSmall, far / 16)));
    }
    EXPECT_NEAR(table2 / exact2, 1, 0.35) << "12 realisations";
    // at far/16 the table shows far/16 of its far displacement, and the truth less than (1/16)^1.5
    EXPECT_GT(std::sqrt(near_table2 / near_exact2), 3);
}

// ---- screens ----

TurbulenceSpec screen_spec(double L0 = 1e4) {
    TurbulenceSpec spec;
    spec.cn2 = 1e-14;
    spec.outer_scale = L0;
    spec.inner_scale = 0.01;
    spec.alpha = 1e12;  // every frame another realisation
    spec.lattice = {{128, 128, 8, 64}};
    return spec;
}

// Along a single axis. The map's own weight is 1 - w/D in either projection, so that parallel rays, too, have 1.093 in
// the displacement. Their 3.28 is the angle of arrival, which no displaced object shows; it is measured in
// tests/noise/turbulence/screens_test.cpp.
TEST(Displacement, ScreensHaveTheVarianceOfAngleOfArrival) {
    const double L0 = 1e4, far = 12 * L0;
    for (const bool perspective : {true, false}) {
        Scene scene = scene_with(screen_spec(L0));
        scene.media = {[&] {
            auto s = screen_spec(L0);
            s.lattice = {{128, 128, 12, 64}};
            return s;
        }()};
        if (perspective) {
            scene.camera.horizontal_fov = 1e-5;
        } else {
            scene.camera.projection = Projection::Orthographic;
            scene.camera.width = 0.02;
        }
        DisplacerSettings settings = small(far);
        settings.width = settings.height = 48;
        const Displacer displacer(scene, settings);
        const Camera camera = displacer.camera(1);
        const double pixels = perspective ? camera.f_px : camera.f_px * far;  // of one radian
        double sum = 0, expected = 0;
        constexpr int kFrames = 400;
        for (int frame = 0; frame < kFrames; ++frame) {
            const double r = rms(map_of(displacer, frame, {0, 0, 48, 48}, far)) / pixels;
            sum += 0.5 * r * r / kFrames;
        }
        const double r = displacer.expected_rms(far) / pixels;
        expected = 0.5 * r * r;
        const double continuum = 1.093 * 1e-14 * far * std::pow(0.01, -1.0 / 3);
        EXPECT_NEAR(expected / continuum, 1, 0.03) << perspective;
        // a view of a single eddy a frame, two axes: relative deviation √(1/400) = 5 %, taken three times
        EXPECT_NEAR(sum / expected, 1, 0.15) << perspective;
    }
}

TEST(Displacement, ExpectedRmsOfRareBlobs) {
    BlobsSpec rare;
    rare.sources = {
        {.from = {0, 0.1, -3}, .rate = 1, .temperature = 900, .sigma = 0.1, .cooling = 0.5, .lifetime = 0.2}};
    Scene scene;
    scene.camera.position = {0, 0, 0};
    scene.camera.look_at = {0, 0, -1};
    scene.camera.horizontal_fov = 40;
    scene.time.fps = 24;
    scene.optics.exaggeration = 20;
    scene.media = {rare};
    const Displacer displacer(scene, sized(64, 36, 6));
    double sum = 0;
    constexpr int kFrames = 480;
    for (int frame = 0; frame < kFrames; ++frame) {
        const double r = rms(map_of(displacer, frame, {0, 0, 64, 36}, 6));
        sum += r * r / kFrames;
    }
    EXPECT_GT(displacer.expected_rms(6), 0.4 * std::sqrt(sum));
    EXPECT_LT(displacer.expected_rms(6), 2.5 * std::sqrt(sum));
}

// Blobs of a few pixels at any place. A fixed set of pixels would miss them.
TEST(Displacement, ExpectedRmsOfSmallBlobs) {
    Scene scene;
    scene.camera.position = {0, 0, 0};
    scene.camera.look_at = {0, 0, -1};
    scene.camera.horizontal_fov = 40;
    scene.optics.exaggeration = 20;
    for (const double sigma : {0.02, 0.05, 0.2})
        for (const double side : {-1.2, 0.0, 0.7}) {
            BlobsSpec blobs;
            blobs.blobs = {{{side, 0.3 * side, -5}, sigma, 900}, {{side + 0.01, 0.3 * side, -5.2}, 0.7 * sigma, 700}};
            scene.media = {blobs};
            const Displacer displacer(scene, sized(640, 360, 6));
            const double real = rms(map_of(displacer, 1, {0, 0, 640, 360}, 6));
            EXPECT_NEAR(displacer.expected_rms(6) / real, 1, 0.25) << sigma << ' ' << side;
        }
}

TEST(Displacement, ExpectedRmsIsTheRealisedOne) {
    const Displacer displacer(long_view(0.01), sized(160, 90, 400));
    for (const double D : {400.0, 60.0}) {
        double sum = 0;
        constexpr int kFrames = 60;
        for (int frame = 0; frame < kFrames; ++frame) {
            const double r = rms(map_of(displacer, 1000 * frame, {0, 0, 160, 90}, D));
            sum += r * r / kFrames;
        }
        EXPECT_NEAR(std::sqrt(sum) / displacer.expected_rms(D), 1, 0.06) << D;
    }
}

TEST(Displacement, DepthPlanesAgreeWithConstantDepth) {
    const Displacer displacer(long_view(), sized(96, 64, 400));
    const PixelWindow window{-5, -3, 106, 70};
    for (const double D : {0.7, 30.0, 211.0, 400.0}) {
        const Map constant = map_of(displacer, 1, window, D);
        const DepthPlane flat(window, std::vector<float>(window.area(), static_cast<float>(D)));
        for (const DepthMeeting how : {DepthMeeting::Own, DepthMeeting::FixedPoint, DepthMeeting::March})
            EXPECT_LT(difference(constant, map_of(displacer, 1, window, flat, how)), 1e-6 * (1 + rms(constant)));
    }
    // A ramp of depth, pixel by pixel. X is exact between any depths of the grid, also with whole slabs before them.
    for (const float nearest : {0.5f, 100.0f}) {
        std::vector<float> metres;
        for (std::size_t i = 0; i < window.area(); ++i)
            metres.push_back(nearest + (400 - nearest) * static_cast<float>(i * 7919 % 6007) / 6007);
        const DepthPlane ramp(window, metres);
        const Map map = map_of(displacer, 1, window, ramp, DepthMeeting::Own);
        for (std::size_t i = 0; i < window.area(); i += 97) {
            const Map constant = map_of(displacer, 1, window, metres[i]);
            EXPECT_NEAR(map[2 * i], constant[2 * i], 1e-4) << metres[i];
            EXPECT_NEAR(map[2 * i + 1], constant[2 * i + 1], 1e-4) << metres[i];
        }
    }
}

TEST(Displacement, AForegroundStaysStillBeforeAShimmeringBackground) {
    const Displacer displacer(long_view(), sized(96, 64, 300));
    const PixelWindow window{0, 0, 96, 64};
    std::vector<float> metres(window.area(), 300);
    for (std::size_t y = 0; y < 64; ++y)
        for (std::size_t x = 40; x < 60; ++x) metres[y * 96 + x] = 5;
    const DepthPlane plane(window, metres);
    const Map map = map_of(displacer, 1, window, plane, DepthMeeting::March);
    double post = 0, wall = 0;
    for (std::size_t y = 0; y < 64; ++y)
        for (std::size_t x = 0; x < 96; ++x) {
            const double v = std::hypot(map[2 * (y * 96 + x)], map[2 * (y * 96 + x) + 1]);
            if (x >= 40 && x < 60) post = std::max(post, v);
            if (x < 30) wall = std::max(wall, v);
        }
    EXPECT_LT(post, 0.12 * wall);
}

// A reference 33 times as fine puts the nodes of its grid next to every pixel: pixel x has its centre at 33 x + 16.
TEST(Displacement, NodesApartCostLittleAccuracy) {
    for (const double far : {100.0, 500.0}) {
        Scene scene = long_view();
        auto& spec = (*scene.media[0].get_if<TurbulenceSpec>());
        spec.outer_scale = 8;
        const double cell = 0.05 / 3;
        spec.lattice = {{128, 128, 6, 1}};
        spec.period = {{128 * cell, 128 * cell, 1, 1}};
        const Displacer coarse(scene, sized(1920, 1080, far)), fine(scene, sized(33 * 1920, 33 * 1080, far));
        const PixelWindow window{600, 300, 48, 9};
        const Map map = map_of(coarse, 1, window, far);
        double error = 0, power = 0;
        for (int y = 0; y < window.height; y += 2) {
            const Map reference =
                map_of(fine, 1, {33 * window.x0, 33 * (window.y0 + y) + 16, 33 * window.width, 1}, far);
            for (int x = 0; x < window.width; ++x)
                for (int c = 0; c < 2; ++c) {
                    const double r = reference[static_cast<std::size_t>(2 * (33 * x + 16) + c)] / 33.0;
                    const double d = map[static_cast<std::size_t>(2 * (y * window.width + x) + c)] - r;
                    error += d * d;
                    power += r * r;
                }
        }
        EXPECT_LT(std::sqrt(error / power), kSpacingError) << far;
    }
}

TEST(Displacement, PiecesThreadsAndFramesGiveTheSameBits) {
    Scene lattice = scene_with(lattice_spec());
    lattice.camera.horizontal_fov = 60;
    for (const Scene& scene : {long_view(0.01), lattice, orthographic(lattice_spec(), {0, 0, -1}, {0, 1, 0})}) {
        const double far = (*scene.media[0].get_if<TurbulenceSpec>()).form == TurbulenceForm::Screens ? 400 : 1.5;
        const Displacer displacer(scene, sized(90, 70, far));
        const PixelWindow window{-9, -7, 108, 84};
        std::vector<float> metres;
        for (std::size_t i = 0; i < window.area(); ++i)
            metres.push_back(static_cast<float>(far * (0.3 + 0.7 * static_cast<double>(i % 50) / 50)));
        const DepthPlane plane(window, metres);
        const auto instant = displacer.at(7.5, 0.3 * far, far);
        const DepthSource sources[] = {far, &plane};
        for (const DepthSource& source : sources) {
            Map whole(2 * window.area());
            instant.map(window, source, DepthMeeting::March, whole.data());
            for (const PixelWindow& part :
                 {PixelWindow{-9, -7, 108, 1}, {3, 5, 17, 61}, {-2, 60, 1, 1}, {64, -7, 35, 84}}) {
                Map piece(2 * part.area());
                const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
                displacer.at(7.5, 0.3 * far, far).map(part, source, DepthMeeting::March, piece.data());
                for (int y = 0; y < part.height; ++y) {
                    const auto at =
                        2 * static_cast<std::size_t>((part.y0 + y - window.y0) * window.width + part.x0 - window.x0);
                    EXPECT_EQ(0, std::memcmp(&whole[at], &piece[2 * static_cast<std::size_t>(y * part.width)],
                                             2 * sizeof(float) * static_cast<std::size_t>(part.width)));
                }
            }
        }
    }
}

// ---- range ----

TEST(Displacement, ExtremesStayFinite) {
    for (const auto form : {TurbulenceForm::Screens, TurbulenceForm::GradientNoise, TurbulenceForm::Lattice})
        for (const double fov : {1e-3, 40.0, 179.0})
            for (const double far : {1e-3, 30.0, 1e9}) {
                if (form != TurbulenceForm::Screens && (far > 100 || (fov > 170 && far > 1)))
                    continue;  // as many steps as eddies
                Scene scene = scene_with(lattice_spec());
                auto& spec = (*scene.media[0].get_if<TurbulenceSpec>());
                spec.form = form;
                spec.lattice.reset();
                spec.period.reset();
                if (form == TurbulenceForm::Lattice) spec = lattice_spec();
                scene.optics.exaggeration = 1e3;
                DisplacerSettings settings = sized(3, 2, far);
                settings.fov = fov;
                const Displacer displacer(scene, settings);
                EXPECT_TRUE(std::isfinite(displacer.expected_rms(far)));
                const PixelWindow window{-1, -1, 5, 4}, one{0, 0, 1, 1};
                std::vector<float> metres;
                for (std::size_t i = 0; i < window.area(); ++i)
                    metres.push_back(static_cast<float>(std::min(far, std::array{1e-6, 0.5, 1e9, 3.0, 1e-40}[i % 5])));
                const DepthPlane plane(window, metres);
                Map maps[] = {map_of(displacer, 1, window, plane, DepthMeeting::March), map_of(displacer, 1, one, far),
                              map_of(displacer, 1e7, one, 1e-6)};
                for (const Map& map : maps)
                    for (const float v : map) ASSERT_TRUE(std::isfinite(v)) << fov << ' ' << far;
            }
}

TEST(Displacement, GainScalesAndZeroStrengthMovesNothing) {
    Scene scene = long_view();
    const Displacer displacer(scene, sized(32, 32, 100));
    const Map one = map_of(displacer, 1, {0, 0, 32, 32}, 100), three = map_of(displacer, 1, {0, 0, 32, 32}, 100, 3);
    for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(three[i], 3 * one[i], 1e-5 * std::abs(three[i]) + 1e-9);
    (*scene.media[0].get_if<TurbulenceSpec>()).cn2 = 0;
    for (const float v : map_of(Displacer(scene, sized(32, 32, 100)), 1, {0, 0, 32, 32}, 100)) EXPECT_EQ(v, 0);
}

}  // namespace
}  // namespace eikonal
