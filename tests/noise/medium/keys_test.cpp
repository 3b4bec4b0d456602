// Key lists without any file format: what a reader is asked for, the rules, and what a program that shows keys gets.
#include "noise/medium/keys.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/vec3.hpp>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "noise/base/error.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/medium/optics.h"
#include "noise/profile/profile_spec.h"
#include "noise/surface/surface_spec.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {
namespace {

// ---- a table of every type of value ----

enum class Colour { Red, DarkBlue };

EnumNames<Colour> names(Colour) {
    static constexpr std::pair<std::string_view, Colour> list[] = {{"red", Colour::Red},
                                                                   {"dark-blue", Colour::DarkBlue}};
    return list;
}

struct Leaf {
    double length = 2;
};

Keys keys(Leaf& leaf) {
    return {{"length", "of the leaf", "m", leaf.length, {positive()}}};
}

struct Plant {
    bool alive = true;
    int age = 3;
    std::uint64_t seed = 7;
    double height = 1.5;
    std::string label = "fern";
    std::filesystem::path picture = "fern.png";
    glm::dvec3 place{0, 1, -0.25};
    std::array<int, 2> pot{4, 5};
    std::optional<std::array<double, 2>> light;
    Colour colour = Colour::DarkBlue;
    std::optional<Colour> flower;
    Leaf leaf;
    std::optional<Leaf> dead_leaf;
    std::vector<Leaf> more;
};

Keys keys(Plant& p) {
    return {
        {"alive", "whether it grows", p.alive},
        {"age", "in years", p.age, {between(0, 100)}},
        {"seed", "it came from", p.seed},
        Key("height", "above ground", "m", p.height, {at_least(0)}).note("0 is a seed"),
        {"label", "text on it", p.label},
        {"picture", "of it", p.picture},
        {"place", "", "m", p.place},
        {"pot", "width and depth", "cm", p.pot, {between(1, 9), between(1, 99)}},
        {"light", Quantities{{"strength", "lx"}, {"angle to the sun", ""}}, p.light, {positive(), any()}},
        {"colour", "of the leaves", p.colour},
        {"flower", "colour of the flower", p.flower},
        {"leaf", "the first", p.leaf},
        {"dead_leaf", "one on the ground", p.dead_leaf},
        {"more", "further ones", p.more},
    };
}

const Key& key(const Keys& list, std::string_view name) {
    for (const Key& one : list)
        if (one.name() == name) return one;
    throw std::out_of_range(std::string(name));
}

/// Answers every question with a value of its own, and keeps the ranges that it was given.
struct FixedReader final : KeyReader {
    std::map<std::string, Ranges> asked;
    double number = 8;
    std::size_t tables = 2;

    bool read_bool() override { return false; }
    int read_int(const Range& range) override { return static_cast<int>(answer("int", {range})); }
    std::uint64_t read_uint64(const Range& range) override {
        return static_cast<std::uint64_t>(answer("uint64", {range}));
    }
    double read_double(const Range& range) override { return answer("double", {range}); }
    std::string read_text() override { return "moss"; }
    std::filesystem::path read_path() override { return "moss.png"; }
    void read_numbers(std::span<double> target, const Ranges& ranges) override { fill(target, "doubles", ranges); }
    void read_numbers(std::span<int> target, const Ranges& ranges) override { fill(target, "ints", ranges); }
    std::size_t read_choice(std::span<const std::string_view> words) override {
        EXPECT_EQ(words.size(), 2u);
        return 0;
    }
    void read_table(const Keys& keys) override {
        for (const Key& one : keys) one.read(*this);
    }
    void read_tables(const std::function<void(KeyReader&)>& read_one) override {
        for (std::size_t i = 0; i < tables; ++i) read_one(*this);
    }
    std::size_t read_kind(std::string_view, std::string_view, std::span<const std::string_view>) override { return 0; }

