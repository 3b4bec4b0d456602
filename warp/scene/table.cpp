#include "warp/scene/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "noise/base/error.h"

namespace eikonal::scene_file {

namespace {

const Range& range_of(const Ranges& ranges, std::size_t i) {
    return ranges[std::min(i, ranges.size() - 1)];
}

/// Whether it is a --set option's, not the file's.
bool from_option(const toml::source_region& source, const std::filesystem::path& file) {
    return source.path && *source.path != file.string();
}

/// The value as a person would recognise it in the file; tables and long text are cut short.
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
        // the shortest number that reads back the same, where toml++ prints 17 digits
        text = node.is_floating_point() ? fmt::format("{}", *node.value_exact<double>()) : out.str();
    }
    return shortened(text);
}

/// The number in `node`, in T's range and the key's; `whole` is the entry whose value a message shows.
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

template <class T>
void numbers(const Entry& entry, std::span<T> target, const Ranges& ranges) {
    const toml::array* array = entry.node.as_array();
    if (!array || array->size() != target.size())
        fail_value(entry, fmt::format("must be an array of {} {}", target.size(),
                                      std::is_integral_v<T> ? "whole numbers" : "numbers"));
    for (std::size_t i = 0; i < target.size(); ++i) target[i] = number<T>(entry, (*array)[i], range_of(ranges, i));
}

}  // namespace

Entry Entry::member(std::string_view key, const toml::node& child, std::string_view its_meaning) const {
    return {child, name.empty() ? std::string(key) : name + '.' + std::string(key), file, its_meaning};
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
    const std::string meaning = entry.meaning.empty() ? "" : fmt::format(" ({})", entry.meaning);
    fail(entry, fmt::format("value {}, {}{}", shown(entry.node), must_be, meaning));
}

bool Range::contains(double v) const {
    return v >= lo && v <= hi;
}

std::string Range::text(double v) const {
    if (!std::isfinite(v)) return "must be finite";
    if (lo > -kLargestValue && hi < kLargestValue) return fmt::format("must be >= {} and <= {}", lo, hi);
    if (v > hi) return fmt::format("must be <= {}", hi);
    if (lo == kSmallestPositive && v <= 0) return "must be > 0";
    return fmt::format("must be >= {}", lo);
}

void read_value(const Entry& entry, bool& target, const Ranges&) {
    const std::optional<bool> value = entry.node.value_exact<bool>();
    if (!value) fail_value(entry, "must be true or false");
    target = *value;
}

void read_value(const Entry& entry, int& target, const Ranges& ranges) {
    target = number<int>(entry, entry.node, range_of(ranges, 0));
}

void read_value(const Entry& entry, std::uint64_t& target, const Ranges&) {
    const std::int64_t value = number<std::int64_t>(entry, entry.node, {0, 0x1p63});
    target = static_cast<std::uint64_t>(value);
}

void read_value(const Entry& entry, double& target, const Ranges& ranges) {
    target = number<double>(entry, entry.node, range_of(ranges, 0));
}

void read_value(const Entry& entry, std::string& target, const Ranges&) {
    std::optional<std::string> value = entry.node.value_exact<std::string>();
    if (!value) fail_value(entry, "must be text");
    target = std::move(*value);
}

void read_value(const Entry& entry, std::filesystem::path& target, const Ranges& ranges) {
    std::string name;
    read_value(entry, name, ranges);
    if (name.empty() || name.find('\0') != std::string::npos) fail_value(entry, "must be the name of a file");
    target =
        from_option(entry.node.source(), entry.file) ? std::filesystem::path(name) : entry.file.parent_path() / name;
}

void read_value(const Entry& entry, dvec3& target, const Ranges& ranges) {
    std::array<double, 3> v{};
    read_numbers(entry, v, ranges);
    target = {v[0], v[1], v[2]};
}

void read_numbers(const Entry& entry, std::span<double> target, const Ranges& ranges) {
    numbers(entry, target, ranges);
}
void read_numbers(const Entry& entry, std::span<int> target, const Ranges& ranges) {
    numbers(entry, target, ranges);
}

std::size_t read_choice(const Entry& entry, std::span<const std::string_view> valid) {
    const std::optional<std::string> value = entry.node.value_exact<std::string>();
    const auto found = value ? std::find(valid.begin(), valid.end(), *value) : valid.end();
    if (found == valid.end()) {
        fail_value(entry, fmt::format("must be \"{}\"", fmt::join(valid, "\" or \"")) +
                              (value ? did_you_mean(*value, valid) : ""));
    }
    return static_cast<std::size_t>(found - valid.begin());
}

const toml::array& array_of_tables(const Entry& entry) {
    const toml::array* array = entry.node.as_array();
    if (!array) {
        const bool top = entry.name.find('.') == std::string::npos;
        fail_value(entry, top ? fmt::format("must be an array of tables, written [[{}]]", entry.name)
                              : "must be an array of tables, written [{…}, …]");
    }
    return *array;
}

void read_table(const Entry& entry, const std::vector<Key>& keys) {
    const toml::table* table = entry.node.as_table();
    if (!table) fail_value(entry, "must be a table");

    for (const auto& [name, node] : *table) {
        const auto has_name = [n = name.str()](const Key& key) { return key.name_ == n; };
        if (std::any_of(keys.begin(), keys.end(), has_name)) continue;
        std::vector<std::string_view> valid;
        for (const Key& key : keys) valid.push_back(key.name_);
        const std::string key = shortened(name.str());
        const bool typed = std::find(valid.begin(), valid.end(), "type") != valid.end();  // a medium
        const std::string type = typed ? (*table)["type"].value_or(std::string()) : "";
        const std::string wrong = !type.empty()
                                      ? fmt::format("{} of type \"{}\" has no key '{}'", entry.name, type, key)
                                  : entry.name.empty() ? fmt::format("unknown key '{}'", key)
                                                       : fmt::format("unknown key '{}' in {}", key, entry.name);
        throw UserError(
            printable(fmt::format("{}: {}{}", place(name.source(), entry.file), wrong, suggestion(name.str(), valid))));
    }
    const auto entry_of = [&](const Key& key, const toml::node& node) {
        return entry.member(key.name_, node, key.meaning_);
    };
    for (const Key& key : keys)
        if (const toml::node* node = table->get(key.name_)) key.read_(entry_of(key, *node));
    for (const Key& key : keys)
        if (key.required_ && !table->contains(key.name_))
            fail(entry, fmt::format("{} is missing; give it ({})", key.name_, key.meaning_));
    for (const Key& key : keys)
        if (key.default_ && !table->contains(key.name_)) key.default_();
    for (const Key& key : keys) {
        const toml::node* node = table->get(key.name_);
        const auto hold = [&](const Key::Rules& rules) {
            for (const auto& rule : rules)
                if (const std::string wrong = rule(); !wrong.empty())
                    fail(entry_of(key, node ? *node : entry.node), wrong);
        };
        if (node) hold(key.given_);
        hold(key.always_);
    }
}

}  // namespace eikonal::scene_file
