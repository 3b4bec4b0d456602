/// Reads keys (noise/medium/keys.h) from the nodes of a TOML file. Internal to the scene reader.
///
/// Types, ranges, unknown keys, nearest valid names and contradictions are checked here for every list of keys.
/// An integer is accepted where a real number is wanted. NaN and infinity are never accepted.
/// Errors: UserError, one printable line "file:line: key: what is wrong, what is allowed".
#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "noise/medium/keys.h"
#include "warp/scene/message.h"

namespace eikonal::scene_file {

/// One value of the file: its node, its dotted name ("medium.0.cn2"; empty: the scene itself), its file, and the help
/// text of its key.
struct Entry {
    const toml::node& node;
    std::string name;
    const std::filesystem::path& file;
    std::string help = {};

    Entry member(std::string_view key, const toml::node& child, std::string its_help) const;
};

/// "file:line", or the --set option that the node came from.
std::string place(const toml::source_region& source, const std::filesystem::path& file);

/// Throws UserError "place: name: what".
[[noreturn]] void fail(const Entry& entry, std::string_view what);

/// Throws UserError "place: name = V, must be … (help text of the key)", with V in TOML's own notation.
[[noreturn]] void fail_value(const Entry& entry, std::string_view must_be);

class TomlReader final : public KeyReader {
  public:
    /// The entry's node and file must outlive the reader.
    explicit TomlReader(Entry entry) : entry_(std::move(entry)) {}

    bool read_bool() override;
    int read_int(const Range& range) override;
    std::uint64_t read_uint64(const Range& range) override;
    double read_double(const Range& range) override;
    std::string read_text() override;
    /// The path, relative to the folder of the file. If a --set option gives it, relative to the working folder.
    std::filesystem::path read_path() override;
    void read_numbers(std::span<double> target, const Ranges& ranges) override;
    void read_numbers(std::span<int> target, const Ranges& ranges) override;
    std::size_t read_choice(std::span<const std::string_view> words) override;
    void read_table(const Keys& keys) override;
    void read_tables(const std::function<void(KeyReader&)>& read_one) override;
    std::size_t read_kind(std::string_view name, std::string_view meaning,
                          std::span<const std::string_view> words) override;

  private:
    const toml::table& table() const;
    /// A key of the table that is not in the list.
    [[noreturn]] void fail_unknown(const toml::key& name, const Keys& keys) const;

    Entry entry_;
};

}  // namespace eikonal::scene_file
