#include "warp/scene/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <type_traits>
#include <vector>

#include "noise/base/error.h"

namespace eikonal::scene_file {

namespace {

/// Whether a node comes from a --set option, and not from the file.
bool from_option(const toml::source_region& source, const std::filesystem::path& file) {
    return source.path && *source.path != file.string();
}

/// The value as it looks in the file. Tables and long texts are cut short.
std::string shown(const toml::node& node) {
    if (node.is_table()) return "a table";
    std::string text;
    if (const auto s = node.value_exact<std::string>()) {
        text = '\'' + *s + '\'';
    } else if (const toml::array* array = node.as_array()) {
        text = "[";
        for (std::size_t i = 0; i < array->size() && text.size() < kLongestShown; ++i)
            text += (i ? ", " : "") + ((*array)[i].is_array() ? std::string("[…]") : shown((*array)[i]));
        text += ']';
    } else {
        std::ostringstream out;
        node.visit([&out](const auto& concrete) { out << concrete; });
        // fmt prints the shortest number that reads back the same; toml++ would print 17 digits.
        text = node.is_floating_point() ? fmt::format("{}", *node.value_exact<double>()) : out.str();
    }
    return shortened(text);
}

/// The number in `node`, checked against the ranges of T and of the key. `whole` is the entry whose value a message
/// shows.
template <class T>
T number(const Entry& whole, const toml::node& node, const Range& range) {
    if constexpr (std::is_integral_v<T>) {
        const std::optional<std::int64_t> i = node.value_exact<std::int64_t>();
        if (!i) fail_value(whole, "must be a whole number");
        if (!range.contains(static_cast<double>(*i)) || !std::in_range<T>(*i))
            fail_value(whole, range.text(static_cast<double>(*i)));
        return static_cast<T>(*i);
    } else {
        const std::optional<double> real = node.value_exact<double>();
        const std::optional<std::int64_t> i = node.value_exact<std::int64_t>();
        if (!real && !i) fail_value(whole, "must be a number");
        const double v = real ? *real : static_cast<double>(*i);
        if (!range.contains(v)) fail_value(whole, range.text(v));
        return v;
    }
}

/// The numbers of an array, which must have the length of `target`.
template <class T>
void numbers(const Entry& entry, std::span<T> target, const Ranges& ranges) {
    const toml::array* array = entry.node.as_array();
    if (!array || array->size() != target.size())
        fail_value(entry, fmt::format("must be an array of {} {}", target.size(),
                                      std::is_integral_v<T> ? "whole numbers" : "numbers"));
    for (std::size_t i = 0; i < target.size(); ++i) target[i] = number<T>(entry, (*array)[i], range_of(ranges, i));
}

}  // namespace

Entry Entry::member(std::string_view key, const toml::node& child, std::string its_help) const {
    return {child, name.empty() ? std::string(key) : name + '.' + std::string(key), file, std::move(its_help)};
}

std::string place(const toml::source_region& source, const std::filesystem::path& file) {
    if (from_option(source, file)) return *source.path;
    return source.begin.line ? fmt::format("{}:{}", file.string(), source.begin.line) : file.string();
}

void fail(const Entry& entry, std::string_view what) {
    const std::string name = entry.name.empty() ? "" : entry.name + ": ";
    throw UserError(printable(fmt::format("{}: {}{}", place(entry.node.source(), entry.file), name, what)));
}

void fail_value(const Entry& entry, std::string_view must_be) {
    const std::string help = entry.help.empty() ? "" : fmt::format(" ({})", entry.help);
    fail(entry, fmt::format("value {}, {}{}", shown(entry.node), must_be, help));
}

bool TomlReader::read_bool() {
    const std::optional<bool> value = entry_.node.value_exact<bool>();
    if (!value) fail_value(entry_, "must be true or false");
    return *value;
}

int TomlReader::read_int(const Range& range) {
    return number<int>(entry_, entry_.node, range);
}

std::uint64_t TomlReader::read_uint64(const Range& range) {
    return static_cast<std::uint64_t>(number<std::int64_t>(entry_, entry_.node, range));
}

double TomlReader::read_double(const Range& range) {
    return number<double>(entry_, entry_.node, range);
}

std::string TomlReader::read_text() {
    std::optional<std::string> value = entry_.node.value_exact<std::string>();
    if (!value) fail_value(entry_, "must be text");
    return std::move(*value);
}

std::filesystem::path TomlReader::read_path() {
    const std::string name = read_text();
    if (name.empty() || name.find('\0') != std::string::npos) fail_value(entry_, "must be the name of a file");
    return from_option(entry_.node.source(), entry_.file) ? std::filesystem::path(name)
                                                          : entry_.file.parent_path() / name;
}

void TomlReader::read_numbers(std::span<double> target, const Ranges& ranges) {
    numbers(entry_, target, ranges);
}
void TomlReader::read_numbers(std::span<int> target, const Ranges& ranges) {
    numbers(entry_, target, ranges);
}

std::size_t TomlReader::read_choice(std::span<const std::string_view> words) {
    const std::optional<std::string> value = entry_.node.value_exact<std::string>();
    const auto found = value ? std::find(words.begin(), words.end(), *value) : words.end();
    if (found == words.end()) {
        fail_value(entry_, fmt::format("must be \"{}\"", fmt::join(words, "\" or \"")) +
                               (value ? did_you_mean(*value, words) : ""));
    }
    return static_cast<std::size_t>(found - words.begin());
}

std::size_t TomlReader::read_kind(std::string_view name, std::string_view meaning,
                                  std::span<const std::string_view> words) {
    const toml::node* kind = table().get(name);
    if (!kind) fail(entry_, fmt::format("{} is missing; must be \"{}\"", name, fmt::join(words, "\" or \"")));
    return TomlReader(entry_.member(name, *kind, std::string(meaning))).read_choice(words);
}

void TomlReader::read_tables(const std::function<void(KeyReader&)>& read_one) {
    const toml::array* array = entry_.node.as_array();
    if (!array) {
        const bool top = entry_.name.find('.') == std::string::npos;
        fail_value(entry_, top ? fmt::format("must be an array of tables, written [[{}]]", entry_.name)
                               : "must be an array of tables, written [{…}, …]");
    }
    for (std::size_t i = 0; i < array->size(); ++i) {
        TomlReader one(entry_.member(std::to_string(i), (*array)[i], entry_.help));
        read_one(one);
    }
}

const toml::table& TomlReader::table() const {
    const toml::table* table = entry_.node.as_table();
    if (!table) fail_value(entry_, "must be a table");
    return *table;
}

void TomlReader::fail_unknown(const toml::key& name, const Keys& keys) const {
    std::vector<std::string_view> valid;
    for (const Key& key : keys) valid.push_back(key.name());
    const std::string key = shortened(name.str());
    const bool typed = std::find(valid.begin(), valid.end(), "type") != valid.end();  // true for a medium
    const std::string type = typed ? table()["type"].value_or(std::string()) : "";
    const std::string wrong = !type.empty() ? fmt::format("{} of type \"{}\" has no key '{}'", entry_.name, type, key)
                              : entry_.name.empty() ? fmt::format("unknown key '{}'", key)
                                                    : fmt::format("unknown key '{}' in {}", key, entry_.name);
    throw UserError(
        printable(fmt::format("{}: {}{}", place(name.source(), entry_.file), wrong, suggestion(name.str(), valid))));
}

void TomlReader::read_table(const Keys& keys) {
    const toml::table& given = table();
    for (const auto& [name, node] : given) {
        const auto has_name = [n = name.str()](const Key& key) { return key.name() == n; };
        if (std::none_of(keys.begin(), keys.end(), has_name)) fail_unknown(name, keys);
    }
    const auto entry_of = [&](const Key& key, const toml::node& node) {
        return entry_.member(key.name(), node, key.help());
    };
    for (const Key& key : keys) {
        const toml::node* node = given.get(key.name());
        if (!node) continue;
        TomlReader value(entry_of(key, *node));
        key.read(value);
    }
    for (const Key& key : keys)
        if (key.is_required() && !given.contains(key.name()))
            fail(entry_, fmt::format("{} is missing; give it ({})", key.name(), key.help()));
    for (const Key& key : keys)
        if (!given.contains(key.name())) key.set_default();
    for (const Key& key : keys) {
        const toml::node* node = given.get(key.name());
        if (const std::string wrong = key.broken_rule(node != nullptr); !wrong.empty())
            fail(entry_of(key, node ? *node : entry_.node), wrong);
    }
}

}  // namespace eikonal::scene_file
