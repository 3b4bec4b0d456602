// Second-order rays, and the error that maps state.
// Length: the stated error is judged by the full ray equation, which is tested first.
#include "warp/displace/models/second_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "noise/base/error.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/profile/profile_spec.h"
#include "noise/surface/surface.h"
#include "noise/surface/surface_spec.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
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

// The second-order term is quadratic in the strength of the air. The first-order term is linear.
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

// In the middle of a very hot blob n <= 0. There is no map, and the error of a first-order map is unknown.
TEST(SecondOrder, WithoutAnIndexThereIsNoMap) {
    Scene scene = blob_scene(2e4);
    (*scene.media[0].get_if<BlobsSpec>()).blobs[0].center = scene.camera.position;
    EXPECT_THROW(map_of(scene, settings_for(40), Model::SecondOrder, 40), FrameError);
    StatedError stated;
    for (const float v : map_of(scene, settings_for(40), Model::FirstOrder, 40, &stated)) ASSERT_TRUE(std::isfinite(v));
    EXPECT_TRUE(std::isinf(stated.largest));
    EXPECT_EQ(shown_error(stated.largest), "an unknown number of px");
}

// For every kind of medium, the steps of a map's rays are compared with finer ones.
TEST(SecondOrder, StepsAreAsAccurateAsStated) {
    for (const Scene& scene : {blob_scene(300), lattice_scene(false), screen_scene(2e-13)}) {
        const double depth = (scene.media[0].get_if<BlobsSpec>() != nullptr) ? 40
                             : scene.camera.horizontal_fov == 1              ? 600
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

// Samples stand for equal parts of the map, near and far. Pixels beside the edge between them are left out.
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

// If there are edges everywhere, samples are taken beside them.
TEST(StatedError, EdgesAreSampledWhereThereIsNothingElse) {
    std::vector<float> metres(kWindow.area());
    for (std::size_t i = 0; i < metres.size(); ++i) metres[i] = i % 4 == 0 ? 5 : 300;
    const DepthPlane plane(kWindow, metres);
    const std::vector<float> uv(2 * kWindow.area());
    EXPECT_EQ(choose_samples(kWindow, &plane, uv.data(), kErrorSamples).size(), kErrorSamples);
}

// A wall that recedes. Its pixels are facets to the map, and one smooth surface to the rays that judge the map.
TEST(StatedError, MeetsTheSurfaceBetweenPixels) {
    std::vector<float> metres(kWindow.area());
    for (std::size_t i = 0; i < metres.size(); ++i)
        metres[i] = 1 / (0.02F + 0.0004F * static_cast<float>(i % static_cast<std::size_t>(kWidth)));
    const DepthPlane plane(kWindow, metres);
    DisplacementGrid grid;
    grid.perspective = true;
    grid.depths = {10, 50};
    grid.interpolation = DepthInterpolation::Hermite;
    grid.cover({40, 20, 1, 1});
    // X = 3 (z - 10): d = 3 - 30/z, so that d = 3 - 30 (0.02 + 0.0004 (40 + d)) has the solution 1.92/1.012
    for (std::size_t k = 0; k < 2; ++k)
        for (int c = 0; c < grid.columns; ++c)
            for (int r = 0; r < grid.rows; ++r) grid.row(r, k)[c] = Node{k == 0 ? 0.0F : 120.0F, 0, 3, 0};
    const std::vector<DisplacementGrid> grids{grid};
    GridRows row;
    row.start(grids, 20);
    const Shift d = meet_smooth_surface(row, plane, true, 40, 20, row.at(40, metres[42]));
    EXPECT_NEAR(d.x, 1.92 / 1.012, 1e-4);
    EXPECT_EQ(d.y, 0);
}

// A wall with a post in front of it. The ray that judges meets the depth buffer in the same way as the map's ray.
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
    const ModelChoice loose = choose_model(scene, settings, 100, {settings.far}, one);
    EXPECT_EQ(loose.model, Model::Table);
    EXPECT_TRUE(loose.within);
    EXPECT_EQ(loose.tried.size(), 1U);
    const ModelChoice tight = choose_model(scene, settings, 0.5 * loose.p95, {settings.far}, one);
    EXPECT_GT(tight.model, Model::Table);
    EXPECT_TRUE(tight.within);
    EXPECT_LE(tight.p95, 0.5 * loose.p95);
    const ModelChoice none = choose_model(scene, settings, 1e-12, {settings.far}, one);
    EXPECT_FALSE(none.within);
    EXPECT_EQ(none.tried.size(), kModelNames.size());
    for (const TriedModel& tried : none.tried)
        EXPECT_TRUE(!tried.refusal.empty() || none.p95 <= tried.p95) << tried.p95;
}

// The choice is made for the depth that all frames share.
TEST(ChooseModel, KnowsTheDepthOfTheShot) {
    const Scene scene = screen_scene(4e-13);
    const DisplacerSettings settings = settings_for(5000);
    const GainOf one = [](const Displacer&) { return 1.0; };
    const auto p95 = [&](const ShotDepth& depth) { return choose_model(scene, settings, 100, depth, one).p95; };
    const double far = p95({}), near = p95({2000.0});
    EXPECT_LT(near, 0.7 * far);
    const DepthPlane flat(kWindow, std::vector<float>(kWindow.area(), 2000));
    EXPECT_NEAR(p95({flat}), near, 0.2 * near);
    std::vector<float> metres(kWindow.area(), 2000);
    for (int y = 0; y < kHeight; ++y)
        for (int x = kWidth / 2; x < kWidth; ++x) metres[static_cast<std::size_t>(y * kWidth + x)] = 5000;
    EXPECT_GT(p95({DepthPlane(kWindow, metres)}), 1.2 * near) << "half of it is far";
}

// The stated error of a model agrees with that of the whole map, found by second-order at every node.
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

Scene surface_scene(double temperature, double dropoff) {
    Scene scene = view(0.5);
    SurfaceSpec spec;
    spec.surface_temperature = temperature;
    spec.dropoff = dropoff;
    scene.media = {spec};
    return scene;
}

// A surface alone is computed in closed form. The rays that judge it must be as exact.
TEST(StatedError, SayThatALoneSurfaceIsExact) {
    for (const Scene& scene : {surface_scene(270, 3), surface_scene(310, 1)}) {
        StatedError stated;
        const std::vector<float> uv = map_of(scene, settings_for(5000), std::nullopt, 5000, &stated);
        EXPECT_GT(rms(uv), 30);
        EXPECT_LT(stated.p95, 2e-5 * rms(uv));
        const ModelChoice choice = choose_model(scene, settings_for(5000), 0.01, {settings_for(5000).far},
                                                [](const Displacer&) { return 1.0; });
        EXPECT_TRUE(choice.exact && choice.within) << choice.p95;
    }
}

// The depth buffer has a hole in the heated ground. There the judging rays go on through the plane, on which a map ends
// them. They are refracted by n cosθ = const.
TEST(StatedError, KnowOfHolesInTheGround) {
    const Scene scene = [] {
        Scene s = surface_scene(330, 0.02);
        s.camera.horizontal_fov = 10;
        return s;
    }();
    const Displacer displacer(scene, settings_for(5000));
    const Camera camera = displacer.camera(1);
    const auto stated = [&](bool hole) {
        std::vector<float> metres(kWindow.area(), 5000);
        for (int y = kHeight / 2; y < kHeight && !hole; ++y) {
            const double below = -camera.slope(0, y + 0.5).y;
            std::fill_n(metres.begin() + y * kWidth, kWidth, static_cast<float>(std::min(5000.0, 1.5 / below)));
        }
        const DepthPlane plane(kWindow, std::move(metres));
        const Displacer::Instant instant = displacer.at(1, plane.nearest(), plane.farthest());
        const PixelWindow rows{0, kHeight - 24, kWidth, 2};
        std::vector<float> uv(2 * rows.area());
        instant.map(rows, &plane, DepthMeeting::March, uv.data());
        return instant.stated_error(rows, &plane, DepthMeeting::March, uv.data()).p50;
    };
    const double slope = -camera.slope(0, kHeight - 23).y, cosine = 1 / std::sqrt(1 + slope * slope);
    const SurfaceIndex layer((*scene.media[0].get_if<SurfaceSpec>()), index_law(scene.optics));
    const double turned = cosine * (1 - layer.above_ambient(0));  // n is near 1
    const double below = std::sqrt(1 - turned * turned) / turned;
    EXPECT_NEAR(stated(true), camera.f_px * (slope - below), 0.1 * camera.f_px * (slope - below));
    EXPECT_LT(stated(false), 1e-3);
}

// Objects beyond the background are at their own depth, and the media in front of them are complete.
TEST(StatedError, HoldBeyondFar) {
    struct Case {
        Scene scene;
        double far, depth;
    };
    for (const Case& c : {Case{blob_scene(100), 5, 40}, Case{lattice_scene(false), 0.5, 2}}) {
        const DepthPlane plane(kWindow, std::vector<float>(kWindow.area(), static_cast<float>(c.depth)));
        const auto map = [&](double far, double deepest) {
            DisplacerSettings settings = settings_for(far);
            settings.deepest = deepest;
            const Displacer displacer(c.scene, settings);
            EXPECT_EQ(displacer.models().size(), 1U);
            EXPECT_TRUE(displacer.beyond_far(c.depth).empty());
            std::vector<float> uv(2 * kWindow.area());
            const Displacer::Instant instant = displacer.at(1, c.depth, c.depth);
            instant.map(kWindow, &plane, DepthMeeting::March, uv.data());
            return std::pair{uv, instant.stated_error(kWindow, &plane, DepthMeeting::March, uv.data()).p95};
        };
        const auto [beyond, error] = map(c.far, 1e9);
        const auto [within, same] = map(c.depth, 0);
        EXPECT_EQ(beyond, within);
        EXPECT_EQ(error, same);
        EXPECT_LT(error, 0.2 * rms(beyond));
    }
    DisplacerSettings settings = settings_for(100);
    settings.deepest = 1e9;
    const Displacer screens(screen_scene(2e-13), settings);
    EXPECT_TRUE(screens.beyond_far(static_cast<float>(100)).empty());
    ASSERT_EQ(screens.beyond_far(101).size(), 1U);
    EXPECT_NE(screens.beyond_far(101)[0].find("thin screens"), std::string::npos);
}

// Blobs beside the picture are left out, unless pixels are asked for there.
TEST(MediaLayers, LeaveOutBlobsAside) {
    Scene scene = view();
    BlobsSpec blobs;
    blobs.blobs = {{{4, 1.5, -10}, 0.1, 900}};  // half the picture's width beyond its right edge
    scene.media = {blobs};
    DisplacerSettings settings = settings_for(40);
    const Displacer without(scene, settings);
    EXPECT_TRUE(without.models().empty());
    ASSERT_FALSE(without.notes().empty());
    EXPECT_NE(without.notes()[0].find("medium.0: left out"), std::string::npos) << without.notes()[0];
    settings.overscan = [] { return PixelWindow{-kWidth, -kHeight, 3 * kWidth, 3 * kHeight}; };
    EXPECT_EQ(Displacer(scene, settings).models().size(), 1U);
}

// A model is taken only with the margin, and sufficient_model() finds one that should suffice.
TEST(ChooseModel, KeepsAMargin) {
    const Scene scene = blob_scene(300);
    const auto one = [](const Displacer&) { return 1.0; };
    const ModelChoice loose = choose_model(scene, settings_for(40), 100, {settings_for(40).far}, one);
    EXPECT_EQ(loose.model, Model::FirstOrder);
    const double sure = 1.001 * kChoiceMargin * loose.p95, tight = 0.999 * kChoiceMargin * loose.p95;
    EXPECT_EQ(choose_model(scene, settings_for(40), sure, {settings_for(40).far}, one).model, Model::FirstOrder);
    EXPECT_EQ(choose_model(scene, settings_for(40), tight, {settings_for(40).far}, one).model, Model::SecondOrder);
    const auto better = [&](double tolerance, Model model) {
        return sufficient_model(scene, settings_for(40), tolerance, {settings_for(40).far}, one, model, loose.p95);
    };
    EXPECT_EQ(better(0.9 * loose.p95, Model::FirstOrder), Model::SecondOrder);
    EXPECT_FALSE(better(1e-9, Model::FirstOrder));
    EXPECT_FALSE(better(0.9 * loose.p95, Model::SecondOrder));
}

TEST(ChooseModel, RefusesWhatNoModelTakes) {
    Scene scene = view();
    scene.media = {ProfileSpec{}};
    EXPECT_THROW(
        choose_model(scene, settings_for(10), 0.1, {settings_for(10).far}, [](const Displacer&) { return 1.0; }),
        UserError);
}

}  // namespace
}  // namespace eikonal
