// Second-order rays, and the error that maps state of themselves.
#include "warp/displace/second_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "noise/error.h"
#include "warp/displace/choose_model.h"
#include "warp/displace/stated_error.h"

namespace eikonal {
namespace {

constexpr int kWidth = 192, kHeight = 96;
constexpr PixelWindow kWindow{0, 0, kWidth, kHeight};

DisplacerSettings settings_for(double far) {
    DisplacerSettings settings;
    settings.width = kWidth;
    settings.height = kHeight;
    settings.far = far;
    settings.sample_errors = true;
    return settings;
}

Scene view(double fov = 20) {
    Scene scene;
    scene.camera.position = {0, 1.5, 0};
    scene.camera.look_at = {0, 1.5, -1};
    scene.camera.horizontal_fov = fov;
    return scene;
}

/// One blob ten metres away, off the axis.
Scene blob_scene(double strength) {
    Scene scene = view();
    scene.optics.exaggeration = strength;
    BlobsSpec blobs;
    blobs.blobs = {{{0.2, 1.6, -10}, 0.4, 900}};
    scene.media = {blobs};
    return scene;
}

Scene lattice_scene(bool orthographic) {
    Scene scene = view();
    TurbulenceSpec spec;
    spec.form = TurbulenceForm::Lattice;
    spec.cn2 = 1e-6;
    spec.outer_scale = 1;
    spec.inner_scale = 0.12;
    spec.lattice = {32, 32, 32, 8};
    spec.period = {2, 2, 2, 1};
    scene.media = {spec};
    if (orthographic) {
        scene.camera.projection = Projection::Orthographic;
        scene.camera.width = 2;
        scene.camera.position = {0, 0, 0};
        scene.camera.look_at = {0, 0, -1};
    }
    return scene;
}

Scene screen_scene(double cn2) {
    Scene scene = view(1);
    TurbulenceSpec spec;
    spec.form = TurbulenceForm::Screens;
    spec.cn2 = cn2;
    spec.outer_scale = 2;
    spec.inner_scale = 0.02;
    scene.media = {spec};
    return scene;
}

std::vector<float> map_of(const Scene& scene, DisplacerSettings settings, std::optional<Model> model, double depth,
                          StatedError* stated = nullptr) {
    settings.model = model;
    const Displacer displacer(scene, settings);
    std::vector<float> uv(2 * kWindow.area());
    const Displacer::Instant instant = displacer.at(1, depth, depth);
    instant.map(kWindow, depth, DepthMeeting::Own, uv.data());
    if (stated != nullptr) *stated = instant.stated_error(kWindow, depth, DepthMeeting::Own, uv.data());
    return uv;
}

double rms(const std::vector<float>& uv) {
    double sum = 0;
    for (const float v : uv) sum += double{v} * v;
    return std::sqrt(2 * sum / static_cast<double>(uv.size()));
}

std::vector<float> difference(std::vector<float> a, const std::vector<float>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
    return a;
}

// The second-order term is quadratic in the strength of the air, the first linear.
TEST(SecondOrder, DiffersFromFirstOrderByTheSquareOfTheStrength) {
    const auto gap = [](double strength) {
        const Scene scene = blob_scene(strength);
        const DisplacerSettings settings = settings_for(40);
        const std::vector<float> first = map_of(scene, settings, Model::FirstOrder, 40);
        return std::pair{rms(first), rms(difference(map_of(scene, settings, Model::SecondOrder, 40), first))};
    };
    const auto [weak, weak_gap] = gap(100);
    const auto [strong, strong_gap] = gap(400);
    EXPECT_NEAR(strong / weak, 4, 0.01);
    EXPECT_NEAR(strong_gap / weak_gap, 16, 1.6);
}

// Every kind of medium: the steps of a map's rays against finer ones.
TEST(SecondOrder, StepsAreAsAccurateAsStated) {
    for (const Scene& scene : {blob_scene(300), lattice_scene(false), screen_scene(2e-13)}) {
        const double depth = std::holds_alternative<BlobsSpec>(scene.media[0]) ? 40
                             : scene.camera.horizontal_fov == 1                ? 600
                                                                               : 2;
        DisplacerSettings settings = settings_for(depth);
        settings.model = Model::SecondOrder;
        const Displacer displacer(scene, settings);
        const Displacer::Instant instant = displacer.at(1, depth, depth);
        std::vector<float> uv(2 * kWindow.area());
        instant.map(kWindow, depth, DepthMeeting::Own, uv.data());
        double sum = 0;
        const std::vector<double> errors =
            instant.sampled_errors(kWindow, depth, DepthMeeting::Own, uv.data(), kErrorSamples);
        for (const double e : errors) sum += e * e;
        EXPECT_LT(std::sqrt(sum / kErrorSamples), (kSecondOrderError + kSpacingError) * rms(uv)) << depth;
        EXPECT_GT(rms(uv), 0.1) << depth;
    }
}

TEST(StatedError, FindsAnErrorThatIsPutIntoAMap) {
    const Scene scene = blob_scene(20);
    DisplacerSettings settings = settings_for(40);
    const Displacer displacer(scene, settings);
    const Displacer::Instant instant = displacer.at(1, 40, 40);
    std::vector<float> uv(2 * kWindow.area());
    instant.map(kWindow, 40.0, DepthMeeting::Own, uv.data());
    const StatedError own = instant.stated_error(kWindow, 40.0, DepthMeeting::Own, uv.data());
    EXPECT_LT(own.p95, 0.02);
    for (std::size_t i = 0; i < uv.size(); i += 2) uv[i] += 0.5F;
    const StatedError shifted = instant.stated_error(kWindow, 40.0, DepthMeeting::Own, uv.data());
    EXPECT_NEAR(shifted.p50, 0.5, 0.02);
    EXPECT_NEAR(shifted.p95, 0.5, 0.03);
}

// Samples stand for equal parts of the map, near and far, but for what lies beside the edge between.
TEST(StatedError, SamplesAreSpreadOverDepthAsTheMapIs) {
    std::vector<float> metres(kWindow.area(), 300);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth / 8; ++x) metres[static_cast<std::size_t>(y * kWidth + x)] = 5;
    const DepthPlane plane(kWindow, metres);
    std::vector<float> uv(2 * kWindow.area());
    for (std::size_t i = 0; i < uv.size(); ++i) uv[i] = static_cast<float>(i % 3);
    const std::vector<SamplePixel> samples = choose_samples(kWindow, &plane, uv.data(), kErrorSamples);
    ASSERT_EQ(samples.size(), kErrorSamples);
    const auto near = std::count_if(samples.begin(), samples.end(), [](const SamplePixel& p) { return p.depth == 5; });
    EXPECT_NEAR(static_cast<double>(near) / kErrorSamples, (kWidth / 8.0 - kEdgeReach) / (kWidth - 2 * kEdgeReach),
                0.02);
    for (const SamplePixel& p : samples) {
        const auto i = static_cast<std::size_t>(p.y * kWidth + p.x);
        EXPECT_EQ(p.depth, metres[i]);
        EXPECT_EQ(p.map.x, uv[2 * i]);
        EXPECT_TRUE(p.x < kWidth / 8 - kEdgeReach || p.x >= kWidth / 8 + kEdgeReach) << p.x;
    }
}

// Edges everywhere: then their pixels must do.
TEST(StatedError, EdgesAreSampledWhereThereIsNothingElse) {
    std::vector<float> metres(kWindow.area());
    for (std::size_t i = 0; i < metres.size(); ++i) metres[i] = i % 4 == 0 ? 5 : 300;
    const DepthPlane plane(kWindow, metres);
    const std::vector<float> uv(2 * kWindow.area());
    EXPECT_EQ(choose_samples(kWindow, &plane, uv.data(), kErrorSamples).size(), kErrorSamples);
}

// A wall that recedes: its pixels are facets to the map, and one surface to the rays that judge.
TEST(StatedError, MeetsTheSurfaceBetweenPixels) {
    std::vector<float> metres(kWindow.area());
    for (std::size_t i = 0; i < metres.size(); ++i)
        metres[i] = 1 / (0.02F + 0.0004F * static_cast<float>(i % static_cast<std::size_t>(kWidth)));
    const DepthPlane plane(kWindow, metres);
    Band band;
    band.perspective = true;
    band.depths = {10, 50};
    band.interpolation = DepthInterpolation::Hermite;
    band.cover({40, 20, 1, 1});
    // X = 3 (z - 10): d = 3 - 30/z, so that d = 3 - 30 (0.02 + 0.0004 (40 + d)) has the solution 1.92/1.012
    for (std::size_t k = 0; k < 2; ++k)
        for (int c = 0; c < band.columns; ++c)
            for (int r = 0; r < band.rows; ++r) band.row(r, k)[c] = Node{k == 0 ? 0.0F : 120.0F, 0, 3, 0};
    const std::vector<Band> bands{band};
    BandRows row;
    row.start(bands, 20);
    const Shift d = meet_surface(row, plane, true, 40, 20, row.at(40, metres[42]));
    EXPECT_NEAR(d.x, 1.92 / 1.012, 1e-4);
    EXPECT_EQ(d.y, 0);
}

// Before a wall with a post in front of it, the ray that judges meets the depth buffer as the map's does.
TEST(StatedError, MeetsDepthAsTheMapDoes) {
    std::vector<float> metres(kWindow.area(), 40);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 80; x < 100; ++x) metres[static_cast<std::size_t>(y * kWidth + x)] = 12;
    const DepthPlane plane(kWindow, metres);
    const Displacer displacer(blob_scene(100), settings_for(40));
    const Displacer::Instant instant = displacer.at(1, 12, 40);
    std::vector<float> uv(2 * kWindow.area());
    for (const DepthMeeting meeting : {DepthMeeting::March, DepthMeeting::FixedPoint, DepthMeeting::Own}) {
        instant.map(kWindow, &plane, meeting, uv.data());
        EXPECT_LT(instant.stated_error(kWindow, &plane, meeting, uv.data()).p95, 0.05 * rms(uv));
        EXPECT_GT(rms(uv), 1);
    }
}

