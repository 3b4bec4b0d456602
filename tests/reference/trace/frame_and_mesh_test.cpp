/// The straight-ray renderer: depth against closed forms, pixels against the camera, determinism, and bad input.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>

#include "noise/base/error.h"
#include "reference/trace/direction.h"
#include "reference/trace/frame_file.h"
#include "reference/trace/render.h"
#include "reference/trace/sampler.h"
#include "warp/image/picture.h"

namespace eikonal::reference {
namespace {

/// Straight rays.
RenderSettings straight(int samples) {
    RenderSettings settings;
    settings.samples = samples;
    settings.straight = true;
    return settings;
}

/// A folder of its own for each test, removed with it.
class ReferenceTest : public testing::Test {
  protected:
    ReferenceTest() {
        const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::path(testing::TempDir()) / (std::string("eikonal_reference_") + info.name());
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
    }
    ~ReferenceTest() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
        return folder_ / name;
    }

    std::filesystem::path folder_;
};

constexpr int kWidth = 64, kHeight = 48;

/// A camera off every axis, 40 degrees wide.
Scene scene_with(std::vector<ObjectSpec> objects) {
    Scene scene;
    scene.file = "scene.toml";
    scene.camera.resolution = {kWidth, kHeight};
    scene.camera.position = {1.3, 2.7, 4.1};
    scene.camera.look_at = {0.4, 1.9, -10};
    scene.camera.horizontal_fov = 40;
    scene.objects = std::move(objects);
    return scene;
}

Camera camera_of(const Scene& scene) {
    return CameraPath(scene.camera, kWidth, kHeight).at(1);
}

/// Compares every pixel's depth with `expected` (t along a ray of axial component 1; infinite: background).
void expect_depth(const Scene& scene, const std::function<double(const CameraRay&)>& expected) {
    const RenderedFrame frame = Renderer(scene, straight(1)).render(1);
    const Camera camera = camera_of(scene);
    int hits = 0;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const double want = expected(camera_ray(camera, x + 0.5, y + 0.5));
            const double got = static_cast<double>(frame.depth[static_cast<std::size_t>(y * kWidth + x)]);
            if (std::isinf(want)) {
                EXPECT_TRUE(std::isinf(got)) << x << ' ' << y;
            } else {
                EXPECT_NEAR(got / want, 1, 1e-7) << x << ' ' << y;  // half a unit of float's last place is 6e-8
                ++hits;
            }
        }
    }
    EXPECT_GT(hits, kWidth * kHeight / 20);
}

constexpr double kNothing = std::numeric_limits<double>::infinity();

TEST_F(ReferenceTest, PlaneDepth) {
    ObjectSpec plane;
    plane.origin = {0, 0.25, 0};
    plane.normal = {0.1, 1, -0.05};
    expect_depth(scene_with({plane}), [&](const CameraRay& ray) {
        const double t = glm::dot(plane.origin - ray.origin, plane.normal) / glm::dot(ray.direction, plane.normal);
        return t > 0 ? t : kNothing;
    });
}

TEST_F(ReferenceTest, QuadDepth) {
    ObjectSpec quad;
    quad.shape = ObjectShape::Quad;
    quad.origin = {0.5, 2, -30};
    quad.normal = {0, 0, 1};
    quad.size = {9, 5};
    expect_depth(scene_with({quad}), [&](const CameraRay& ray) {
        const double t = (quad.origin.z - ray.origin.z) / ray.direction.z;
        const dvec3 p = ray.origin + t * ray.direction - quad.origin;
        return std::abs(p.x) < 4.5 && std::abs(p.y) < 2.5 ? t : kNothing;
    });
}

/// |o + t d - c|² = r²: the smaller root.
TEST_F(ReferenceTest, SphereDepth) {
    ObjectSpec sphere;
    sphere.shape = ObjectShape::Sphere;
    sphere.center = {0.2, 1.5, -300};
    sphere.radius = 60;
    expect_depth(scene_with({sphere}), [&](const CameraRay& ray) {
        const dvec3 o = ray.origin - sphere.center;
        const double a = glm::dot(ray.direction, ray.direction), b = glm::dot(o, ray.direction);
        const double discriminant = b * b - a * (glm::dot(o, o) - sphere.radius * sphere.radius);
        return discriminant > 0 ? (-b - std::sqrt(discriminant)) / a : kNothing;
    });
}

