#include "warp/scene/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "noise/base/error.h"
#include "warp/scene/message.h"
#include "warp/scene/toml_guard.h"
#include "warp/scene/toml_reader.h"

namespace eikonal::scene_file {

namespace {

constexpr std::string_view kValue = "v";  // the key under which Setting::parsed() puts a value

/// A setting while it is applied.
struct Setting {
    std::string option;  // "`set` KEY=VALUE", as it appears in messages and as a source
    toml::source_region source;

    [[noreturn]] void fail(std::string_view what) const {
        throw UserError(printable(fmt::format("{}: {}", option, what)));
    }

    /// A table with the value, which names the option as its source.
    toml::table parsed(std::string_view value) const {
        return toml::parse(fmt::format("{} = {}", kValue, value), option);
    }
};

std::vector<std::string_view> parts_of(std::string_view key) {
    std::vector<std::string_view> parts;
    for (std::size_t begin = 0; begin <= key.size();) {
        const std::size_t end = std::min(key.find('.', begin), key.size());
        parts.push_back(key.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

std::optional<std::size_t> index_of(std::string_view part) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
    if (part.empty() || error != std::errc() || end != part.data() + part.size()) return {};
    return index;
}

/// An element of a table or array, which need not exist.
class Slot {
  public:
    /// above: the container's dotted key, for messages. UserError if the container cannot have such an element.
    Slot(const Setting& setting, toml::node& container, std::string_view part, const std::string& above)
        : source_(setting.source), table_(container.as_table()), array_(container.as_array()), key_(part) {
        if (!table_ && !array_) setting.fail(fmt::format("{} is no table and has no '{}'", above, part));
        if (!array_) return;
        const std::optional<std::size_t> index = index_of(part);
        if (!index || *index > array_->size())
            setting.fail(
                fmt::format("'{0}' is no element of {1}, which has {2}; the next is {2}", part, above, array_->size()));
        index_ = *index;
    }

    toml::node* get() const { return table_ ? table_->get(key_) : array_->get(index_); }

    void remove() {
        if (table_)
            table_->erase(key_);
        else if (get())
            array_->erase(array_->cbegin() + static_cast<std::ptrdiff_t>(index_));
    }

    /// Puts the node there, together with its source.
    void assign(toml::node&& value) {
        if (table_) {
            table_->erase(key_);  // the old key would keep the file as its source
            table_->insert(toml::key(key_, source_), std::move(value));
        } else if (get()) {
            array_->replace(array_->cbegin() + static_cast<std::ptrdiff_t>(index_), std::move(value));
        } else {
            array_->push_back(std::move(value));
        }
    }

  private:
    const toml::source_region& source_;
    toml::table* table_;
    toml::array* array_;
    std::string_view key_;
    std::size_t index_ = 0;
};

/// A table that holds VALUE, or nothing if VALUE is empty.
toml::table parsed_value(const Setting& setting, const std::string& value) {
    if (value.find_first_not_of(" \t\r\n") == std::string::npos) return {};
    if (too_dotted_line(value)) setting.fail(fmt::format("more than {} dots", kMostDots));
    if (value.find_first_of("\r\n") == std::string::npos) {
        try {
            return setting.parsed(value);
        } catch (const toml::parse_error&) {  // a bare word
        }
    }
    toml::table text = setting.parsed("''");
    *text[kValue].as_string() = value;
    return text;
}

}  // namespace

void apply_setting(toml::table& root, const std::string& text) {
    Setting setting{"`set` " + text, {}};
    setting.source.path = std::make_shared<const std::string>(setting.option);
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) setting.fail("must be KEY=VALUE, such as medium.0.cn2=1e-13");

    std::string key = text.substr(0, equals);
    std::erase_if(key, [](char c) { return c == ' ' || c == '\t'; });
    const std::vector<std::string_view> parts = parts_of(key);
    if (parts.size() > kDeepestKey)
        setting.fail(fmt::format("key has {} parts; no key has more than {}", parts.size(), kDeepestKey));
    if (std::any_of(parts.begin(), parts.end(), [](std::string_view p) { return p.empty(); }))
        setting.fail("a part of the key is empty");

    toml::table value = parsed_value(setting, text.substr(equals + 1));
    toml::node* container = &root;
    std::string above;
    for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
        Slot slot(setting, *container, parts[i], above);
        if (!slot.get()) slot.assign(std::move(*setting.parsed(index_of(parts[i + 1]) ? "[]" : "{}").get(kValue)));
        container = slot.get();
        above += (above.empty() ? "" : ".") + std::string(parts[i]);
    }
    Slot slot(setting, *container, parts.back(), above);
    if (value.empty())
        slot.remove();
    else
        slot.assign(std::move(*value.get(kValue)));
}

toml::table parse_root(std::string_view text, const std::string& name, const std::vector<std::string>& settings) {
    if (const std::size_t line = too_dotted_line(text))
        throw UserError(
            fmt::format("{}:{}: more than {} dots in keys and text; shorten the file", name, line, kMostDots));
    toml::table root;
    try {
        root = toml::parse(text, name);
    } catch (const toml::parse_error& error) {
        throw UserError(printable(fmt::format("{}: {}", place(error.source(), name), error.description())));
    }
    for (const std::string& setting : settings) apply_setting(root, setting);
    return root;
}

}  // namespace eikonal::scene_file
