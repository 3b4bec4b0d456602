// The scene reader: every key, every kind of mistake and its message, --set, seeds, presets.
// Length: the list of wrong scenes with their messages is long.
#include "warp/scene/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <glm/geometric.hpp>

#include "noise/base/error.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/medium/optics.h"
#include "noise/profile/profile_spec.h"
#include "noise/surface/surface_spec.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "warp/scene/background.h"

namespace eikonal {
namespace {

Scene parse(const std::string& text, const std::vector<std::string>& settings = {}) {
    return parse_scene(text, "shots/scene.toml", settings);
}

std::string error_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const UserError& error) {
        return error.what();
    }
    return "no error";
}

std::string parse_error(const std::string& text, const std::vector<std::string>& settings = {}) {
    return error_of([&] { parse_scene(text, "scene.toml", settings); });
}

template <class T>
const T& medium(const Scene& scene, std::size_t i = 0) {
    return *scene.media.at(i).get_if<T>();
}

const std::string kTurbulence = "[[medium]]\ntype = \"turbulence\"\n";

TEST(Scene, EmptyFileIsTheDefaultSceneAndMovesNothing) {
    for (const char* text : {"", "\n", "# only a comment", "\xef\xbb\xbf"}) {
        const Scene s = parse(text);
        EXPECT_TRUE(s.media.empty());
        EXPECT_FALSE(s.light);
        EXPECT_EQ(s.camera.position, CameraSpec{}.position);
        EXPECT_EQ(s.camera.look_at, CameraSpec{}.look_at);
        EXPECT_EQ(s.file, "shots/scene.toml");
    }
}

TEST(Scene, CameraTimeOpticsPlate) {
    const Scene s = parse(R"(
        [camera]
        resolution = [1280, 720]
        position = [1, 2.5, 3]
        look_at = [0, 0, 0]
        up = [0, 0, 1]
        focal_length = 300
        sensor_width = 24.9
        path = "moves.chan"
        [time]
        fps = 25
        first_frame = -10
        [optics]
        ray_equation = "paper"
        ambient_temperature = 273
        index = "paper"
        exaggeration = -2
        aperture = 0.05
        [plate]
        far = 5000
        ground = [2, 0.4])");
    EXPECT_EQ(*s.camera.resolution, (std::array{1280, 720}));
    EXPECT_EQ(s.camera.position, dvec3(1, 2.5, 3));
    EXPECT_EQ(s.camera.look_at, dvec3(0, 0, 0));
    EXPECT_EQ(s.camera.up, dvec3(0, 0, 1));
    EXPECT_EQ(*s.camera.focal_length, 300);
    EXPECT_EQ(*s.camera.sensor_width, 24.9);
    EXPECT_EQ(*s.camera.path, "shots/moves.chan");
    EXPECT_EQ(*s.time.fps, 25);
    EXPECT_EQ(s.time.first_frame, -10);
    EXPECT_EQ(s.optics.ray_equation, RayEquation::Paper);
    EXPECT_EQ(s.optics.ambient_temperature, 273);
    EXPECT_EQ(s.optics.index, IndexModel::Paper);
    EXPECT_EQ(s.optics.exaggeration, -2);
    EXPECT_EQ(s.optics.aperture, 0.05);
    EXPECT_EQ(*s.plate.far, 5000);
    EXPECT_EQ(*s.plate.ground, (std::array{2.0, 0.4}));
    EXPECT_EQ(*parse("plate.distance = 300").plate.distance, 300);
    EXPECT_EQ(*parse("camera.horizontal_fov = 7.5").camera.horizontal_fov, 7.5);
    const Scene o = parse("[camera]\nprojection = \"orthographic\"\nwidth = 3");
    EXPECT_EQ(o.camera.projection, Projection::Orthographic);
    EXPECT_EQ(o.camera.width, 3);
    EXPECT_EQ(parse("camera.position = [7, 8, 9]").camera.look_at, dvec3(7, 8, 8));
}

