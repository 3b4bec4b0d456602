/// The renderer with straight rays: depth compared with closed forms, pixels compared with the camera, and the same
/// bytes for any number of threads.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>

#include "reference/trace/direction.h"
#include "reference/trace/frame_file.h"
#include "reference/trace/render.h"
#include "reference/trace/sampler.h"
#include "tests/reference/trace/trace_fixture.h"
#include "warp/image/picture.h"

namespace eikonal::reference {
namespace {

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

/// Far from the origin of the world a float has an error of 8 mm. The anchor keeps the depth exact.
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

/// A texture appears upright on a quad that faces the camera: its left half on the left, its upper half above.
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

// A slab of thickness t, entered at the angle θ, shifts a ray sideways by t sin θ (1 - cos θ/√(n² - sin² θ)) and leaves
// its direction. Seen through it, the edge between two screens moves by that much at any distance of the screens.
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
