/// The keys of a table of a scene file: one list per table, which states for each key its name, meaning, unit, target,
/// range and rules. Defaults are what the targets hold before a file is read.
///
/// Each struct of parameters has a function `Keys keys(Spec&)` in its own namespace. Each enumeration has `names(E)`,
/// the words of its values. Code that reads files (KeyReader) and code that shows keys to people both use them. Nothing
/// here depends on the format of the file. A list refers to its struct, which must outlive it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "noise/medium/key_range.h"
#include "noise/medium/key_reader.h"
#include "noise/medium/key_target.h"

namespace eikonal {

/// The meaning of a number and its unit, for instance {"height of the camera", "m"}. The unit is empty if the number
/// has none or if the meaning contains it.
struct Quantity {
    std::string_view meaning, unit;
};

/// Quantities of the numbers of an array. The last one holds for all that follow.
using Quantities = std::vector<Quantity>;

class Key {
  public:
    /// The texts must outlive the key; use literals. The target has a type that noise/medium/key_target.h lists.
    template <class T>
    Key(std::string_view name, std::string_view meaning, T& target, Ranges ranges = default_ranges<T>())
        : Key(name, Quantities{{meaning, ""}}, target, std::move(ranges)) {}
    template <class T>
    Key(std::string_view name, std::string_view meaning, std::string_view unit, T& target,
        Ranges ranges = default_ranges<T>())
        : Key(name, Quantities{{meaning, unit}}, target, std::move(ranges)) {}
    /// An array whose numbers mean different things.
    template <class T>
    Key(std::string_view name, Quantities quantities, T& target, Ranges ranges = default_ranges<T>())
        : Key(name, std::move(quantities), std::make_shared<VariableTarget<T>>(target), std::move(ranges)) {}
    /// Any other target.
    Key(std::string_view name, Quantities quantities, std::shared_ptr<const KeyTarget> target, Ranges ranges = {any()})
        : name_(name), quantities_(std::move(quantities)), ranges_(std::move(ranges)), target_(std::move(target)) {}

    /// Sets the text that follows the unit in the help.
    Key& note(std::string_view text) {
        note_ = text;
        return *this;
    }

    // ---- rules ----

    /// Adds a rule for a key that is given. A rule returns what is wrong, or an empty text.
    Key& given(std::function<std::string()> rule) { return add(given_, std::move(rule)); }
    /// Adds a rule that is also applied if the key is left out. It may bring the target into its final form.
    Key& always(std::function<std::string()> rule) { return add(always_, std::move(rule)); }
    /// Sets the default of a key that is left out, if it follows from other keys. This runs before any rule.
    Key& otherwise(std::function<void()> set_default) {
        default_ = std::move(set_default);
        return *this;
    }
    /// Makes it an error to leave the key out.
    Key& required() {
        required_ = true;
        return *this;
    }
    /// The key applies only while the other key has one of these values.
    template <class E>
    Key& only_with(std::string_view other, const E& value, std::vector<E> allowed);
    /// The key applies only if the other key is left out.
    template <class T>
    Key& excludes(std::string_view other, const std::optional<T>& value) {
        return given([other, &value] {
            return value ? "contradicts " + std::string(other) + "; remove one of them" : std::string();
        });
    }

    // ---- for readers ----

    /// Sets the target. UserError: the value is not valid.
    void read(KeyReader& reader) const { target_->read(reader, ranges_); }
    /// Sets the default. To be called if the key is left out.
    void set_default() const {
        if (default_) default_();
    }
    bool is_required() const { return required_; }
    /// The message of the first broken rule; empty if none is broken. To be called after every key has been read.
    std::string broken_rule(bool key_is_given) const;

    // ---- for programs that show keys ----

    std::string_view name() const { return name_; }
    /// The meaning of number i.
    std::string_view meaning(std::size_t i = 0) const { return quantity(i).meaning; }
    std::string_view unit(std::size_t i = 0) const { return quantity(i).unit; }
    const Range& range(std::size_t i = 0) const { return range_of(ranges_, i); }
    /// One line with the meanings, the units in brackets and the note, for instance "diameter of the lens [m]; 0 is a
    /// point". Neighbours that share a unit have it once.
    std::string help() const;
    /// The target, which tells kind, number of numbers, current value, words and tables.
    const KeyTarget& target() const { return *target_; }

  private:
    using Rules = std::vector<std::function<std::string()>>;
    Key& add(Rules& rules, std::function<std::string()> rule) {
        rules.push_back(std::move(rule));
        return *this;
    }
    const Quantity& quantity(std::size_t i) const;

    std::string_view name_;
    Quantities quantities_;
    std::string_view note_;
    Ranges ranges_;
    std::shared_ptr<const KeyTarget> target_;
    std::function<void()> default_;
    Rules given_, always_;
    bool required_ = false;
};

template <class E>
Key& Key::only_with(std::string_view other, const E& value, std::vector<E> allowed) {
    return given([other, &value, allowed = std::move(allowed)] {
        std::string text;
        for (const E& a : allowed) {
            if (a == value) return std::string();
            text += (text.empty() ? "" : " or ") + std::string(other) + " = \"" + std::string(word_of(a)) + '"';
        }
        return "applies only with " + text + "; remove it or change " + std::string(other);
    });
}

/// A vector of which only the direction matters. It must not be zero, and is normalised.
Key direction_key(std::string_view name, std::string_view meaning, glm::dvec3& target);

}  // namespace eikonal