TEST(Scene, Turbulence) {
    const Scene s = parse(kTurbulence + R"(
        cn2 = 3e-13
        outer_scale = 2
        inner_scale = 0.01
        alpha = 0
        velocity = [1, 0, -1]
        form = "lattice"
        falloff = {origin = [0, 1, 0], normal = [0, 3, 4], length = 2}
        lattice = [64, 63, 65, 16]
        period = [8, 8.5, 8, 10]
        [[medium]]
        type = "turbulence"
        spectrum = "paper"
        strength = 1e-11
        lowest_wavenumber = 3)");
    const auto& t = medium<TurbulenceSpec>(s);
    EXPECT_EQ(t.spectrum, SpectrumKind::VonKarman);
    EXPECT_EQ(t.cn2, 3e-13);
    EXPECT_EQ(t.outer_scale, 2);
    EXPECT_EQ(t.inner_scale, 0.01);
    EXPECT_EQ(t.alpha, 0);
    EXPECT_EQ(t.velocity, dvec3(1, 0, -1));
    EXPECT_EQ(t.form, TurbulenceForm::Lattice);
    EXPECT_EQ(t.falloff->origin, dvec3(0, 1, 0));
    EXPECT_NEAR(glm::distance(t.falloff->normal, dvec3(0, 0.6, 0.8)), 0, 1e-15);
    EXPECT_EQ(t.falloff->length, 2);
    EXPECT_EQ(*t.lattice, (std::array{64, 63, 65, 16}));
    EXPECT_EQ(*t.period, (std::array{8.0, 8.5, 8.0, 10.0}));
    const auto& p = medium<TurbulenceSpec>(s, 1);
    EXPECT_EQ(p.spectrum, SpectrumKind::Paper);
    EXPECT_EQ(p.strength, 1e-11);
    EXPECT_EQ(p.lowest_wavenumber, 3);
    EXPECT_EQ(medium<TurbulenceSpec>(parse(kTurbulence + "form = \"gradient-noise\"")).form,
              TurbulenceForm::GradientNoise);
    EXPECT_EQ(medium<TurbulenceSpec>(parse(kTurbulence + "cn2 = 0")).cn2, 0);
}

TEST(Scene, SurfaceBlobsProfile) {
    const Scene s = parse(R"(
        [[medium]]
        type = "surface"
        origin = [0, 1, 0]
        normal = [0, 0, 2]
        surface_temperature = 320
        dropoff = 0.02
        [[medium]]
        type = "blobs"
        blob = [{center = [1, 2, 3], sigma = 0.2, temperature = 900}, {}]
        source = [{from = [0, 0, 0], to = [1, 0, 0], rate = 20, temperature = 1100, sigma = 0.3, cooling = 0.5, lifetime = 4}]
        wind = {seed = 5, rms = 0.7, outer_scale = 2, rise = [0, 2, 0]})");
    const auto& surface = medium<SurfaceSpec>(s);
    EXPECT_EQ(surface.origin, dvec3(0, 1, 0));
    EXPECT_EQ(surface.normal, dvec3(0, 0, 1));
    EXPECT_EQ(surface.surface_temperature, 320);
    EXPECT_EQ(surface.dropoff, 0.02);
    const auto& blobs = medium<BlobsSpec>(s, 1);
    ASSERT_EQ(blobs.blobs.size(), 2u);
    EXPECT_EQ(blobs.blobs[0].center, dvec3(1, 2, 3));
    EXPECT_EQ(blobs.blobs[0].temperature, 900);
    EXPECT_EQ(blobs.blobs[1].sigma, BlobSpec{}.sigma);
    ASSERT_EQ(blobs.sources.size(), 1u);
    EXPECT_EQ(blobs.sources[0].to, std::optional(dvec3(1, 0, 0)));
    EXPECT_EQ(blobs.sources[0].lifetime, 4);
    EXPECT_FALSE(medium<BlobsSpec>(parse("[[medium]]\ntype = \"blobs\"\nsource = [{from = [0, 1, 2], lifetime = 1}]"))
                     .sources[0]
                     .to);
    EXPECT_EQ(blobs.wind->rms, 0.7);
    EXPECT_EQ(blobs.wind->rise, dvec3(0, 2, 0));
    EXPECT_TRUE(medium<BlobsSpec>(parse("[[medium]]\ntype = \"blobs\"\nblob = []")).blobs.empty());

    const std::pair<const char*, ProfileKind> kinds[] = {{"luneburg", ProfileKind::Luneburg},
                                                         {"fish-eye", ProfileKind::FishEye},
                                                         {"linear", ProfileKind::Linear},
                                                         {"linear-squared", ProfileKind::LinearSquared},
                                                         {"exponential", ProfileKind::Exponential},
                                                         {"rod", ProfileKind::Rod},
                                                         {"sech", ProfileKind::Sech}};
    for (const auto& [name, kind] : kinds) {
        const Scene p =
            parse("[[medium]]\ntype = \"profile\"\ncenter = [1, 0, 0]\nprofile = \"" + std::string(name) + '"');
        EXPECT_EQ(medium<ProfileSpec>(p).profile, kind);
    }
    const auto rod = medium<ProfileSpec>(parse("[[medium]]\ntype='profile'\nprofile='rod'\nn0=1.5\ng=2\naxis=[0,0,9]"));
    EXPECT_EQ(rod.n0, 1.5);
    EXPECT_EQ(rod.g, 2);
    EXPECT_EQ(rod.axis, dvec3(0, 0, 1));
}

