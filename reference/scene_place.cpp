#include "reference/scene_place.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>

#include "noise/error.h"
#include "warp/scene/text_file.h"

namespace eikonal::reference {
namespace {

/// Line of the key if that is what it says; 0 if not.
unsigned line_of(const Scene& scene, const std::string& key, const std::filesystem::path& file) {
    try {
        const toml::table root = toml::parse(scene_file::read_text(scene.file, "scene"), scene.file.string());
        toml::node_view<const toml::node> node(root);
        for (std::size_t from = 0; from <= key.size();) {
            const std::size_t dot = std::min(key.find('.', from), key.size());
            const std::string part = key.substr(from, dot - from);
            node = node.is_array() ? node[std::stoul(part)] : node[part];
            from = dot + 1;
        }
        const auto name = node.value<std::string>();
        return name && scene.file.parent_path() / *name == file ? node.node()->source().begin.line : 0;
    } catch (const UserError&) {
        return 0;
    } catch (const toml::parse_error&) {
        return 0;
    }
}

}  // namespace

std::string place_of(const Scene& scene, const std::string& key, const std::filesystem::path& file) {
    if (scene.file.empty()) return key;
    const unsigned line = line_of(scene, key, file);
    return line ? fmt::format("{}:{}: {}", scene.file.string(), line, key)
                : fmt::format("{}: {}", scene.file.string(), key);
}

}  // namespace eikonal::reference
