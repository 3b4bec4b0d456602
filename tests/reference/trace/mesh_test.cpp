/// Meshes and scenes: the allowed content of their files, and the place that an error names.
#include "reference/trace/mesh.h"

#include <gtest/gtest.h>

#include <functional>

#include "noise/base/error.h"
#include "reference/trace/render.h"
#include "tests/reference/trace/trace_fixture.h"

namespace eikonal::reference {
namespace {

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

// The library that reads meshes would read these words as the number 0.
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

}  // namespace
}  // namespace eikonal::reference
