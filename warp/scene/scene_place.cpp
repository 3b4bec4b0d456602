#include "warp/scene/scene_place.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "noise/base/error.h"
#include "warp/scene/settings.h"
#include "warp/scene/text_file.h"
#include "warp/scene/toml_reader.h"

namespace eikonal {
namespace {

constexpr std::array<std::string_view, 8> kSections = {"camera", "time",   "optics", "plate",
                                                       "medium", "object", "light",  "background"};

/// The key at the beginning of the message; empty if the message begins with anything else.
std::string_view leading_key(std::string_view message) {
    const std::string_view key = message.substr(0, message.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_."));
    const bool known = std::find(kSections.begin(), kSections.end(), key.substr(0, key.find('.'))) != kSections.end();
    return known ? key : std::string_view();
}

/// The last node on the path of the key that exists.
const toml::node& deepest(const toml::table& root, std::string_view key) {
    const toml::node* node = &root;
    while (!key.empty()) {
        const std::string_view part = key.substr(0, key.find('.'));
        key.remove_prefix(std::min(key.size(), part.size() + 1));
        const toml::node* next = nullptr;
        if (const toml::table* table = node->as_table()) next = table->get(part);
        if (const toml::array* array = node->as_array();
            array && !part.empty() && part.size() < 9 && part.find_first_not_of("0123456789") == part.npos)
            next = array->get(std::stoul(std::string(part)));
        if (!next) break;
        node = next;
    }
    return *node;
}

}  // namespace

std::string with_place(std::string_view message, const std::filesystem::path& file,
                       const std::vector<std::string>& settings) {
    const std::string_view key = leading_key(message);
    if (key.empty() || message.starts_with(file.string())) return std::string(message);
    try {
        const toml::table root = scene_file::parse_root(scene_file::read_text(file, "scene"), file.string(), settings);
        const toml::node& node = deepest(root, key);
        const std::string place = &node == &root ? file.string() : scene_file::place(node.source(), file);
        return scene_file::printable(fmt::format("{}: {}", place, message));
    } catch (const UserError&) {
        return std::string(message);
    }
}

}  // namespace eikonal
