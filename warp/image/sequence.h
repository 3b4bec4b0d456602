/// Frame numbers and frame file names.
///
/// A pattern is a file name with one frame number in it: a run of `#` and `@` (one digit for each, but a single `#` by
/// itself is four, as in `plate.#.exr`), or `%04d`, `%d`. If a name has several, the last counts; folders are never
/// patterns. Frame numbers are padded with zeros to at least that many digits, longer ones are written in full,
/// negative ones as -0012.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace eikonal {

/// Most frames that a range may name.
inline constexpr std::size_t kMostFrames = 10'000'000;

/// Frames of "1001-1100", "1-9x2" or "1-9:2" (step), "10-1" (backwards), comma lists, negatives ("-5--1", "-3-4"), in
/// the order given, repeats dropped. UserError naming the text: empty, not such a list, step below 1, numbers beyond an
/// int's, more than kMostFrames.
std::vector<int> parse_frames(std::string_view text);

/// The names of a sequence's files, or the name of a single one.
class FilePattern {
  public:
    /// Any path; one without a pattern stands for a single file.
    static FilePattern parse(const std::filesystem::path& path);

    bool is_sequence() const { return digits_.has_value(); }
    /// The path as given.
    const std::filesystem::path& text() const { return text_; }
    /// The file of a frame; of a single file always the same.
    std::filesystem::path at(int frame) const;
    /// Frames whose files exist, ascending. Empty for a single file. FrameError if the folder cannot be read.
    std::vector<int> find_frames() const;

  private:
    /// The frame that `name` is the file of, exactly as at() would write it.
    std::optional<int> frame_of(std::string_view name) const;

    std::filesystem::path text_;
    std::string before_, after_;  ///< of the file name, around the number
    std::optional<int> digits_;
};

/// A number of 4 to 7 digits right before the extension.
struct NumberInName {
    int number = 0;
    bool after_dot = false;  ///< plate.1002.exr, as sequences are named; else plate_1002.exr, as photographs are, too
};

/// The number in the name of a single file that may be one of a sequence. Nothing: no such number, or nothing before
/// it, or neither a dot nor an underscore.
std::optional<NumberInName> number_in_name(const std::filesystem::path& path);

/// Whether the extension is a movie's (.mp4 .mov .mkv …; case does not matter).
bool is_movie(const std::filesystem::path& path);

}  // namespace eikonal