TEST(Scene, ObjectsLightBackground) {
    const Scene s = parse(R"(
        [[object]]
        texture = "road.png"
        size = [4, 4]
        up = [0, 0, -1]
        [[object]]
        shape = "quad"
        name = "board"
        origin = [0, 1, -50]
        normal = [0, 0, 1]
        color = [1, 0, 0]
        emissive = true
        [[object]]
        shape = "sphere"
        center = [0, 1, 0]
        radius = 2
        [[object]]
        shape = "mesh"
        file = "/models/car.obj"
        scale = 0.01
        [light]
        direction = [0, -2, 0]
        color = [3, 3, 3]
        ambient = [0, 0, 0]
        [background]
        image = "sky.exr")");
    ASSERT_EQ(s.objects.size(), 4u);
    EXPECT_EQ(s.objects[0].shape, ObjectShape::Plane);
    EXPECT_EQ(*s.objects[0].texture, "shots/road.png");
    EXPECT_EQ(*s.objects[0].up, dvec3(0, 0, -1));
    EXPECT_EQ(s.objects[1].name, "board");
    EXPECT_TRUE(s.objects[1].emissive);
    EXPECT_EQ(s.objects[1].color, dvec3(1, 0, 0));
    EXPECT_EQ(s.objects[2].radius, 2);
    EXPECT_EQ(*s.objects[3].file, "/models/car.obj");
    EXPECT_EQ(s.light->direction, dvec3(0, -1, 0));
    EXPECT_EQ(*s.background.image, "shots/sky.exr");
}

TEST(SceneErrors, UnknownKeysNameTheNearest) {
    EXPECT_EQ(parse_error("[camera]\nfov = 3"),
              "scene.toml:2: unknown key 'fov' in camera; valid: resolution, position, look_at, up, horizontal_fov, "
              "focal_length, sensor_width, projection, width, path");
    EXPECT_EQ(parse_error(kTurbulence + "cn3 = 1"),
              "scene.toml:3: medium.0 of type \"turbulence\" has no key 'cn3'; did you mean 'cn2'?");
    EXPECT_EQ(parse_error("[[medum]]\n"), "scene.toml:1: unknown key 'medum'; did you mean 'medium'?");
    EXPECT_EQ(parse_error(kTurbulence + "falloff = {orgin = [0,0,0]}"),
              "scene.toml:3: unknown key 'orgin' in medium.0.falloff; did you mean 'origin'?");
    EXPECT_EQ(parse_error("[[medium]]\ntype = \"blobs\"\nblob = [{}, {simga = 1}]"),
              "scene.toml:3: unknown key 'simga' in medium.0.blob.1; did you mean 'sigma'?");
    EXPECT_EQ(
        parse_error("[[medium]]\ntype = \"surface\"\ncn2 = 1"),
        "scene.toml:3: medium.0 of type \"surface\" has no key 'cn2'; valid: origin, normal, surface_temperature, "
        "dropoff, type");
    EXPECT_EQ(parse_error("[camera]\ntype = 'x'").substr(0, 41), "scene.toml:2: unknown key 'type' in camer");
    EXPECT_EQ(parse_error("\"a\\nb\" = 1").find('\n'), std::string::npos);
}

