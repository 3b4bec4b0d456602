/// A kind of medium that was added in one folder and one line works everywhere: in scene files, in the warp by every
/// model that takes any medium, in the tracer, in `eikonal field` and in `compare`.
#include <fmt/format.h>

#include <cmath>

#include "noise/blobs/blob_kernel.h"
#include "tests/noise/medium/puff/puff_spec.h"
#include "tests/programs/program_run.h"
#include "warp/displace/displacer.h"
#include "warp/displace/media/any_medium/any_medium_bend.h"

namespace {

using namespace eikonal;
using program_test::Ended;
using program_test::Pixels;
using program_test::Program;

constexpr int kWide = 96, kHigh = 54;
constexpr double kDistance = 6;

Scene puff_scene() {
    PuffSpec puff;
    puff.center = {0.1, 1.45, -3};
    puff.size = 0.3;
    puff.index = -4e-4;
    Scene scene;
    scene.camera.horizontal_fov = 30;
    scene.media = {puff};
    return scene;
}

DisplacerSettings settings_of(std::optional<Model> model = {}) {
    DisplacerSettings settings;
    settings.width = kWide;
    settings.height = kHigh;
    settings.far = kDistance;
    settings.model = model;
    return settings;
}

/// Displacement of a pixel by the closed form of one blob, in double precision.
dvec2 closed_form(const Camera& camera, const PuffSpec& puff, int x, int y) {
    const StraightRay ray = straight_ray(camera, x + 0.5, y + 0.5);
    const Perturbation bend =
        perturb({puff.center, puff.size, puff.index}, ray.origin, ray.direction / ray.length, kDistance * ray.length);
    return image_shift(camera, ray, bend.x1) / kDistance;
}

// Eq. 7 has a closed form for a Gaussian. The default bend, which is an integral, is compared with it.
TEST(Puff, IsWarpedWithinTheStatedErrorOfTheDefaultBend) {
    const Scene scene = puff_scene();
    const auto& puff = *scene.media[0].get_if<PuffSpec>();
    for (const Model model : {Model::FirstOrder, Model::SecondOrder}) {
        const Displacer displacer(scene, settings_of(model));
        std::vector<float> uv(2 * kWide * kHigh);
        displacer.at(1, kDistance, kDistance).map({0, 0, kWide, kHigh}, kDistance, DepthMeeting::Own, uv.data());
        const Camera camera = displacer.camera(1);
        double error = 0, square = 0;
        for (int y = 0; y < kHigh; ++y)
            for (int x = 0; x < kWide; ++x) {
                const dvec2 d = closed_form(camera, puff, x, y);
                const std::size_t i = 2 * static_cast<std::size_t>(y * kWide + x);
                error += std::pow(uv[i] - d.x, 2) + std::pow(uv[i + 1] - d.y, 2);
                square += glm::dot(d, d);
            }
        EXPECT_GT(std::sqrt(square / (kWide * kHigh)), 0.02) << "the scene moves something";
        EXPECT_LE(std::sqrt(error / square), kAnyMediumError) << name_of(model);
    }
}

TEST(Puff, SaysHowStrongItIs) {
    const Displacer displacer(puff_scene(), settings_of());
    std::vector<float> uv(2 * kWide * kHigh);
    displacer.at(1, kDistance, kDistance).map({0, 0, kWide, kHigh}, kDistance, DepthMeeting::Own, uv.data());
    double square = 0;
    for (const float v : uv) square += double{v} * v;
    const double rms = std::sqrt(square / (kWide * kHigh));
    EXPECT_NEAR(displacer.expected_rms(kDistance), rms, 0.3 * rms);
    ASSERT_EQ(displacer.notes().size(), 1u);
    EXPECT_NE(displacer.notes()[0].find("a puff"), std::string::npos) << displacer.notes()[0];
}

class PuffProgram : public Program {
  protected:
    PuffProgram() {
        write_text(
            "puff.toml",
            fmt::format("[camera]\nresolution = [{}, {}]\nhorizontal_fov = 30\n[plate]\nfar = {}\n"
                        "[[medium]]\ntype = \"puff\"\ncenter = [0.1, 1.45, -3]\nsize = 0.3\nindex = -4e-5\n"
                        "[[object]]\nshape = \"quad\"\norigin = [0, 1.5, -{}]\nnormal = [0, 0, 1]\nsize = [9, 9]\n",
                        kWide, kHigh, kDistance, kDistance));
    }
    Ended warp(program_test::Words words) const {
        words.insert(words.begin(), EIKONAL_PUFF_PROGRAM);
        return tool(std::move(words));
    }
    Ended trace(program_test::Words words) const {
        words.insert(words.begin(), EIKONAL_PUFF_TRACE_PROGRAM);
        return tool(std::move(words));
    }
};

TEST_F(PuffProgram, MapsTracesComparesAndShowsTheField) {
    const Ended map = warp({"map", "--scene", "puff.toml", "-o", "map.exr", "--progress", "none"});
    ASSERT_EQ(map.status, 0) << map.err;
    const Ended render = trace({"render", "puff.toml", "-o", "truth.exr", "--samples", "1"});
    ASSERT_EQ(render.status, 0) << render.err;
    const Pixels warped = read("map.exr"), truth = read("truth.exr");
    const int u = truth.channel("u"), v = truth.channel("v");
    double error = 0, square = 0;
    for (int y = 0; y < kHigh; ++y)
        for (int x = 0; x < kWide; ++x) {
            error += std::pow(warped.at(x, y, 0) - truth.at(x, y, u), 2) +
                     std::pow(warped.at(x, y, 1) - truth.at(x, y, v), 2);
            square += std::pow(truth.at(x, y, u), 2) + std::pow(truth.at(x, y, v), 2);
        }
    EXPECT_LE(std::sqrt(error / square), 0.03) << "the warp against bent rays, its second order included";

    const Ended field = warp({"field", "--scene", "puff.toml", "-o", "field.####.exr"});
    ASSERT_EQ(field.status, 0) << field.err;
    EXPECT_NEAR(read("field.0032.exr").at(32, 31, 0), -4e-5, 4e-7) << "the middle of the puff";

    const Ended compare = trace({"compare", "puff.toml", "-o", "page", "--samples", "1", "--models", "first-order"});
    ASSERT_EQ(compare.status, 0) << compare.err;
    EXPECT_NE(compare.out.find("first-order"), std::string::npos);
}

TEST_F(PuffProgram, AnswersForItsKeysAsAnyMedium) {
    const Ended wrong =
        warp({"map", "--scene", "puff.toml", "--set", "medium.0.size=-1", "-o", "map.exr", "--progress", "none"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_NE(wrong.err.find("medium.0.size"), std::string::npos) << wrong.err;
    EXPECT_NE(wrong.err.find("> 0"), std::string::npos) << wrong.err;
    const Ended still =
        warp({"map", "--scene", "puff.toml", "--set", "medium.0.index=0", "-o", "map.exr", "--progress", "none", "-v"});
    EXPECT_EQ(still.status, 0);
    EXPECT_NE(still.err.find("left out, its index is the ambient's"), std::string::npos) << still.err;
}

}  // namespace
