/// What the tests of straight rays and meshes share: a temporary folder, a camera, and the renderer's settings.
#pragma once

#include <gtest/gtest.h>

#include <fstream>

#include "reference/trace/render.h"

namespace eikonal::reference {

/// Settings for straight rays.
inline RenderSettings straight(int samples) {
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

inline constexpr int kWidth = 64, kHeight = 48;

/// A camera off every axis, 40 degrees wide.
inline Scene scene_with(std::vector<ObjectSpec> objects) {
    Scene scene;
    scene.file = "scene.toml";
    scene.camera.resolution = {kWidth, kHeight};
    scene.camera.position = {1.3, 2.7, 4.1};
    scene.camera.look_at = {0.4, 1.9, -10};
    scene.camera.horizontal_fov = 40;
    scene.objects = std::move(objects);
    return scene;
}

inline Camera camera_of(const Scene& scene) {
    return CameraPath(scene.camera, kWidth, kHeight).at(1);
}

}  // namespace eikonal::reference
