#include "warp/scene/scene.h"

#include "noise/math/random.h"
#include "noise/medium/keys.h"
#include "warp/scene/schema.h"
#include "warp/scene/settings.h"
#include "warp/scene/text_file.h"
#include "warp/scene/toml_reader.h"

namespace eikonal {

namespace {

/// Gives every medium its own random numbers, even if the file states the same seed for all.
void mix_seeds(Scene& scene, std::uint64_t scene_seed) {
    for (std::size_t i = 0; i < scene.media.size(); ++i)
        scene.media[i].mix_seeds(RandomStream(scene_seed, "medium", i));
}

}  // namespace

Scene parse_scene(std::string_view text, const std::filesystem::path& name, const std::vector<std::string>& settings,
                  std::optional<std::uint64_t> seed) {
    const toml::table root = scene_file::parse_root(text, name.string(), settings);
    Scene scene;
    scene.file = name;
    scene_file::TomlReader({root, "", scene.file}).read_table(keys(scene));
    mix_seeds(scene, seed.value_or(0));
    return scene;
}

Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& settings,
                 std::optional<std::uint64_t> seed) {
    return parse_scene(scene_file::read_text(file, "scene"), file, settings, seed);
}

}  // namespace eikonal