TEST_F(ReferenceTest, CameraInsideASphereSeesItsFarSide) {
    ObjectSpec sphere;
    sphere.shape = ObjectShape::Sphere;
    sphere.center = {1, 2, 3};
    sphere.radius = 7;
    expect_depth(scene_with({sphere}), [&](const CameraRay& ray) {
        const dvec3 o = ray.origin - sphere.center;
        const double a = glm::dot(ray.direction, ray.direction), b = glm::dot(o, ray.direction);
        return (-b + std::sqrt(b * b - a * (glm::dot(o, o) - sphere.radius * sphere.radius))) / a;
    });
}

/// A segment to a chosen point of a sphere and of a quad, at many distances: t = 1 up to kHitAccuracy.
TEST_F(ReferenceTest, HitsAreSolvedInDouble) {
    for (const double distance : {0.5, 20.0, 1000.0, 50000.0}) {
        const dvec3 from{1.3, 2.7, 4.1}, to = from + distance * glm::normalize(dvec3(0.3, -0.2, -1));
        ObjectSpec sphere, quad;
        sphere.shape = ObjectShape::Sphere;
        sphere.radius = distance / 7;
        sphere.center = to + sphere.radius * glm::normalize(dvec3(0.1, 0.3, -1));
        quad.shape = ObjectShape::Quad;
        quad.normal = {0.2, 0.1, 1};
        quad.size = {distance, distance};
        quad.origin = to;
        for (const ObjectSpec& object : {sphere, quad}) {
            const Geometry geometry(scene_with({object}), from);
            const auto hit = geometry.intersect(from, to - from, 0, 2);
            ASSERT_TRUE(hit);
            EXPECT_NEAR(hit->t, 1, kHitAccuracy) << distance;
            EXPECT_TRUE(geometry.occluded(from, to - from, 0, 1.01));
            EXPECT_FALSE(geometry.occluded(from, to - from, 0, 0.99));
        }
    }
}

/// Far from the origin of the world a float would be 8 mm off; the anchor keeps the answer exact.
TEST_F(ReferenceTest, FarFromTheOriginOfTheWorld) {
    ObjectSpec sphere;
    sphere.shape = ObjectShape::Sphere;
    const dvec3 away{1e5, -2e4, 7e4};
    sphere.center = dvec3(0.4, 1.9, -10) + away;
    sphere.radius = 2;
    Scene scene = scene_with({sphere});
    scene.camera.position += away;
    scene.camera.look_at += away;
    const RenderedFrame frame = Renderer(scene, straight(1)).render(1);
    const double distance = glm::distance(dvec3(1.3, 2.7, 4.1), dvec3(0.4, 1.9, -10));
    // The middle of the picture lies between four pixels, at most half a pixel's diagonal from the axis.
    EXPECT_NEAR(static_cast<double>(frame.depth[kHeight / 2 * kWidth + kWidth / 2]), distance - 2, 0.02);
}

TEST_F(ReferenceTest, OrthographicDepthAndPlace) {
    ObjectSpec quad;
    quad.shape = ObjectShape::Quad;
    quad.origin = {0, 0, -25};
    quad.normal = {0, 0, 1};
    quad.size = {4, 4};
    Scene scene = scene_with({quad});
    scene.camera.projection = Projection::Orthographic;
    scene.camera.width = 16;  // 4 pixels a metre
    scene.camera.position = {0, 0, 5};
    scene.camera.look_at = {0, 0, 0};
    const RenderedFrame frame = Renderer(scene, straight(1)).render(1);
    int hits = 0;
    for (const float z : frame.depth)
        if (std::isfinite(z)) {
            ++hits;
            EXPECT_FLOAT_EQ(z, 30);
        }
    EXPECT_EQ(hits, 16 * 16);
}