TEST(SceneErrors, WrongTypesAndRanges) {
    const std::string cn2 = " (Cn² [m^-2/3])";
    EXPECT_EQ(parse_error(kTurbulence + "cn2 = -1"), "scene.toml:3: medium.0.cn2: value -1, must be >= 0" + cn2);
    EXPECT_EQ(parse_error(kTurbulence + "cn2 = nan"), "scene.toml:3: medium.0.cn2: value nan, must be finite" + cn2);
    EXPECT_EQ(parse_error(kTurbulence + "cn2 = inf"), "scene.toml:3: medium.0.cn2: value inf, must be finite" + cn2);
    EXPECT_EQ(parse_error(kTurbulence + "cn2 = \"big\""),
              "scene.toml:3: medium.0.cn2: value 'big', must be a number" + cn2);
    EXPECT_EQ(parse_error(kTurbulence + "cn2 = 1979-05-27"),
              "scene.toml:3: medium.0.cn2: value 1979-05-27, must be a number" + cn2);
    EXPECT_EQ(parse_error(kTurbulence + "inner_scale = 0"),
              "scene.toml:3: medium.0.inner_scale: value 0, must be > 0 (l0, the smallest eddies [m])");
    EXPECT_EQ(parse_error(kTurbulence + "velocity = [1, 2]"),
              "scene.toml:3: medium.0.velocity: value [1, 2], must be an array of 3 numbers (mean motion [m/s])");
    EXPECT_EQ(parse_error(kTurbulence + "velocity = [1, nan, 2]"),
              "scene.toml:3: medium.0.velocity: value [1, nan, 2], must be finite (mean motion [m/s])");
    EXPECT_EQ(parse_error(kTurbulence + "seed = 1.5"),
              "scene.toml:3: medium.0.seed: value 1.5, must be a whole number (of its random numbers)");
    EXPECT_EQ(parse_error("camera = 3"), "scene.toml:1: camera: value 3, must be a table (view)");
    EXPECT_EQ(parse_error("[medium]\ntype = \"turbulence\""),
              "scene.toml:1: medium: value a table, must be an array of tables, written [[medium]] (hot air)");
    EXPECT_EQ(parse_error("medium = [3]"), "scene.toml:1: medium.0: value 3, must be a table (hot air)");
    EXPECT_EQ(
        parse_error("[[medium]]\ncn2 = 0"),
        "scene.toml:1: medium.0: type is missing; must be \"turbulence\" or \"surface\" or \"blobs\" or \"profile\"");
    EXPECT_EQ(parse_error("[[medium]]\ntype = \"turbulense\""),
              "scene.toml:2: medium.0.type: value 'turbulense', must be \"turbulence\" or \"surface\" or \"blobs\" or "
              "\"profile\"; did you mean 'turbulence'? (kind of medium)");
    EXPECT_EQ(
        parse_error("[camera]\nhorizontal_fov = 180"),
        "scene.toml:2: camera.horizontal_fov: value 180, must be >= 1e-06 and <= 179.99 (angle of view [degrees])");
    EXPECT_EQ(parse_error("optics.ambient_temperature = 0"),
              "scene.toml:1: optics.ambient_temperature: value 0, must be >= 1 and <= 1000000000 ([K])");
    EXPECT_EQ(parse_error("time.first_frame = 99999999999"),
              "scene.toml:1: time.first_frame: value 99999999999, must be >= -1000000000 and <= 1000000000 (the frame "
              "at t = 0)");
    EXPECT_NE(parse_error("[[object]]\nemissive = 1").find("must be true or false"), std::string::npos);
    EXPECT_NE(parse_error("background.image = \"\"").find("must be the name of a file"), std::string::npos);
    EXPECT_NE(parse_error("background.image = \"a\\u0000b\"").find("must be the name of a file"), std::string::npos);
    EXPECT_NE(parse_error("camera.position = [1e13, 0, 0]").find("must be <= 1000000000000"), std::string::npos);
}

