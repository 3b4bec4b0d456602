/// Reads one value of a scene file. Each format of scene files has a KeyReader.
///
/// The type of a key decides which function is called. Each function returns a valid value or throws UserError, one
/// line that names the place, the key and what is allowed. An integer is accepted where a real number is wanted.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "noise/medium/key_range.h"

namespace eikonal {

class Key;
using Keys = std::vector<Key>;

class KeyReader {
  public:
    virtual ~KeyReader() = default;

    virtual bool read_bool() = 0;
    virtual int read_int(const Range& range) = 0;
    virtual std::uint64_t read_uint64(const Range& range) = 0;
    virtual double read_double(const Range& range) = 0;
    virtual std::string read_text() = 0;
    /// The path of a file. A relative path is completed by the folder that it starts from.
    virtual std::filesystem::path read_path() = 0;

    /// An array of numbers, as many as `target` has.
    virtual void read_numbers(std::span<double> target, const Ranges& ranges) = 0;
    virtual void read_numbers(std::span<int> target, const Ranges& ranges) = 0;

    /// The index in `words` of the value.
    virtual std::size_t read_choice(std::span<const std::string_view> words) = 0;

    /// Reads a table into the targets of its keys, and applies their rules. A key that is not in the list is an error.
    virtual void read_table(const Keys& keys) = 0;
    /// Reads an array of tables: calls `read_one` with a reader of each, in order.
    virtual void read_tables(const std::function<void(KeyReader&)>& read_one) = 0;
    /// Reads one key of a table: the index in `words` of its key `name`, which must be there. The other keys are not
    /// read, because this one decides which of them the table may have.
    virtual std::size_t read_kind(std::string_view name, std::string_view meaning,
                                  std::span<const std::string_view> words) = 0;
};

}  // namespace eikonal