TEST(ChooseModel, TakesTheCheapestWithinTheTolerance) {
    const Scene scene = lattice_scene(true);
    const DisplacerSettings settings = settings_for(2);
    const GainOf one = [](const Displacer&) { return 1.0; };
    const ModelChoice loose = choose_model(scene, settings, 100, true, one);
    EXPECT_EQ(loose.model, Model::Table);
    EXPECT_TRUE(loose.within);
    EXPECT_EQ(loose.tried.size(), 1U);
    const ModelChoice tight = choose_model(scene, settings, 0.5 * loose.p95, true, one);
    EXPECT_GT(tight.model, Model::Table);
    EXPECT_TRUE(tight.within);
    EXPECT_LE(tight.p95, 0.5 * loose.p95);
    const ModelChoice none = choose_model(scene, settings, 1e-12, true, one);
    EXPECT_FALSE(none.within);
    EXPECT_EQ(none.tried.size(), kModelNames.size());
    for (const TriedModel& tried : none.tried)
        EXPECT_TRUE(!tried.refusal.empty() || none.p95 <= tried.p95) << tried.p95;
}

// A model's stated figure is what second-order, node by node, says of the whole map.
TEST(ChooseModel, StatesWhatTheWholeMapIsOffBy) {
    const Scene scene = screen_scene(4e-13);
    StatedError stated;
    const std::vector<float> first = map_of(scene, settings_for(600), std::nullopt, 600, &stated);
    const std::vector<float> second = map_of(scene, settings_for(600), Model::SecondOrder, 600);
    std::vector<double> errors;
    for (std::size_t i = 0; i < first.size(); i += 2)
        errors.push_back(std::hypot(double{first[i]} - second[i], double{first[i + 1]} - second[i + 1]));
    const StatedError all = statistics_of(errors);
    EXPECT_GT(all.p95, 0.01);
    EXPECT_NEAR(stated.p95 / all.p95, 1, 0.35);
    EXPECT_NEAR(stated.p50 / all.p50, 1, 0.35);
}

TEST(ChooseModel, RefusesWhatNoModelTakes) {
    Scene scene = view();
    scene.media = {ProfileSpec{}};
    EXPECT_THROW(choose_model(scene, settings_for(10), 0.1, true, [](const Displacer&) { return 1.0; }), UserError);
}

}  // namespace
}  // namespace eikonal