TEST(SceneErrors, Contradictions) {
    EXPECT_EQ(parse_error("[camera]\nhorizontal_fov = 40\nfocal_length = 50"),
              "scene.toml:2: camera.horizontal_fov: contradicts focal_length; remove one of them");
    EXPECT_EQ(parse_error("[camera]\nsensor_width = 36"), "scene.toml:2: camera.sensor_width: needs focal_length");
    EXPECT_EQ(
        parse_error("[camera]\nwidth = 36"),
        "scene.toml:2: camera.width: applies only with projection = \"orthographic\"; remove it or change projection");
    EXPECT_EQ(parse_error("[camera]\nposition = [0, 1, 0]\nlook_at = [0, 1, 0]"),
              "scene.toml:3: camera.look_at: must differ from position");
    EXPECT_EQ(parse_error("[camera]\nlook_at = [0, -9, 0]"),
              "scene.toml:1: camera.up: must not be zero or parallel to the view");
    EXPECT_EQ(parse_error(kTurbulence + "inner_scale = 2\nouter_scale = 1"),
              "scene.toml:4: medium.0.outer_scale: value 1, must be > inner_scale, 2");
    EXPECT_EQ(parse_error(kTurbulence + "spectrum = \"paper\"\ncn2 = 1e-13"),
              "scene.toml:4: medium.0.cn2: applies only with spectrum = \"von-karman\"; remove it or change spectrum");
    EXPECT_EQ(parse_error(kTurbulence + "strength = 1e-13"),
              "scene.toml:3: medium.0.strength: applies only with spectrum = \"paper\"; remove it or change spectrum");
    EXPECT_EQ(parse_error(kTurbulence + "falloff = {normal = [0, 0, 0]}"),
              "scene.toml:3: medium.0.falloff.normal: must not be a zero vector");
    EXPECT_EQ(parse_error("[plate]\ndistance = 4\nground = [2, 0.5]"),
              "scene.toml:2: plate.distance: contradicts ground; remove one of them");
    EXPECT_EQ(parse_error("[[object]]\ntexture = \"a.png\"\ncolor = [1, 1, 1]"),
              "scene.toml:3: object.0.color: contradicts texture; remove one of them");
    EXPECT_EQ(parse_error("[[object]]\nradius = 2"),
              "scene.toml:2: object.0.radius: applies only with shape = \"sphere\"; remove it or change shape");
    EXPECT_EQ(parse_error("[[object]]\nshape = \"mesh\""),
              "scene.toml:1: object.0.file: is missing; a mesh needs its *.obj file");
    EXPECT_EQ(parse_error("[[medium]]\ntype = \"profile\"\n" + kTurbulence),
              "scene.toml:1: medium: a profile is an absolute index and must be the only medium");
    EXPECT_EQ(parse_error("[[medium]]\ntype = \"profile\"\ng = 2"),
              "scene.toml:3: medium.0.g: applies only with profile = \"rod\" or profile = \"sech\"; remove it or "
              "change profile");
    EXPECT_EQ(parse_error("[background]\ncolor = [0, 0, 0]\nimage = \"a.exr\""),
              "scene.toml:2: background.color: contradicts image; remove one of them");
}