    double answer(const std::string& type, const Ranges& ranges) {
        asked[type] = ranges;
        for (const Range& range : ranges)
            if (!range.contains(number)) throw UserError(range.text(number));
        return number;
    }
    template <class T>
    void fill(std::span<T> target, const std::string& type, const Ranges& ranges) {
        for (std::size_t i = 0; i < target.size(); ++i) target[i] = static_cast<T>(number + static_cast<double>(i));
        asked[type] = ranges;
    }
};

TEST(Keys, EveryTypeIsReadIntoItsTarget) {
    Plant p;
    FixedReader reader;
    reader.read_table(keys(p));
    EXPECT_FALSE(p.alive);
    EXPECT_EQ(p.age, 8);
    EXPECT_EQ(p.seed, 8u);
    EXPECT_EQ(p.height, 8);
    EXPECT_EQ(p.label, "moss");
    EXPECT_EQ(p.picture, "moss.png");
    EXPECT_EQ(p.place, glm::dvec3(8, 9, 10));
    EXPECT_EQ(p.pot, (std::array{8, 9}));
    EXPECT_EQ(*p.light, (std::array{8.0, 9.0}));
    EXPECT_EQ(p.colour, Colour::Red);
    EXPECT_EQ(*p.flower, Colour::Red);
    EXPECT_EQ(p.leaf.length, 8);
    EXPECT_EQ(p.dead_leaf->length, 8);
    ASSERT_EQ(p.more.size(), 2u);
    EXPECT_EQ(p.more[1].length, 8);
}

TEST(Keys, ReadersAreGivenTheRanges) {
    Plant p;
    const Keys list = keys(p);
    FixedReader reader;
    key(list, "pot").read(reader);
    ASSERT_EQ(reader.asked["ints"].size(), 2u);
    EXPECT_EQ(reader.asked["ints"][1].hi, 99);
    key(list, "seed").read(reader);
    EXPECT_EQ(reader.asked["uint64"][0].lo, 0);
    reader.number = -1;
    try {
        key(list, "height").read(reader);
        FAIL();
    } catch (const UserError& error) {
        EXPECT_STREQ(error.what(), "must be >= 0");
    }
    EXPECT_EQ(p.height, 1.5);
}

TEST(Keys, KindSizeTextAndWordsCanBeLookedAt) {
    Plant p;
    const Keys list = keys(p);
    struct Expected {
        ValueKind kind;
        std::size_t size;
        bool optional;
        const char* text;
    };
    using enum ValueKind;
    const std::map<std::string_view, Expected> expected{
        {"alive", {Boolean, 1, false, "true"}},
        {"age", {WholeNumber, 1, false, "3"}},
        {"seed", {WholeNumber, 1, false, "7"}},
        {"height", {Number, 1, false, "1.5"}},
        {"label", {Text, 1, false, "fern"}},
        {"picture", {File, 1, false, "fern.png"}},
        {"place", {Number, 3, false, "[0, 1, -0.25]"}},
        {"pot", {WholeNumber, 2, false, "[4, 5]"}},
        {"light", {Number, 2, true, ""}},
        {"colour", {Choice, 1, false, "dark-blue"}},
        {"flower", {Choice, 1, true, ""}},
        {"leaf", {Table, 1, false, ""}},
        {"dead_leaf", {Table, 1, true, ""}},
        {"more", {Tables, 1, false, ""}},
    };
    ASSERT_EQ(list.size(), expected.size());
    for (const Key& one : list) {
        const Expected& e = expected.at(one.name());
        EXPECT_EQ(one.target().kind(), e.kind) << one.name();
        EXPECT_EQ(one.target().size(), e.size) << one.name();
        EXPECT_EQ(one.target().optional(), e.optional) << one.name();
        EXPECT_EQ(one.target().text(), e.text) << one.name();
        EXPECT_EQ(one.target().words().size(), e.kind == Choice ? 2u : 0u) << one.name();
    }
    EXPECT_EQ(key(list, "flower").target().words()[1], "dark-blue");
    // The text is the current value, not the default.
    p.light = {{1e-13, 293.15}};
    p.flower = Colour::Red;
    EXPECT_EQ(key(list, "light").target().text(), "[1e-13, 293.15]");
    EXPECT_EQ(key(list, "flower").target().text(), "red");
}

TEST(Keys, RangesUnitsAndHelpCanBeLookedAt) {
    Plant p;
    const Keys list = keys(p);
    EXPECT_EQ(key(list, "height").help(), "above ground [m]; 0 is a seed");
    EXPECT_EQ(key(list, "height").unit(), "m");
    EXPECT_EQ(key(list, "height").meaning(), "above ground");
    EXPECT_EQ(key(list, "place").help(), "[m]");
    EXPECT_EQ(key(list, "place").unit(2), "m");
    EXPECT_EQ(key(list, "age").help(), "in years");
    EXPECT_EQ(key(list, "age").unit(), "");
    EXPECT_EQ(key(list, "age").range().hi, 100);
    EXPECT_EQ(key(list, "pot").range(0).hi, 9);
    EXPECT_EQ(key(list, "pot").range(1).hi, 99);
    EXPECT_EQ(key(list, "light").help(), "strength [lx], angle to the sun");
    EXPECT_EQ(key(list, "light").meaning(1), "angle to the sun");
    EXPECT_EQ(key(list, "light").unit(1), "");
    TurbulenceSpec turbulence;
    const Keys turbulence_keys = keys(turbulence);
    EXPECT_EQ(key(turbulence_keys, "period").help(), "Lx, Ly, Lz [m], T [s]");
    EXPECT_EQ(key(turbulence_keys, "period").unit(2), "m");
    EXPECT_EQ(key(turbulence_keys, "period").unit(3), "s");
}

TEST(Keys, TablesWithinCanBeLookedAt) {
    Plant p;
    p.leaf.length = 5;
    const Keys list = keys(p);
    const auto lengths = [&](std::string_view name) {
        std::vector<std::string> found;
        key(list, name).target().visit_tables([&](const Keys& within) {
            found.push_back(key(within, "length").target().text());
        });
        return found;
    };
    EXPECT_EQ(lengths("leaf"), (std::vector<std::string>{"5"}));
    EXPECT_EQ(lengths("dead_leaf"), (std::vector<std::string>{"2"}));  // left out: the defaults
    EXPECT_EQ(lengths("more"), (std::vector<std::string>{"2"}));
    p.dead_leaf = Leaf{6};
    p.more = {Leaf{7}, Leaf{8}};
    EXPECT_EQ(lengths("dead_leaf"), (std::vector<std::string>{"6"}));
    EXPECT_EQ(lengths("more"), (std::vector<std::string>{"7", "8"}));
    EXPECT_TRUE(lengths("height").empty());
}

TEST(Keys, RulesSayWhatIsWrong) {
    Colour colour = Colour::Red;
    double size = 1;
    std::optional<double> other;
    const Key one = Key("size", "", size)
                        .excludes("other", other)
                        .only_with("colour", colour, {Colour::Red, Colour::DarkBlue})
                        .always([&] { return size > 0 ? "" : "must be > 0"; })
                        .otherwise([&] { size = 4; });
    EXPECT_EQ(one.broken_rule(true), "");
    other = 3;
    EXPECT_EQ(one.broken_rule(true), "contradicts other; remove one of them");
    EXPECT_EQ(one.broken_rule(false), "");
    size = -1;
    EXPECT_EQ(one.broken_rule(false), "must be > 0");
    one.set_default();
    EXPECT_EQ(size, 4);
    EXPECT_FALSE(one.is_required());

    const Key blue = Key("size", "", size).only_with("colour", colour, {Colour::DarkBlue}).required();
    EXPECT_TRUE(blue.is_required());
    EXPECT_EQ(blue.broken_rule(true), "applies only with colour = \"dark-blue\"; remove it or change colour");
}

TEST(Keys, DirectionsAreNormalised) {
    glm::dvec3 v(0, 3, 4);
    const Key one = direction_key("normal", "of a plane", v);
    EXPECT_EQ(one.broken_rule(false), "");
    EXPECT_NEAR(v.y, 0.6, 1e-15);
    EXPECT_NEAR(v.z, 0.8, 1e-15);
    v = {0, 0, 0};
    EXPECT_EQ(one.broken_rule(false), "must not be a zero vector");
}

TEST(Ranges, SayWhatIsAllowed) {
    EXPECT_EQ(between(0, 1).text(2), "must be >= 0 and <= 1");
    EXPECT_EQ(positive().text(0), "must be > 0");
    EXPECT_EQ(positive().text(1e-13), "must be >= 1e-12");
    EXPECT_EQ(at_least(0).text(-1), "must be >= 0");
    EXPECT_EQ(any().text(1e13), "must be <= 1000000000000");
    EXPECT_EQ(any().text(std::numeric_limits<double>::quiet_NaN()), "must be finite");
    EXPECT_FALSE(any().contains(std::numeric_limits<double>::quiet_NaN()));
    EXPECT_TRUE(between(0, 1).contains(1));
}

// ---- the lists of the media ----

/// Every number of a list and of its tables lies in the range that its key states. Every key has a meaning.
void check(const Keys& list) {
    for (const Key& one : list) {
        EXPECT_FALSE(one.help().empty()) << one.name();
        if (const std::string text = one.target().text(); one.target().kind() == ValueKind::Number && !text.empty()) {
            std::size_t at = text.find_first_of("-0123456789");
            for (std::size_t i = 0; i < one.target().size(); ++i) {
                EXPECT_TRUE(one.range(i).contains(std::stod(text.substr(at)))) << one.name() << " = " << text;
                at = text.find(' ', at) + 1;
            }
        }
        if (one.target().kind() == ValueKind::Choice) {
            EXPECT_FALSE(one.target().text().empty()) << one.name();
        }
        one.target().visit_tables(check);
    }
}

TEST(Keys, DefaultsOfEveryMediumLieInTheirRanges) {
    TurbulenceSpec turbulence;
    SurfaceSpec surface;
    BlobsSpec blobs;
    ProfileSpec profile;
    OpticsSpec optics;
    check(keys(turbulence));
    check(keys(surface));
    check(keys(blobs));
    check(keys(profile));
    check(keys(optics));
}

}  // namespace
}  // namespace eikonal
