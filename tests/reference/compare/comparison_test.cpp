/// The comparison of the warp with the tracer. Statistics, picture errors and silhouettes are compared with values
/// worked out by hand. The frontier and the page are tested, and scenes whose errors are known. Length: one case a
/// measure, and the scenes that all of them need.
#include "reference/compare/comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "noise/base/error.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "reference/compare/comparison_page.h"
#include "reference/compare/comparison_table.h"
#include "reference/compare/frontier.h"
#include "reference/compare/heat_map.h"

namespace eikonal::reference {
namespace {

std::vector<float> grey(int width, int height, float linear) {
    std::vector<float> rgba(4 * static_cast<std::size_t>(width * height), linear);
    for (std::size_t i = 3; i < rgba.size(); i += 4) rgba[i] = 1;
    return rgba;
}

TEST(ErrorStatistics, AreRanksOfTheErrors) {
    std::vector<float> errors;
    for (int i = 100; i >= 0; --i) errors.push_back(static_cast<float>(i));
    const ErrorStatistics s = error_statistics(errors);
    EXPECT_EQ(s.count, 101u);
    EXPECT_EQ(s.mean, 50);
    EXPECT_EQ(s.p50, 50);
    EXPECT_EQ(s.p95, 95);
    EXPECT_EQ(s.p99, 99);
    EXPECT_EQ(s.largest, 100);
    EXPECT_EQ(error_statistics({}).count, 0u);
    EXPECT_EQ(error_statistics({3}).p99, 3);
}

// sRGB codes of linear 1 and 0 are 1 and 0; of 0.5, 0.735357. Without variance SSIM is (2ab + C1)/(a² + b² + C1).
TEST(PictureError, OfEvenPictures) {
    constexpr int kSide = 32;
    const auto black = grey(kSide, kSide, 0), half = grey(kSide, kSide, 0.5f), white = grey(kSide, kSide, 1);
    const PictureError opposite = picture_error(black, white, kSide, kSide);
    EXPECT_NEAR(opposite.psnr, 0, 1e-6);
    EXPECT_NEAR(opposite.ssim, kSsimC1 / (1 + kSsimC1), 1e-7);
    constexpr double kCode = 0.7353569;
    const PictureError near = picture_error(half, white, kSide, kSide);
    EXPECT_NEAR(near.psnr, -20 * std::log10(1 - kCode), 1e-4);
    EXPECT_NEAR(near.ssim, (2 * kCode + kSsimC1) / (kCode * kCode + 1 + kSsimC1), 1e-6);
    const PictureError same = picture_error(half, half, kSide, kSide);
    EXPECT_TRUE(std::isinf(same.psnr) && same.psnr > 0);
    EXPECT_NEAR(same.ssim, 1, 1e-12);
    EXPECT_EQ(same.butteraugli, 0);
}

TEST(PictureError, IsOfWhatIsShown) {
    constexpr int kSide = 16;
    const auto white = grey(kSide, kSide, 1), glare = grey(kSide, kSide, 50);
    EXPECT_TRUE(std::isinf(picture_error(white, glare, kSide, kSide).psnr));
    auto broken = white;
    broken[0] = std::nanf("");
    EXPECT_NEAR(picture_error(white, broken, kSide, kSide).psnr, 10 * std::log10(3.0 * kSide * kSide), 1e-6);
}

TEST(PictureError, SeesOtherColours) {
    constexpr int kSide = 64;
    auto red = grey(kSide, kSide, 0.1f), blue = red;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const auto i = 4 * static_cast<std::size_t>(y * kSide + x);
            (x / 4 % 2 == 0 ? red : blue)[i] = 0.9f;
            (x / 4 % 2 == 0 ? blue : red)[i + 2] = 0.9f;
        }
    EXPECT_GT(picture_error(red, blue, kSide, kSide).butteraugli, 10);
}

// A difference of a tenth of a code in 255 goes unnoticed; one of ten codes does not. A displacement is noticed the
// more, the larger it is and the higher the contrast. The order of the pictures does not matter.
TEST(PictureError, SeesOtherGreys) {
    constexpr int kSide = 64;
    const auto distance = [](const std::vector<float>& a, const std::vector<float>& b) {
        return picture_error(a, b, kSide, kSide).butteraugli;
    };
    EXPECT_LT(distance(grey(kSide, kSide, 0.5F), grey(kSide, kSide, 0.5005F)), 0.5);
    EXPECT_GT(distance(grey(kSide, kSide, 0.5F), grey(kSide, kSide, 0.55F)), 5);
    // stripes 16 px wide, moved by part of a pixel
    const auto stripes = [](double contrast, double moved) {
        auto picture = grey(kSide, kSide, 0);
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const double bright = x % 32 < 16 ? (x % 32 == 0 ? 1 - moved : 1) : (x % 32 == 16 ? moved : 0);
                for (std::size_t c = 0; c < 3; ++c)
                    picture[4 * static_cast<std::size_t>(y * kSide + x) + c] =
                        static_cast<float>(0.5 + contrast * (bright - 0.5));
            }
        return picture;
    };
    const double slight = distance(stripes(0.2, 0), stripes(0.2, 0.05)),
                 half = distance(stripes(0.2, 0), stripes(0.2, 0.5));
    EXPECT_LT(slight, 1);
    EXPECT_GT(half, 2);
    EXPECT_GT(distance(stripes(0.6, 0), stripes(0.6, 0.5)), 1.5 * half);
    EXPECT_NEAR(distance(stripes(0.2, 0.5), stripes(0.2, 0)), half, 0.2 * half);
}

