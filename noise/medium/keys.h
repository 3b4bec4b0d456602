/// The keys of a table of a scene file: one list per table, which states for each key its name, meaning, unit, target,
/// range and rules. Defaults are what the targets hold before a file is read.
///
/// Each struct of parameters has a function `Keys keys(Spec&)` in its own namespace, and each enumeration `names(E)`,
/// the words of its values. Whoever reads files (KeyReader) or shows keys to people finds them there. Nothing here
/// depends on the format of the file. A list refers to its struct, which must outlive it.
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

/// What a number is and its unit, for instance {"height of the camera", "m"}. The unit is empty if the number has none
/// or the meaning says it in words.
struct Quantity {
    std::string_view meaning, unit;
};

/// Quantities of the numbers of an array. The last one holds for all that follow.
using Quantities = std::vector<Quantity>;

class Key {
  public:
    /// Text must outlive the key: literals. The target's type is one that noise/medium/key_target.h names.
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

    /// What follows the unit in the help text.
    Key& note(std::string_view text) {
        note_ = text;
        return *this;
    }

    // ---- rules ----

    /// What must hold if the key is given: returns what is wrong, empty if nothing is.
    Key& given(std::function<std::string()> rule) { return add(given_, std::move(rule)); }
    /// The same whether the key is given or not. May also bring the target into its final form.
    Key& always(std::function<std::string()> rule) { return add(always_, std::move(rule)); }
    /// If the key is left out: sets its default, where that derives from other keys. Runs before any rule.
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

    // ---- for readers ----

    /// Sets the target. Throws UserError.
    void read(KeyReader& reader) const { target_->read(reader, ranges_); }
    /// To be called if the key is left out.
    void set_default() const {
        if (default_) default_();
    }
    bool is_required() const { return required_; }
    /// The first rule that does not hold, empty if all do. To be called once every key is read.
    std::string broken_rule(bool key_is_given) const;

    // ---- for those who look ----

    std::string_view name() const { return name_; }
    /// Of number i.
    std::string_view meaning(std::size_t i = 0) const { return quantity(i).meaning; }
    std::string_view unit(std::size_t i = 0) const { return quantity(i).unit; }
    const Range& range(std::size_t i = 0) const { return range_of(ranges_, i); }
    /// One line: meanings, units in brackets and the note, for instance "diameter of the lens [m]; 0 is a point". A
    /// unit is said once for neighbours that share it.
    std::string help() const;
    /// Kind, number of numbers, current value, words and tables.
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

/// A vector of which only the direction counts. It may not be zero, and is normalised.
Key direction_key(std::string_view name, std::string_view meaning, glm::dvec3& target);

}  // namespace eikonal
