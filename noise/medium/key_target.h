/// The variable that a key of a scene file sets, without its type.
///
/// A target can be read from a file, and its value can be shown. Programs show the keys of a scene as lists or as
/// sliders. Types: bool, int, std::uint64_t, double, std::string, path, dvec3, std::array of int or double, an
/// enumeration with names(), a struct with keys(), and std::optional or std::vector of these. names() and keys() are
/// found by argument-dependent lookup. A type that is read in another way has its own
/// read_value(KeyReader&, T&, const Ranges&).
#pragma once

#include <array>
#include <concepts>
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

#include "noise/medium/key_reader.h"

namespace eikonal {

/// The kind of value that a key has. A choice is one word of a list. A table has keys of its own.
enum class ValueKind { Boolean, WholeNumber, Number, Text, File, Choice, Table, Tables };

/// The words of a scene file for the values of an enumeration E: the type of names(E{}).
template <class E>
using EnumNames = std::span<const std::pair<std::string_view, E>>;

/// Called with the keys of a table. They live during the call only.
using TableVisitor = std::function<void(const Keys&)>;

class KeyTarget {
  public:
    virtual ~KeyTarget() = default;

    /// Sets the variable. UserError: the value is not valid.
    virtual void read(KeyReader& reader, const Ranges& ranges) const = 0;

    virtual ValueKind kind() const = 0;
    /// Number of numbers that the value consists of: 1, or the length of an array.
    virtual std::size_t size() const { return 1; }
    /// Whether the variable may be without a value.
    virtual bool optional() const { return false; }
    /// The value as it stands in a scene file, words and text without quotes. Empty for no value and for tables.
    virtual std::string text() const { return {}; }
    /// The words of a choice.
    virtual std::vector<std::string_view> words() const { return {}; }
    /// Visits the keys of the table, or of each table of an array. If there is no table, visits those of a table with
    /// default values, unless its type has no defaults.
    virtual void visit_tables(const TableVisitor&) const {}
};

// ---- what depends on the type ----

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};

/// The number of numbers in a value, and their type.
template <class T>
struct NumbersOf {
    using Number = T;
    static constexpr std::size_t kSize = 1;
};
template <>
struct NumbersOf<glm::dvec3> {
    using Number = double;
    static constexpr std::size_t kSize = 3;
};
template <class T, std::size_t N>
struct NumbersOf<std::array<T, N>> {
    using Number = T;
    static constexpr std::size_t kSize = N;
};
template <class T>
struct NumbersOf<std::optional<T>> : NumbersOf<T> {};

template <class T>
constexpr ValueKind value_kind() {
    using Number = typename NumbersOf<T>::Number;
    if constexpr (IsOptional<T>::value)
        return value_kind<typename T::value_type>();
    else if constexpr (IsVector<T>::value)
        return ValueKind::Tables;
    else if constexpr (std::is_same_v<T, bool>)
        return ValueKind::Boolean;
    else if constexpr (std::is_integral_v<Number>)
        return ValueKind::WholeNumber;
    else if constexpr (std::is_floating_point_v<Number>)
        return ValueKind::Number;
    else if constexpr (std::is_same_v<T, std::string>)
        return ValueKind::Text;
    else if constexpr (std::is_same_v<T, std::filesystem::path>)
        return ValueKind::File;
    else if constexpr (std::is_enum_v<T>)
        return ValueKind::Choice;
    else
        return ValueKind::Table;
}

/// The range of a key that states none.
template <class T>
Ranges default_ranges() {
    return {std::is_same_v<typename NumbersOf<T>::Number, std::uint64_t> ? any_seed() : any()};
}

template <class E>
std::vector<std::string_view> words_of() {
    std::vector<std::string_view> words;
    for (const auto& [word, value] : names(E{})) words.push_back(word);
    return words;
}

/// The word for a value; empty if the list of names has none.
template <class E>
std::string_view word_of(E value) {
    for (const auto& [word, v] : names(E{}))
        if (v == value) return word;
    return {};
}

