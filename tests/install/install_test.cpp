// A host needs nothing but the installed tree. A small program is built against it in both ways. It makes the same map
// as the program `eikonal`, with the installed presets.

#include <cstring>
#include <fstream>

#include "tests/programs/program_run.h"

namespace program_test {
namespace {

constexpr const char* kPreset = "installed";

class Install : public Program {
  protected:
    Install() {
        succeeds({"cmake", "--install", EIKONAL_BUILD_DIR, "--prefix", path("prefix").string()});
        // under a name that only this tree has
        const fs::path presets = path("prefix/share/eikonal/presets");
        fs::copy_file(presets / "hot-road.toml", presets / "installed.toml");
    }
    void succeeds(const Words& words) const {
        const Ended ended = tool(words);
        ASSERT_EQ(ended.status, 0) << ended.out << ended.err;
    }
    /// Sets the variable for the programs that are run.
    static void in_environment(const char* name, const fs::path& value) {
        ASSERT_EQ(setenv(name, value.c_str(), 1), 0);
    }
    /// What `eikonal map` writes of the same frame.
    std::vector<float> map_of_program() const {
        silent(run({"map", "--scene", path("prefix/share/eikonal/presets/hot-road.toml").string(), "--set",
                    "camera.resolution=[160,90]", "--frames", "3", "-o", "map.exr"}));
        return read("map.exr").values;
    }
    std::vector<float> floats(const std::string& name) const {
        const std::string raw = bytes(name);
        std::vector<float> values(raw.size() / sizeof(float));
        std::memcpy(values.data(), raw.data(), values.size() * sizeof(float));
        return values;
    }
};

TEST_F(Install, FindPackage) {
    succeeds({"cmake", "-S", EIKONAL_HOST_DIR, "-B", path("build").string(),
              "-DCMAKE_PREFIX_PATH=" + path("prefix").string(),
              std::string("-DCMAKE_CXX_FLAGS=") + EIKONAL_HOST_FLAGS});
    succeeds({"cmake", "--build", path("build").string()});
    succeeds({path("build/host").string(), kPreset, "uv"});
    const std::vector<float> uv = floats("uv");
    ASSERT_EQ(uv.size(), 2u * 160 * 90);
    EXPECT_EQ(uv, map_of_program());
}

TEST_F(Install, PkgConfig) {
    const fs::path libraries = path("prefix") / EIKONAL_LIBDIR;
    in_environment("PKG_CONFIG_PATH", libraries / "pkgconfig");
    in_environment("LD_LIBRARY_PATH", libraries);
    succeeds({"sh", "-c",
              std::string(EIKONAL_CXX " -std=c++20 " EIKONAL_HOST_FLAGS " " EIKONAL_HOST_DIR "/host.cpp") +
                  " $(pkg-config --cflags --libs eikonal) -o host"});
    succeeds({path("host").string(), kPreset, "uv"});
    EXPECT_EQ(floats("uv"), map_of_program());
}

// The symbols of the library's internals are not exported.
TEST_F(Install, OnlyTheInterfaceIsVisible) {
    const Ended symbols =
        tool({"nm", "-DC", "--defined-only", (path("prefix") / EIKONAL_LIBDIR / "libeikonal.so").string()});
    ASSERT_EQ(symbols.status, 0) << symbols.err;
    EXPECT_NE(symbols.out.find("eikonal::Shimmer::map("), std::string::npos);
    for (const char* inner : {"eikonal::Displacer", "eikonal::read_scene", "fftwf_", "toml::"})
        EXPECT_EQ(symbols.out.find(inner), std::string::npos) << inner;
}

}  // namespace
}  // namespace program_test