/// A small emissive sphere must appear at the pixel that Camera::pixel says, and nowhere else.
TEST_F(ReferenceTest, PixelsAndGeometryAgree) {
    ObjectSpec sphere;
    sphere.shape = ObjectShape::Sphere;
    sphere.color = {3, 2, 1};
    Scene scene = scene_with({sphere});
    const Camera camera = camera_of(scene);
    for (const dvec2 p : {dvec2(5.5, 7.5), dvec2(60.5, 3.5), dvec2(20.5, 44.5)}) {
        const CameraRay ray = camera_ray(camera, p.x, p.y);
        scene.objects[0].center = ray.origin + 50.0 * ray.direction;
        scene.objects[0].radius = 0.2;  // 0.35 pixel
        const RenderedFrame frame = Renderer(scene, straight(4)).render(1);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                EXPECT_EQ(std::isfinite(frame.depth[static_cast<std::size_t>(y * kWidth + x)]),
                          x == static_cast<int>(p.x) && y == static_cast<int>(p.y));
    }
}

/// The texture's left and upper half on a quad that the camera faces.
TEST_F(ReferenceTest, TextureIsUpright) {
    LinearImage image{{0, 0, 2, 2}, {0, 0, 2, 2}, 1, {1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1, 1, 1, 1, 1}};
    write_picture(folder_ / "corners.exr", picture_from_linear(image, folder_ / "corners.exr", false, 32));
    ObjectSpec quad;
    quad.shape = ObjectShape::Quad;
    quad.normal = {0, 0, 1};
    quad.size = {8, 8};
    quad.texture = folder_ / "corners.exr";
    Scene scene = scene_with({quad});
    scene.camera.projection = Projection::Orthographic;
    scene.camera.width = 8;
    scene.camera.resolution = {8, 8};
    scene.camera.position = {0, 0, 5};
    scene.camera.look_at = {0, 0, 0};
    const RenderedFrame frame = Renderer(scene, straight(256)).render(1);
    const auto pixel = [&](int x, int y) {
        const std::size_t i = static_cast<std::size_t>(4 * (y * 8 + x));
        return dvec3(frame.color[i], frame.color[i + 1], frame.color[i + 2]);
    };
    EXPECT_GT(pixel(1, 1).r, 0.7);  // red above left
    EXPECT_LT(pixel(1, 1).g, 0.3);
    EXPECT_GT(pixel(6, 1).g, 0.7);  // green above right
    EXPECT_GT(pixel(1, 6).b, 0.7);  // blue below left
    EXPECT_LT(pixel(1, 6).r, 0.3);
}

/// A white floor under a sun at zenith of strength 0.7 and a sky of 0.2, alone in the world: L = 0.9 exactly. Under a
/// wide roof close above it, neither sun nor (nearly) sky arrives.
TEST_F(ReferenceTest, SunSkyAndShadow) {
    ObjectSpec floor;
    floor.color = {1, 1, 1};
    Scene scene = scene_with({floor});
    scene.camera.position = {0, 1, 0};
    scene.camera.look_at = {0, 0, -0.5};
    scene.light = LightSpec{{0, -1, 0}, {0.7, 0.7, 0.7}, {0.2, 0.2, 0.2}};
    const std::size_t middle = 4 * (kHeight / 2 * kWidth + kWidth / 2);
    EXPECT_NEAR(Renderer(scene, straight(16)).render(1).color[middle], 0.9, 1e-5);

    ObjectSpec roof;
    roof.shape = ObjectShape::Quad;
    roof.origin = {0, 2, 0};
    roof.normal = {0, -1, 0};
    roof.size = {400, 400};
    roof.color = {0, 0, 0};
    scene.objects.push_back(roof);
    EXPECT_NEAR(Renderer(scene, straight(64)).render(1).color[middle], 0, 1e-3);
}

TEST_F(ReferenceTest, SameBytesForAnyNumberOfThreads) {
    ObjectSpec floor, ball;
    ball.shape = ObjectShape::Sphere;
    ball.center = {0, 1.5, -6};
    Scene scene = scene_with({floor, ball});
    scene.light = LightSpec{};
    const Renderer renderer(scene, straight(8));
    RenderedFrame one, two;
    {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
        one = renderer.render(7);
    }
    {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 4);
        two = Renderer(scene, straight(8)).render(7);
    }
    EXPECT_EQ(one.color, two.color);
    EXPECT_EQ(one.depth, two.depth);
    EXPECT_NE(one.color, renderer.render(8).color);  // each frame has its own noise
}