// ---- reading ----

void read_value(KeyReader& reader, bool& target, const Ranges& ranges);
void read_value(KeyReader& reader, int& target, const Ranges& ranges);
void read_value(KeyReader& reader, std::uint64_t& target, const Ranges& ranges);
void read_value(KeyReader& reader, double& target, const Ranges& ranges);
void read_value(KeyReader& reader, std::string& target, const Ranges& ranges);
void read_value(KeyReader& reader, std::filesystem::path& target, const Ranges& ranges);
void read_value(KeyReader& reader, glm::dvec3& target, const Ranges& ranges);

template <class T, std::size_t N>
void read_value(KeyReader& reader, std::array<T, N>& target, const Ranges& ranges) {
    reader.read_numbers(std::span<T>(target), ranges);
}

template <class T>
void read_value(KeyReader& reader, T& target, const Ranges& ranges) {
    if constexpr (IsOptional<T>::value) {
        read_value(reader, target.emplace(), ranges);
    } else if constexpr (IsVector<T>::value) {
        target.clear();
        reader.read_tables([&](KeyReader& one) { read_value(one, target.emplace_back(), ranges); });
    } else if constexpr (std::is_enum_v<T>) {
        target = names(T{})[reader.read_choice(words_of<T>())].second;
    } else {
        reader.read_table(keys(target));
    }
}

// ---- showing ----

std::string value_text(bool value);
std::string value_text(int value);
std::string value_text(std::uint64_t value);
std::string value_text(double value);
std::string value_text(const std::string& value);
std::string value_text(const std::filesystem::path& value);
std::string value_text(const glm::dvec3& value);
std::string value_text(std::span<const double> value);
std::string value_text(std::span<const int> value);

/// The target of a variable of type T, which must outlive it.
template <class T>
class VariableTarget final : public KeyTarget {
  public:
    explicit VariableTarget(T& variable) : variable_(variable) {}

    void read(KeyReader& reader, const Ranges& ranges) const override { read_value(reader, variable_, ranges); }
    ValueKind kind() const override { return value_kind<T>(); }
    std::size_t size() const override { return NumbersOf<T>::kSize; }
    bool optional() const override { return IsOptional<T>::value; }
    std::string text() const override { return text_of(variable_); }
    std::vector<std::string_view> words() const override { return words_of_type<T>(); }
    void visit_tables(const TableVisitor& visit) const override {
        if constexpr (value_kind<T>() == ValueKind::Table || value_kind<T>() == ValueKind::Tables)
            visit_tables_of(variable_, visit);
    }

  private:
    template <class V>
    static std::string text_of(const V& value) {
        constexpr ValueKind kKind = value_kind<V>();
        if constexpr (kKind == ValueKind::Table || kKind == ValueKind::Tables)
            return {};
        else if constexpr (IsOptional<V>::value)
            return value ? text_of(*value) : std::string();
        else if constexpr (kKind == ValueKind::Choice)
            return std::string(word_of(value));
        else
            return value_text(value);
    }
    template <class V>
    static std::vector<std::string_view> words_of_type() {
        if constexpr (IsOptional<V>::value)
            return words_of_type<typename V::value_type>();
        else if constexpr (std::is_enum_v<V>)
            return words_of<V>();
        else
            return {};
    }
    template <class V>
    static void visit_tables_of(V& value, const TableVisitor& visit) {
        if constexpr (IsOptional<V>::value) {
            value ? visit(keys(*value)) : visit_defaults<typename V::value_type>(visit);
        } else if constexpr (IsVector<V>::value) {
            for (auto& one : value) visit(keys(one));
            if (value.empty()) visit_defaults<typename V::value_type>(visit);
        } else {
            visit(keys(value));
        }
    }
    template <class V>
    static void visit_defaults(const TableVisitor& visit) {
        if constexpr (std::default_initializable<V>) {
            V defaults{};
            visit(keys(defaults));
        }
    }

    T& variable_;
};

}  // namespace eikonal