TEST(PictureError, HoldsForTheSmallestPictures) {
    for (const auto& [w, h] : {std::pair{1, 1}, {3, 1}, {1, 9}, {8, 8}}) {
        EXPECT_EQ(picture_error(grey(w, h, 0.5F), grey(w, h, 0.5F), w, h).butteraugli, 0) << w << " x " << h;
        EXPECT_GT(picture_error(grey(w, h, 0.2F), grey(w, h, 0.8F), w, h).butteraugli, 5) << w << " x " << h;
    }
}

// Equal means, codes a ± d and a ∓ d in a checkerboard finer than the window: the structures are opposite.
TEST(PictureError, SsimOfOppositeStructuresIsNegative) {
    constexpr int kSide = 32;
    auto a = grey(kSide, kSide, 0.2f), b = grey(kSide, kSide, 0.2f);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
            for (std::size_t c = 0; c < 3; ++c) {
                const auto i = 4 * static_cast<std::size_t>(y * kSide + x) + c;
                ((x + y) % 2 == 0 ? a : b)[i] = 0.8f;
            }
    EXPECT_LT(picture_error(a, b, kSide, kSide).ssim, -0.9);
}

TEST(Silhouettes, AreJumpsOfDepthAndNoSlopes) {
    constexpr int kWidth = 24, kHeight = 16;
    std::vector<float> depth(kWidth * kHeight);
    // flat ground towards the horizon above row 4, then sky; in front of it a post of one column
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            depth[static_cast<std::size_t>(y * kWidth + x)] =
                y > 4 ? 100.0f / static_cast<float>(y - 4) : std::numeric_limits<float>::infinity();
    const std::vector<int> plain = silhouette_distance(depth, kWidth, kHeight, Projection::Perspective);
    for (const int d : plain) EXPECT_EQ(d, kWidth + kHeight);
    for (int y = 0; y < kHeight; ++y) depth[static_cast<std::size_t>(y * kWidth + 10)] = 2;
    const std::vector<int> post = silhouette_distance(depth, kWidth, kHeight, Projection::Perspective);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const int beside = std::max(0, std::abs(x - 10) - 1);  // the post and its neighbours are beside the edge
            EXPECT_EQ(post[static_cast<std::size_t>(y * kWidth + x)], beside) << x << ", " << y;
        }
    // On a plane the depths are linear in x for parallel rays. In perspective the inverse depths are.
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            depth[static_cast<std::size_t>(y * kWidth + x)] = 1 + 2 * static_cast<float>(x);
    for (const int d : silhouette_distance(depth, kWidth, kHeight, Projection::Orthographic))
        EXPECT_EQ(d, kWidth + kHeight);
    EXPECT_EQ(silhouette_distance(depth, kWidth, kHeight, Projection::Perspective).front(), 0);
}