TEST_F(ReferenceTest, WrittenFileHoldsHalfColorAndExactDepth) {
    ObjectSpec floor;
    const RenderedFrame frame = Renderer(scene_with({floor}), straight(1)).render(1);
    for (const Storage storage : {Storage::Exact, Storage::Compact}) {
        write_frame(folder_ / "f.exr", frame, storage);
        const Picture picture = read_picture(folder_ / "f.exr");
        const Part& part = picture.parts.front();
        ASSERT_EQ(part.spec.channelnames, (std::vector<std::string>{"R", "G", "B", "A", "Z"}));
        EXPECT_EQ(part.spec.channelformat(0), OIIO::TypeDesc::HALF);
        EXPECT_EQ(part.spec.channelformat(4), OIIO::TypeDesc::FLOAT);
        for (std::size_t i = 0; i < frame.depth.size(); ++i) {
            float z;
            std::memcpy(&z, part.pixels.data() + i * part.pixel_bytes() + part.channel_offset(4), sizeof z);
            if (storage == Storage::Exact || std::isinf(frame.depth[i]))
                ASSERT_EQ(z, frame.depth[i]);
            else
                ASSERT_NEAR(static_cast<double>(z) / static_cast<double>(frame.depth[i]), 1, kCompactDepthError);
        }
    }
}

TEST_F(ReferenceTest, MeshMaterialsColorsAndDegenerateTriangles) {
    write("m.mtl", "newmtl a\nKd 0.5 0.25 0.125\nKe 1 2 3\n");
    const Mesh mesh = read_mesh(write("m.obj",
                                      "mtllib m.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 1 1 0 1 1 1\n"
                                      "usemtl a\nf 1 2 4 3\nf 1 1 2\n"),
                                2, {10, 0, 0});
    ASSERT_EQ(mesh.triangles.size(), 2u);  // the polygon; the third face has no area
    EXPECT_EQ(mesh.positions[1], dvec3(12, 0, 0));
    EXPECT_EQ(mesh.colors[1], dvec3(0, 1, 0));
    ASSERT_EQ(mesh.materials.size(), 1u);
    EXPECT_EQ(mesh.materials[0].diffuse, dvec3(0.5, 0.25, 0.125));
    EXPECT_EQ(mesh.materials[0].emission, dvec3(1, 2, 3));
}

TEST_F(ReferenceTest, MeshesWithAMarkAndSpacesInNames) {
    write("my own.mtl", "newmtl a\nKd 0.5 0.25 0.125\n");
    const Mesh mesh = read_mesh(write("m.obj",
                                      "\xEF\xBB\xBFv 0 0 0\nmtllib my own.mtl\r\nv 1 0 0\nv 0 1 0\nusemtl a\n"
                                      "f 1 2 3 # a corner\n"),
                                1, dvec3(0));
    ASSERT_EQ(mesh.triangles.size(), 1u);
    EXPECT_EQ(mesh.positions[1], dvec3(1, 0, 0));
    ASSERT_EQ(mesh.materials.size(), 1u);
    EXPECT_EQ(mesh.materials[0].diffuse, dvec3(0.5, 0.25, 0.125));
}

