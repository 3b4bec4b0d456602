#include "noise/medium/keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace eikonal {

std::string Range::text(double v) const {
    if (!std::isfinite(v)) return "must be finite";
    if (lo > -kLargestValue && hi < kLargestValue) return fmt::format("must be >= {} and <= {}", lo, hi);
    if (v > hi) return fmt::format("must be <= {}", hi);
    if (lo == kSmallestPositive && v <= 0) return "must be > 0";
    return fmt::format("must be >= {}", lo);
}

const Range& range_of(const Ranges& ranges, std::size_t i) {
    return ranges[std::min(i, ranges.size() - 1)];
}

void read_value(KeyReader& reader, bool& target, const Ranges&) {
    target = reader.read_bool();
}
void read_value(KeyReader& reader, int& target, const Ranges& ranges) {
    target = reader.read_int(range_of(ranges, 0));
}
void read_value(KeyReader& reader, std::uint64_t& target, const Ranges& ranges) {
    target = reader.read_uint64(range_of(ranges, 0));
}
void read_value(KeyReader& reader, double& target, const Ranges& ranges) {
    target = reader.read_double(range_of(ranges, 0));
}
void read_value(KeyReader& reader, std::string& target, const Ranges&) {
    target = reader.read_text();
}
void read_value(KeyReader& reader, std::filesystem::path& target, const Ranges&) {
    target = reader.read_path();
}
void read_value(KeyReader& reader, glm::dvec3& target, const Ranges& ranges) {
    std::array<double, 3> v{};
    reader.read_numbers(v, ranges);
    target = {v[0], v[1], v[2]};
}

std::string value_text(bool value) {
    return value ? "true" : "false";
}
std::string value_text(int value) {
    return fmt::format("{}", value);
}
std::string value_text(std::uint64_t value) {
    return fmt::format("{}", value);
}
std::string value_text(double value) {
    return fmt::format("{}", value);
}
std::string value_text(const std::string& value) {
    return value;
}
std::string value_text(const std::filesystem::path& value) {
    return value.string();
}
std::string value_text(const glm::dvec3& value) {
    return value_text(std::array{value.x, value.y, value.z});
}
std::string value_text(std::span<const double> value) {
    return fmt::format("[{}]", fmt::join(value, ", "));
}
std::string value_text(std::span<const int> value) {
    return fmt::format("[{}]", fmt::join(value, ", "));
}

std::string Key::broken_rule(bool key_is_given) const {
    if (key_is_given)
        for (const auto& rule : given_)
            if (std::string wrong = rule(); !wrong.empty()) return wrong;
    for (const auto& rule : always_)
        if (std::string wrong = rule(); !wrong.empty()) return wrong;
    return {};
}

std::string Key::help() const {
    std::string text;
    for (std::size_t i = 0; i < quantities_.size(); ++i) {
        const auto& [meaning, unit] = quantities_[i];
        if (i > 0) text += ", ";
        text += meaning;
        const bool last_of_unit = i + 1 == quantities_.size() || quantities_[i + 1].unit != unit;
        if (!unit.empty() && last_of_unit) text += fmt::format("{}[{}]", meaning.empty() ? "" : " ", unit);
    }
    return note_.empty() ? text : fmt::format("{}; {}", text, note_);
}

const Quantity& Key::quantity(std::size_t i) const {
    return quantities_[std::min(i, quantities_.size() - 1)];
}

Key direction_key(std::string_view name, std::string_view meaning, glm::dvec3& target) {
    return Key(name, meaning, target).always([&target] {
        const double length = glm::length(target);
        if (!(length >= kSmallestPositive)) return "must not be a zero vector";
        target /= length;
        return "";
    });
}

}  // namespace eikonal
