/// How a table of a scene file is described and read: one list of keys (name, meaning, target, range, rules) per table.
/// Parsing, type and range checks, unknown keys, the nearest valid name and contradictions all follow from that list.
/// Internal to the scene reader; what keys there are is in schema.cpp.
///
/// Numbers: an integer is accepted where a real number is wanted; NaN and infinity never. Magnitudes end at
/// kLargestValue, and what must be positive is at least kSmallestPositive, so that no later square or quotient of two
/// of them leaves double. Errors: UserError, one printable line "file:line: key: what is wrong, what is allowed".
#pragma once

#include <toml++/toml.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "warp/scene/message.h"
#include "warp/scene/scene.h"

namespace eikonal::scene_file {

using glm::dvec3;

/// One value of the file: its node, its dotted name ("medium.0.cn2"; empty: the scene itself), its file and meaning.
struct Entry {
    const toml::node& node;
    std::string name;
    const std::filesystem::path& file;
    std::string_view meaning = {};

    Entry member(std::string_view key, const toml::node& child, std::string_view its_meaning) const;
};

/// "file:line", or the --set option that the node came from.
std::string place(const toml::source_region& source, const std::filesystem::path& file);

/// Throws UserError "place: name: what".
[[noreturn]] void fail(const Entry& entry, std::string_view what);

/// The same for the common case "value V, must be … (meaning of the key)", V in TOML's own notation.
[[noreturn]] void fail_value(const Entry& entry, std::string_view must_be);

/// Values allowed for a number.
struct Range {
    double lo = -kLargestValue, hi = kLargestValue;

    bool contains(double v) const;
    std::string text(double v) const;  ///< "must be > 0", …, for a v outside
};
inline Range any() {
    return {};
}
inline Range at_least(double lo) {
    return {lo, kLargestValue};
}
inline Range positive() {
    return {kSmallestPositive, kLargestValue};
}
inline Range between(double lo, double hi) {
    return {lo, hi};
}

/// Ranges of the elements of a value, the last for all that follow.
using Ranges = std::vector<Range>;

/// names(E{}) of an enumeration: what the file says for each of its values. Defined in schema.cpp.
template <class E>
using Names = std::span<const std::pair<std::string_view, E>>;

/// A key of a table.
class Key {
  public:
    /// The target's type is the type the value must have: bool, int, std::uint64_t, double, std::string, path, dvec3,
    /// std::array, an enumeration, a struct or variant with keys(), or optional or vector of these.
    template <class T>
    Key(std::string_view name, std::string_view meaning, T& target, Ranges ranges = {any()});

    /// What must hold if the key is given: returns what is wrong, empty if nothing is.
    Key& given(std::function<std::string()> rule) { return add(given_, std::move(rule)); }
    /// The same whether the key is given or not; may also bring the target into its final form.
    Key& always(std::function<std::string()> rule) { return add(always_, std::move(rule)); }
    /// If the key is left out: its default, where that derives from other keys. Runs before any rule.
    Key& otherwise(std::function<void()> set_default) {
        default_ = std::move(set_default);
        return *this;
    }
    /// It may not be left out.
    Key& required() {
        required_ = true;
        return *this;
    }
    /// Applies only while the other key has one of these values.
    template <class E>
    Key& only_with(std::string_view other, const E& value, std::vector<E> allowed);
    /// Applies only without the other key.
    template <class T>
    Key& excludes(std::string_view other, const std::optional<T>& value) {
        return given([other, &value] {
            return value ? "contradicts " + std::string(other) + "; remove one of them" : std::string();
        });
    }

  private:
    friend void read_table(const Entry& entry, const std::vector<Key>& keys);

    using Rules = std::vector<std::function<std::string()>>;
    Key& add(Rules& rules, std::function<std::string()> rule) {
        rules.push_back(std::move(rule));
        return *this;
    }

    std::string_view name_, meaning_;
    std::function<void(const Entry&)> read_;
    std::function<void()> default_;
    Rules given_, always_;
    bool required_ = false;
};

/// Reads a table into the targets of its keys and applies their rules.
void read_table(const Entry& entry, const std::vector<Key>& keys);

// Readers by type. Each throws UserError; ranges may be ignored by types that have none.
void read_value(const Entry& entry, bool& target, const Ranges&);
void read_value(const Entry& entry, int& target, const Ranges& ranges);
void read_value(const Entry& entry, std::uint64_t& target, const Ranges&);
void read_value(const Entry& entry, double& target, const Ranges& ranges);
void read_value(const Entry& entry, std::string& target, const Ranges&);
void read_value(const Entry& entry, std::filesystem::path& target, const Ranges&);  ///< a file's: in its folder
void read_value(const Entry& entry, dvec3& target, const Ranges& ranges);

/// The array's elements into target; its length must be target's.
void read_numbers(const Entry& entry, std::span<double> target, const Ranges& ranges);
void read_numbers(const Entry& entry, std::span<int> target, const Ranges& ranges);

/// Index into `valid` of the string that the value must be.
std::size_t read_choice(const Entry& entry, std::span<const std::string_view> valid);

/// The entry's array, each element of which stands for a table.
const toml::array& array_of_tables(const Entry& entry);

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};

template <class T, std::size_t N>
void read_value(const Entry& entry, std::array<T, N>& target, const Ranges& ranges) {
    read_numbers(entry, std::span<T>(target), ranges);
}

template <class T>
void read_value(const Entry& entry, T& target, const Ranges& ranges) {
    if constexpr (IsOptional<T>::value) {
        read_value(entry, target.emplace(), ranges);
    } else if constexpr (IsVector<T>::value) {
        target.clear();
        for (const toml::node& node : array_of_tables(entry)) {
            const std::string index = std::to_string(target.size());
            read_value(entry.member(index, node, entry.meaning), target.emplace_back(), ranges);
        }
    } else if constexpr (std::is_enum_v<T>) {
        std::vector<std::string_view> valid;
        for (const auto& [name, value] : names(T{})) valid.push_back(name);
        target = names(T{})[read_choice(entry, valid)].second;
    } else {
        read_table(entry, keys(target));
    }
}

template <class T>
Key::Key(std::string_view name, std::string_view meaning, T& target, Ranges ranges)
    : name_(name),
      meaning_(meaning),
      read_([&target, ranges = std::move(ranges)](const Entry& entry) { read_value(entry, target, ranges); }) {}

template <class E>
Key& Key::only_with(std::string_view other, const E& value, std::vector<E> allowed) {
    return given([other, &value, allowed = std::move(allowed)] {
        std::string text;
        for (const E& a : allowed) {
            if (a == value) return std::string();
            for (const auto& [name, v] : names(E{}))
                if (v == a)
                    text += (text.empty() ? "" : " or ") + std::string(other) + " = \"" + std::string(name) + '"';
        }
        return "applies only with " + text + "; remove it or change " + std::string(other);
    });
}

}  // namespace eikonal::scene_file