/// Runs `action` and expects a UserError whose message has all `parts`, on one line.
void expect_user_error(const std::function<void()>& action, const std::vector<std::string>& parts) {
    try {
        action();
        ADD_FAILURE() << "no error";
    } catch (const UserError& error) {
        const std::string message = error.what();
        for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

TEST_F(ReferenceTest, BadScenesNameWhatIsWrong) {
    expect_user_error([] { Renderer(scene_with({}), straight(1)); }, {"scene.toml", "[[object]]"});
    ObjectSpec mesh;
    mesh.shape = ObjectShape::Mesh;
    const auto render_mesh = [&](const std::filesystem::path& file) {
        mesh.file = file;
        Renderer(scene_with({mesh}), straight(1));
    };
    expect_user_error([&] { render_mesh("nowhere/ship.obj"); }, {"nowhere/ship.obj", "cannot read"});
    expect_user_error([&] { render_mesh(folder_); }, {"cannot read"});
    expect_user_error([&] { render_mesh(write("empty.obj", "")); }, {"empty.obj", "no triangle"});
    expect_user_error([&] { render_mesh(write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")); }, {"index.obj"});
    expect_user_error([&] { render_mesh(write("lib.obj", "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")); },
                      {"lib.obj", "gone.mtl"});
    ObjectSpec plane;
    plane.texture = folder_ / "gone.png";
    expect_user_error([&] { Renderer(scene_with({plane}), straight(1)); }, {"object.0.texture: ", "gone.png"});
    plane.texture = write("broken.png", "not a picture");
    expect_user_error([&] { Renderer(scene_with({plane}), straight(1)); }, {"object.0.texture: ", "broken.png"});
    Scene sky = scene_with({ObjectSpec{}});
    sky.background.image = folder_ / "gone.exr";
    expect_user_error([&] { Renderer(sky, straight(1)); }, {"background.image", "gone.exr"});
}

// What the library that reads meshes would take for 0.
TEST_F(ReferenceTest, NumbersOfAMeshThatAreNoneNameTheirLine) {
    // Lines may go on: those after them keep their numbers.
    const std::string good =
        "v 0 0 0\n v +1 0 0 # a corner \\\nv 0 1e0 0 1 0.5 .25\nvt 0 1\nvn 0 0 1\nf 1 2 3\nf 1 \\\r\n 2\\\n3\n";
    EXPECT_EQ(read_mesh(write("good.obj", good), 1, dvec3(0)).triangles.size(), 2u);
    for (const std::string value : {"nan", "NaN", "inf", "-inf", "1e999", "1e13", "-", "1.5x", "x"}) {
        for (const char* line : {"v 0 @ 0", "v 0 0 0 1 @ 1", "vn 0 0 @", "vt @ 0", "\tv\t@ 0 0\r"}) {
            std::string text = line;
            text.replace(text.find('@'), 1, value);
            expect_user_error([&] { read_mesh(write("bad.obj", good + text + "\n"), 1, dvec3(0)); },
                              {"bad.obj:10: v", "'" + value + "'"});
        }
        for (const std::string key : {"Kd", "Ke"}) {
            write("bad.mtl", "newmtl a\n" + key + " 0 " + value + " 0\n");
            expect_user_error([&] { read_mesh(write("m.obj", "mtllib bad.mtl\n" + good), 1, dvec3(0)); },
                              {"bad.mtl:2: " + key, "'" + value + "'"});
        }
    }
    expect_user_error([&] { read_mesh(write("short.obj", good + "v 1 2\n"), 1, dvec3(0)); },
                      {"short.obj:10: v needs 3 numbers and has 2"});
}

TEST_F(ReferenceTest, IndicesOfAMeshThatAreNoneNameTheirLine) {
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 1\nvn 0 0 1\n";
    for (const char* face : {"f 1 2 3", "f -3 -2 -1", "f 1/1 2/1 3/1", "f 1//1 2//1 3//-1", "f 1/1/1 2/1/1 3/-1/1\r"})
        EXPECT_EQ(read_mesh(write("good.obj", corners + face + "\n"), 1, dvec3(0)).triangles.size(), 1u) << face;
    EXPECT_EQ(read_mesh(write("good.obj", "f 1 2 3\n" + corners), 1, dvec3(0)).triangles.size(), 1u);
    for (const std::string corner : {"3.7", "3x", "x", "0", "1/0", "2147483648", "99999999999999999999", "-2147483649",
                                     "4294967297", "1/", "1//", "1/1/", "/1", "1/1/1/1", "1e0", "+3"})
        expect_user_error([&] { read_mesh(write("bad.obj", corners + "f 1 2 " + corner + "\n"), 1, dvec3(0)); },
                          {"bad.obj:6: f: '" + corner + "' is no corner"});
    const std::pair<const char*, const char*> outside[] = {{"4", "no v 4, the file has 3"},
                                                           {"-4", "no v -4, the file has 3 before it"},
                                                           {"2147483647", "no v 2147483647"},
                                                           {"1/2", "no vt 2, the file has 1"},
                                                           {"1/-2", "no vt -2"},
                                                           {"1//2", "no vn 2"},
                                                           {"1/1/-2147483648", "no vn -2147483648"}};
    for (const auto& [corner, what] : outside)
        expect_user_error([&] { read_mesh(write("bad.obj", corners + "f 1 2 " + corner + "\n"), 1, dvec3(0)); },
                          {"bad.obj:6: f: ", what});
    expect_user_error([&] { read_mesh(write("bad.obj", "v 0 0 0\nf -1 -2 -3\nv 1 0 0\nv 0 1 0\n"), 1, dvec3(0)); },
                      {"bad.obj:2: f: ", "no v -2, the file has 1 before it"});
}

// A slab of thickness t, met at the angle θ, shifts a ray sideways by t sin θ (1 - cos θ/√(n² - sin² θ)) and leaves its
// direction. Seen through it, the edge between two screens has moved by that much, wherever the screens stand.
TEST_F(ReferenceTest, AGlassSlabShiftsARaySideways) {
    constexpr double t = 0.3, n = 1.5;
    constexpr double kOff = 4e-5;  // Geometry::leave starts 13 µm off each surface
    for (const double theta : {0.0, 0.3, 0.8, 1.2}) {
        std::string box;
        for (int corner = 0; corner < 8; ++corner) {
            const double a = (corner & 1 ? 0.5 : -0.5) * t, b = corner & 2 ? 4 : -4, c = corner & 4 ? 4 : -4;
            box += fmt::format("v {} {} {}\n", a * std::sin(theta) + b * std::cos(theta), c,
                               a * std::cos(theta) - b * std::sin(theta));
        }
        box += "f 1 3 7 5\nf 2 4 8 6\nf 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\n";
        ObjectSpec slab;
        slab.shape = ObjectShape::Mesh;
        slab.file = write("slab.obj", box);
        slab.refractive_index = n;
        const double sine = std::sin(theta), cosine = std::cos(theta);
        const double shift = t * sine * (1 - cosine / std::sqrt(n * n - sine * sine));
        for (const double behind : {7.0, 30.0})
            for (const double off : {-kOff, kOff}) {
                // The slab leans so that rays along -z are shifted to -x. The edge stands beside where they arrive.
                ObjectSpec left, right;
                for (ObjectSpec* screen : {&left, &right}) {
                    screen->shape = ObjectShape::Quad;
                    screen->normal = {0, 0, 1};
                    screen->size = {100, 100};
                }
                left.origin = {-shift + off - 50, 0, -behind};
                right.origin = {-shift + off + 50, 0, -behind};
                left.color = {0, 1, 0};
                right.color = {0, 0, 1};
                Scene scene = scene_with({slab, left, right});
                scene.camera.projection = Projection::Orthographic;
                scene.camera.width = 1e-7;
                scene.camera.position = {0, 0, 5};
                scene.camera.look_at = {0, 0, 0};
                const RenderedFrame frame = Renderer(scene, straight(1)).render(1);
                EXPECT_EQ(frame.color[2] > frame.color[1], off < 0) << theta << ' ' << behind;
                EXPECT_GT(frame.color[1] + frame.color[2], 0.5);
            }
    }
}

TEST_F(ReferenceTest, AnglesMatchTheLibrary) {
    for (int i = 0; i < 20000; ++i) {
        const double a = (i + 0.37) / 20000 * 2 * M_PI - M_PI, r = i % 2 ? 1e-3 : 1e9;
        EXPECT_NEAR(angle_turns(r * std::sin(a), r * std::cos(a)), a / (2 * M_PI), kAngleError);
    }
    EXPECT_EQ(angle_turns(0, 0), 0);
    EXPECT_EQ(angle_turns(0, -1), 0.5);
    EXPECT_EQ(latitude_longitude({0, 0, -1}), dvec2(0.5, 0.5));
    EXPECT_EQ(latitude_longitude({1, 0, 0}), dvec2(0.75, 0.5));
    EXPECT_EQ(latitude_longitude({0, 1, 0}), dvec2(0.5, 1));
}

TEST_F(ReferenceTest, SamplesFillEveryCell) {
    for (const std::uint64_t stream : {0ull, 1ull, 0xdeadbeefcafeull}) {
        std::vector<int> cells(256);
        for (std::uint32_t i = 0; i < 256; ++i) {
            const dvec2 p = spread_point(i, stream);
            ++cells[static_cast<std::size_t>(p.y * 16) * 16 + static_cast<std::size_t>(p.x * 16)];
        }
        for (const int count : cells) EXPECT_EQ(count, 1);
    }
}

}  // namespace
}  // namespace eikonal::reference