TEST(SceneErrors, ImpossibleLattices) {
    const auto lattice = [](const std::string& sizes) {
        return parse_error(kTurbulence + "form = \"lattice\"\nlattice = " + sizes);
    };
    EXPECT_EQ(lattice("[0, 8, 8, 8]"), "scene.toml:4: medium.0.lattice: size 0 is no lattice; must be >= 2");
    EXPECT_EQ(lattice("[8, 8, 8, 1]"), "scene.toml:4: medium.0.lattice: size 1 is no lattice; must be >= 2");
    EXPECT_EQ(
        lattice("[8, 127, 8, 8]"),
        "scene.toml:4: medium.0.lattice: size 127 has a prime factor above 13, for which there is no fast transform; "
        "use 126 or 128");
    EXPECT_NE(lattice("[34, 8, 8, 8]").find("use 33 or 35"), std::string::npos);
    EXPECT_NE(lattice("[65537, 8, 8, 8]").find("must be >= 0 and <= 65536"), std::string::npos);
    EXPECT_NE(lattice("[-4, 8, 8, 8]").find("must be >= 0 and <= 65536"), std::string::npos);
    EXPECT_NE(lattice("[8, 8, 8]").find("must be an array of 4 whole numbers"), std::string::npos);
    for (const char* good : {"[2, 3, 5, 7]", "[11, 13, 64, 65536]"}) EXPECT_EQ(lattice(good), "no error");
    // The number of screens is no transform size.
    EXPECT_EQ(parse_error(kTurbulence + "lattice = [64, 64, 17, 16]"), "no error");
    EXPECT_EQ(parse_error(kTurbulence + "lattice = [64, 64, 1, 16]"), "no error");
    EXPECT_NE(parse_error(kTurbulence + "lattice = [64, 64, 0, 16]"), "no error");
}

TEST(SceneErrors, SyntaxAndFiles) {
    EXPECT_EQ(parse_error("[camera\nup = 3").substr(0, 14), "scene.toml:1: ");
    EXPECT_EQ(parse_error("\n\ncamera = [1, 2").substr(0, 14), "scene.toml:3: ");
    EXPECT_EQ(parse_error("a = 1\na = 2").substr(0, 14), "scene.toml:2: ");
    EXPECT_EQ(parse_error("\xff = 1").substr(0, 14), "scene.toml:1: ");
    EXPECT_EQ(error_of([] { read_scene("no/such.toml"); }),
              "no/such.toml: cannot read the scene: No such file or directory");
    EXPECT_NE(error_of([] { read_scene("."); }).find("it is a folder"), std::string::npos);
}

// The TOML parser's recursion is bounded before it is entered.
TEST(SceneErrors, DeepKeysAndValues) {
    std::string deep = "[a";
    for (int i = 0; i < 500000; ++i) deep += ".a";
    EXPECT_EQ(parse_error("\n" + deep + "]"), "scene.toml:2: more than 2000 dots in keys and text; shorten the file");
    std::string numbers = "[1";
    for (int i = 0; i < 500000; ++i) numbers += ".1";
    EXPECT_NE(parse_error(numbers + "]").find("more than 2000 dots"), std::string::npos);
    EXPECT_EQ(parse_error("a = " + std::string(100000, '[')).substr(0, 14), "scene.toml:1: ");
    std::string blobs = "[[medium]]\ntype = \"blobs\"\nblob = [";
    for (int i = 0; i < 5000; ++i) blobs += "{center = [0.5, -1.25, 1.0], sigma = 0.1},\n";
    EXPECT_EQ(parse_error(blobs + "]"), "no error");
    EXPECT_EQ(error_of([&] { parse("", {deep.substr(1) + "=1"}); }).substr(0, 9), "`set` a.a");
    EXPECT_NE(error_of([&] { parse("", {"camera={" + deep.substr(1) + "=1}"}); }), "no error");
}