ModelResult result(const std::string& name, double seconds, double p95) {
    ModelResult m;
    m.name = name;
    m.map_seconds = seconds;
    m.all.count = 1;
    m.all.p95 = p95;
    return m;
}

TEST(Frontier, KeepsWhatNoOtherBeats) {
    Comparison c;
    c.picture_seconds = 10;
    c.models = {result("none", 0, 1),         result("slow", 0.5, 0.01),  result("bad", 0.001, 2),
                result("quick", 0.002, 0.3),  result("beaten", 0.3, 0.3), result("also beaten", 0.6, 0.02),
                result("middle", 0.01, 0.05), result("refused", 0, 0)};
    c.models.back().refusal = "does not suit";
    EXPECT_EQ(efficient(c), (std::vector<std::size_t>{3, 6, 1}));
    const std::string svg = frontier_svg(c);
    EXPECT_NE(svg.find("quick: 0.300 px, 2.00 ms"), std::string::npos);
    EXPECT_EQ(svg.find("refused"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(HeatMap, ScaleEndsAtAReadableNumber) {
    EXPECT_NEAR(scale_end(0), 0.001, 1e-12);
    EXPECT_NEAR(scale_end(0.0011), 0.002, 1e-12);
    EXPECT_NEAR(scale_end(0.003), 0.005, 1e-12);
    EXPECT_NEAR(scale_end(0.7), 1, 1e-12);
    EXPECT_NEAR(scale_end(30), 50, 1e-9);
}

TEST(HeatMap, GrowsBrighterAndMarksWhatHasNoAnswer) {
    const std::vector<float> error{0, 0.25f, 0.5f, 0.75f, 1, 7, -1, 0};
    const LinearImage image = heat_map(error, 8, 1, 1);
    EXPECT_EQ(image.data.height, 1 + kScaleHeight);
    const auto luma = [&](std::size_t i) { return image.pixels[4 * i] + image.pixels[4 * i + 1]; };
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(luma(i), luma(i + 1));
    EXPECT_EQ(luma(4), luma(5));
    EXPECT_GT(image.pixels[4 * 6 + 1], image.pixels[4 * 6]) << "greenish";
}

/// Whether each tag of a document is closed, in order; text between may be anything but a lone '<'.
bool well_formed(const std::string& html) {
    std::vector<std::string> open;
    for (std::size_t i = html.find('<'); i != std::string::npos; i = html.find('<', i + 1)) {
        const std::size_t end = html.find('>', i);
        if (end == std::string::npos) return false;
        const std::string tag = html.substr(i + 1, end - i - 1);
        i = end;
        if (tag.front() == '!' || tag.back() == '/') continue;
        if (tag.front() != '/') {
            open.push_back(tag.substr(0, tag.find_first_of(" \n")));
            if (open.back() == "script") i = html.find("</script", i) - 1;
            continue;
        }
        if (open.empty() || open.back() != tag.substr(1)) return false;
        open.pop_back();
    }
    return open.empty();
}

TEST(Page, IsWellFormedAndNeedsNothingElse) {
    Comparison c;
    c.scene = "a <b> & \"c\".toml";
    c.width = 64;
    c.height = 32;
    c.frames = {3, 4};
    c.picture_seconds = 1;
    c.models = {result("none", 0, 1), result("screens", 0.01, 0.1), result("table", 0, 0)};
    c.models.back().refusal = "needs form=\"lattice\" & more";
    const PagePicture plate{"plate", "bytes", false, 0}, heat{"error: screens", "more", false, 0.5};
    const std::string page = comparison_page(c, {{3, {plate}}, {4, {plate, heat}}});
    EXPECT_TRUE(well_formed(page));
    EXPECT_FALSE(well_formed(page + "<p>"));
    EXPECT_EQ(page.find("http"), page.find("http://www.w3.org/1999/xhtml")) << "names of markup, no addresses";
    for (const char* outside : {"src=\"http", "href=", "url(", "@import", "//cdn"})
        EXPECT_EQ(page.find(outside), std::string::npos) << outside;
    EXPECT_NE(page.find("data:image/png;base64,Ynl0ZXM="), std::string::npos);
    EXPECT_NE(page.find("a &lt;b&gt; &amp; &quot;c&quot;.toml"), std::string::npos);
    EXPECT_NE(page.find("needs form=&quot;lattice&quot; &amp; more"), std::string::npos);
    EXPECT_NE(page.find("from frame to frame"), std::string::npos);
    EXPECT_NE(page.find("data-frame=\"3\">"), std::string::npos) << "the first frame is seen";
    EXPECT_NE(page.find("data-frame=\"4\" hidden"), std::string::npos);
    EXPECT_EQ(comparison_page(c, {{3, {plate}}}).find("class=\"frame\""), std::string::npos) << "nothing to choose";
}

TEST(Page, ShowsFramesEvenlySpread) {
    for (const std::size_t count : {std::size_t{1}, std::size_t{2}, kMostPageFrames, kMostPageFrames + 1,
                                    2 * kMostPageFrames, std::size_t{1000}}) {
        std::vector<std::size_t> shown;
        for (std::size_t i = 0; i < count; ++i)
            if (on_page(i, count)) shown.push_back(i);
        ASSERT_EQ(shown.size(), std::min(count, kMostPageFrames)) << count;
        EXPECT_EQ(shown.front(), 0u);
        EXPECT_EQ(shown.back(), count - 1);
        const double even =
            static_cast<double>(count - 1) / static_cast<double>(std::max<std::size_t>(shown.size() - 1, 1));
        for (std::size_t k = 0; k < shown.size(); ++k)
            EXPECT_NEAR(static_cast<double>(shown[k]), static_cast<double>(k) * even, 1);
    }
}

TEST(Table, HasARowForEachModelThatApplies) {
    Comparison c;
    c.frames = {1};
    c.picture_seconds = 1;
    c.models = {result("none", 0, 1), result("screens", 0.01, 0.125), result("table", 0, 0)};
    c.models[1].is_default = true;
    c.models[1].picture.psnr = std::numeric_limits<double>::infinity();
    c.models[2].refusal = "no";
    const std::string csv = table_csv(c);
    EXPECT_TRUE(csv.starts_with("model,default,mean,p50,p95,p99,max,stated_p95,smooth_mean,")) << csv;
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
    EXPECT_NE(csv.find("\nscreens,1,0,0,0.125,"), std::string::npos) << csv;
    EXPECT_EQ(csv.find("inf"), std::string::npos) << csv;
    EXPECT_TRUE(csv.ends_with(",100\n")) << csv;
    EXPECT_NE(table_text(c).find("table does not apply: no"), std::string::npos);
    EXPECT_EQ(readable(0.0123456), "0.0123");
    EXPECT_EQ(readable(123456), "123456");
    EXPECT_EQ(readable(0), "0");
}

Scene wall() {
    Scene scene;
    scene.file = "wall.toml";
    scene.camera.resolution = {24, 16};
    scene.camera.horizontal_fov = 20;
    scene.plate.far = 20;
    ObjectSpec object;
    object.shape = ObjectShape::Quad;
    object.origin = {0, 1.5, -10};
    object.normal = {0, 0, 1};
    object.size = {30, 30};
    scene.objects = {object};
    return scene;
}

CompareSettings one_sample() {
    CompareSettings settings;
    settings.samples = 1;
    return settings;
}

TEST(Comparer, WithoutAirNothingDiffers) {
    Comparer comparer(wall(), one_sample());
    comparer.add(1);
    comparer.add(2);
    const Comparison c = comparer.result();
    EXPECT_EQ(c.frames, (std::vector{1, 2}));
    EXPECT_EQ(c.rms, 0);
    EXPECT_EQ(c.trapped, 0);
    int rows = 0;
    for (const ModelResult& m : c.models) {
        if (!m.applies()) continue;
        ++rows;
        EXPECT_EQ(m.all.count, 2u * 24 * 16) << m.name;
        EXPECT_EQ(m.all.largest, 0) << m.name;
        EXPECT_EQ(m.temporal.largest, 0) << m.name;
        EXPECT_TRUE(std::isinf(m.picture.psnr)) << m.name;
        EXPECT_EQ(m.picture.butteraugli, 0) << m.name;
    }
    EXPECT_EQ(rows, 2) << "none and default";
    EXPECT_GT(c.tracer_seconds, 0);
}

// Strong air. Second order gives what the tracer gives, and the error that the warp states is true.
TEST(Comparer, SecondOrderIsTheTruthAndStatedErrorsHold) {
    Scene scene = wall();
    scene.optics.exaggeration = 300;
    BlobsSpec blobs;
    blobs.blobs = {{{0.2, 1.6, -5}, 0.4, 900}, {{-0.3, 1.4, -6}, 0.3, 700}};
    scene.media = {blobs};
    Comparer comparer(scene, one_sample());
    comparer.add(1);
    const Comparison c = comparer.result();
    ASSERT_GT(c.rms, 0.1);
    for (const ModelResult& m : c.models) {
        if (m.name == "second-order") {
            EXPECT_LT(m.all.p95, 3e-3 * c.rms);
        } else if (m.name == "first-order") {
            EXPECT_GT(m.all.p95, 0.01 * c.rms);
            EXPECT_LT(*m.stated_p95, 2 * m.all.p95);
            EXPECT_GT(*m.stated_p95, 0.5 * m.all.p95);
        }
    }
}

// Weak air. The second order is negligible. What counts is the lattice's spline, which the map and its judge share.
TEST(Comparer, StatedErrorsHoldInWeakLattices) {
    Scene scene = wall();
    TurbulenceSpec air;
    air.form = TurbulenceForm::Lattice;
    air.cn2 = 1e-9;
    air.outer_scale = 1;
    air.inner_scale = 0.4;
    air.lattice = {32, 32, 32, 2};
    air.period = {8, 8, 8, 1};
    scene.media = {air};
    Comparer comparer(scene, one_sample());
    comparer.add(1);
    const Comparison c = comparer.result();
    ASSERT_LT(c.rms, 0.1);
    int orders = 0;
    for (const ModelResult& m : c.models) {
        if (m.name != "second-order" && !m.name.starts_with("first-order")) continue;
        ++orders;
        EXPECT_LT(*m.stated_p95, 2 * m.all.p95) << m.name;
        EXPECT_GT(*m.stated_p95, 0.5 * m.all.p95) << m.name;
    }
    EXPECT_EQ(orders, 2);
}

TEST(Comparer, ABlobIsFollowedByTheDefaultAndNotByThePlate) {
    Scene scene = wall();
    scene.optics.exaggeration = 30;
    BlobsSpec blobs;
    blobs.blobs = {{{0.2, 1.6, -5}, 0.4, 900}};
    scene.media = {blobs};
    Comparer comparer(scene, one_sample());
    const Comparer::Frame& frame = comparer.add(1);
    ASSERT_EQ(frame.models.front().error.size(), 24u * 16);
    const Comparison c = comparer.result();
    const auto row = [&](std::string_view name) {
        return *std::find_if(c.models.begin(), c.models.end(), [&](const ModelResult& m) { return m.name == name; });
    };
    // The error of the plate is the true displacement itself.
    for (std::size_t i = 0; i < frame.truth.u.size(); ++i)
        ASSERT_NEAR(frame.models.front().error[i], std::hypot(frame.truth.u[i], frame.truth.v[i]), 1e-6);
    EXPECT_NEAR(row("none").all.largest, c.largest, 1e-6);
    ASSERT_GT(c.rms, 0.02);
    EXPECT_TRUE(row("first-order").is_default);
    EXPECT_LT(row("first-order").all.p95, 0.05 * row("none").all.p95);
    EXPECT_FALSE(row("screens").applies());
    EXPECT_NE(row("screens").refusal.find("screens"), std::string::npos);
    EXPECT_GT(row("first-order").seconds(), 0);
}

TEST(Comparer, WrongModelsAreNamed) {
    const auto says = [](std::vector<std::string> models) {
        CompareSettings settings = one_sample();
        settings.models = std::move(models);
        Scene scene = wall();
        BlobsSpec blobs;
        blobs.blobs = {{.center = {0, 1.5, -5}, .sigma = 0.5, .temperature = 900}};
        scene.media = {blobs};
        try {
            Comparer(scene, settings);
        } catch (const UserError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_NE(says({"screen"}).find("did you mean 'screens'"), std::string::npos) << says({"screen"});
    EXPECT_NE(says({"spectral"}).find("spectral"), std::string::npos);
    EXPECT_EQ(says({"spectral", "first-order"}), "");
}

}  // namespace
}  // namespace eikonal::reference