TEST(SceneSet, ChangesAddsAndRemoves) {
    const std::string text = kTurbulence + "cn2 = 1e-14\nfalloff = {length = 3}\n";
    const auto turbulence = [&](const std::vector<std::string>& settings) {
        return medium<TurbulenceSpec>(parse(text, settings));
    };
    EXPECT_EQ(turbulence({"medium.0.cn2=1e-13"}).cn2, 1e-13);
    EXPECT_EQ(turbulence({"medium.0.cn2=1e-13", "medium.0.cn2=2e-13"}).cn2, 2e-13);
    EXPECT_EQ(turbulence({" medium.0.cn2 = 2 "}).cn2, 2);
    EXPECT_EQ(turbulence({"medium.0.falloff.length=9"}).falloff->length, 9);
    EXPECT_FALSE(turbulence({"medium.0.falloff="}).falloff);
    EXPECT_EQ(turbulence({"medium.0.form=lattice"}).form, TurbulenceForm::Lattice);
    EXPECT_EQ(turbulence({"medium.0.form=\"lattice\""}).form, TurbulenceForm::Lattice);
    EXPECT_EQ(turbulence({"medium.0.velocity=[1, 2, 3]"}).velocity, dvec3(1, 2, 3));
    EXPECT_EQ(turbulence({"medium.0.velocity=[1, 2, 3]", "medium.0.velocity.1=7"}).velocity, dvec3(1, 7, 3));
    EXPECT_EQ(turbulence({"medium.0.cn2=", "medium.0.spectrum=paper", "medium.0.strength=5"}).strength, 5);

    Scene s = parse("", {"medium.0.type=turbulence", "medium.0.cn2=3e-13", "plate.distance=40", "camera.path=1.chan"});
    EXPECT_EQ(medium<TurbulenceSpec>(s).cn2, 3e-13);
    EXPECT_EQ(*s.plate.distance, 40);
    EXPECT_EQ(*s.camera.path, "1.chan");
    s = parse(text, {"medium.1={type = \"surface\", dropoff = 0.5}"});
    EXPECT_EQ(medium<SurfaceSpec>(s, 1).dropoff, 0.5);
    EXPECT_TRUE(parse(text, {"medium.0="}).media.empty());
    EXPECT_TRUE(parse(text, {"medium=[]"}).media.empty());
}

TEST(SceneSet, ErrorsNameTheOption) {
    const std::string text = kTurbulence;
    EXPECT_EQ(parse_error(text, {"medium.0.cn3=1"}),
              "`set` medium.0.cn3=1: medium.0 of type \"turbulence\" has no key 'cn3'; did you mean 'cn2'?");
    EXPECT_EQ(parse_error(text, {"medium.0.cn2=-1"}),
              "`set` medium.0.cn2=-1: medium.0.cn2: value -1, must be >= 0 (Cn² [m^-2/3])");
    EXPECT_EQ(parse_error(text, {"medium.0.cn2=1e-13x"}),
              "`set` medium.0.cn2=1e-13x: medium.0.cn2: value '1e-13x', must be a number (Cn² [m^-2/3])");
    EXPECT_EQ(parse_error(text, {"medium.3.cn2=1"}),
              "`set` medium.3.cn2=1: '3' is no element of medium, which has 1; the next is 1");
    EXPECT_EQ(parse_error(text, {"medium.first.cn2=1"}),
              "`set` medium.first.cn2=1: 'first' is no element of medium, which has 1; the next is 1");
    EXPECT_EQ(parse_error(text, {"medium.0.type.x=1"}),
              "`set` medium.0.type.x=1: medium.0.type is no table and has no 'x'");
    EXPECT_EQ(parse_error(text, {"cn2"}), "`set` cn2: must be KEY=VALUE, such as medium.0.cn2=1e-13");
    EXPECT_EQ(parse_error(text, {"=3"}), "`set` =3: a part of the key is empty");
    EXPECT_EQ(parse_error(text, {"a..b=3"}), "`set` a..b=3: a part of the key is empty");
    EXPECT_EQ(parse_error("", {"medium.0.cn2=1"}).substr(0, 49), "`set` medium.0.cn2=1: medium.0: type is missing; ");
    EXPECT_EQ(parse_error(text, {"camera.up=1\n[time]\nfps=3"}).find('\n'), std::string::npos);
    EXPECT_EQ(parse_error(text, {"medium.0.outer_scale=0.001"}),
              "`set` medium.0.outer_scale=0.001: medium.0.outer_scale: value 0.001, must be > inner_scale, 0.005");
}

TEST(SceneSeed, EveryMediumAndSeedDiffersDeterministically) {
    const std::string two = kTurbulence + kTurbulence + "[[medium]]\ntype = \"blobs\"\nwind = {}\n";
    const auto seeds = [&](std::optional<std::uint64_t> seed, const std::vector<std::string>& settings = {}) {
        const Scene s = parse_scene(two, "scene.toml", settings, seed);
        return std::array{medium<TurbulenceSpec>(s, 0).seed, medium<TurbulenceSpec>(s, 1).seed,
                          medium<BlobsSpec>(s, 2).wind->seed};
    };
    const auto plain = seeds({});
    EXPECT_EQ(plain, seeds({}));
    EXPECT_EQ(seeds(7), seeds(7));
    EXPECT_NE(plain[0], plain[1]);
    EXPECT_NE(plain[1], plain[2]);
    for (int i = 0; i < 3; ++i) EXPECT_NE(seeds(7)[i], seeds(8)[i]);
    const auto own = seeds({}, {"medium.1.seed=2"});
    EXPECT_EQ(own[0], plain[0]);
    EXPECT_NE(own[1], plain[1]);
    EXPECT_EQ(parse_error(kTurbulence + "seed = -1"),
              "scene.toml:3: medium.0.seed: value -1, must be >= 0 (of its random numbers)");
    EXPECT_EQ(parse_error(kTurbulence + "seed = 9223372036854775807"), "no error");
}

TEST(Presets, AreListedFoundAndValid) {
    const std::vector<Preset> presets = list_presets();
    for (const char* name : {"hot-road", "campfire", "jet-exhaust", "desert", "city-roofs", "gentle"})
        EXPECT_TRUE(std::filesystem::exists(find_preset(name))) << name;
    for (const Preset& preset : presets) {
        EXPECT_GT(preset.description.size(), 10u) << preset.name;
        const Scene s = read_scene(preset.file);
        EXPECT_FALSE(s.media.empty()) << preset.name;
        EXPECT_TRUE(s.plate.distance || s.plate.ground) << preset.name << " must work on a plate without depth";
        EXPECT_TRUE(s.camera.horizontal_fov || s.camera.focal_length) << preset.name;
    }
    EXPECT_EQ(error_of([] { find_preset("hotroad"); }), "`preset` hotroad: no such preset; did you mean 'hot-road'?");
    EXPECT_NE(error_of([] { find_preset("../gentle"); }), "no error");
}

TEST(Presets, FolderFromTheEnvironment) {
    ::setenv("EIKONAL_SAMPLES", "/no/such/folder", 1);
    EXPECT_EQ(error_of([] { list_presets(); }),
              "EIKONAL_SAMPLES=/no/such/folder: there is no folder '/no/such/folder/presets'");
    ::unsetenv("EIKONAL_SAMPLES");
}

TEST(Background, LiesBehindAllThatIsInSight) {
    Scene scene;
    EXPECT_EQ(default_far(scene), kDefaultFar);
    scene.media = {SurfaceSpec{}};
    EXPECT_EQ(default_far(scene), kDefaultSky);
    EXPECT_TRUE(has_mirage(scene));
    scene.media.emplace_back(TurbulenceSpec{});
    EXPECT_EQ(default_far(scene), kDefaultFar);
    EXPECT_TRUE(has_mirage(scene));
    scene.media = {SurfaceSpec{.surface_temperature = scene.optics.ambient_temperature}};
    EXPECT_FALSE(has_mirage(scene));
    EXPECT_EQ(default_far(scene), kDefaultFar);
    std::vector<float> metres{5, 1000, 1200, 1000};
    put_background_behind(metres, 1000);
    EXPECT_EQ(metres, (std::vector<float>{5, 1200, 1200, 1200}));
    metres = {5, 1000, 700};
    put_background_behind(metres, 1000);
    EXPECT_EQ(metres, (std::vector<float>{5, 1000, 700}));
}

}  // namespace
}  // namespace eikonal
