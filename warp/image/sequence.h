/// Frame numbers and frame file names.
///
/// A pattern is a file name with a place for one frame number: a run of `#` and `@`, `%04d`, or `%d`. Each `#` or `@`
/// is one digit, but a single `#` by itself is four, as in `plate.#.exr`. If a name has several places, the last one
/// counts. Folders are never patterns. Frame numbers are padded with zeros to at least that many digits. Longer ones
/// are written in full, and negative ones as -0012.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace eikonal {

/// Most frames that a range may name.
inline constexpr std::size_t kMostFrames = 10'000'000;

/// Frames of a list with commas, in the order given, without repeats. Examples of its members: "1001-1100", "1-9x2" and
/// "1-9:2" (with a step), "10-1" (backwards), "-5--1" and "-3-4" (negative numbers). UserError with the text: it is
/// empty or no such list, a step is below 1, a number does not fit into an int, or there are more than kMostFrames.
std::vector<int> parse_frames(std::string_view text);

/// The names of a sequence's files, or the name of a single one.
class FilePattern {
  public:
    /// Takes any path. A path without a pattern stands for a single file.
    static FilePattern parse(const std::filesystem::path& path);

    bool is_sequence() const { return digits_.has_value(); }
    /// The path as given.
    const std::filesystem::path& text() const { return text_; }
    /// The file of a frame. A single file is the file of every frame.
    std::filesystem::path at(int frame) const;
    /// Frames whose files exist, in ascending order. Empty for a single file. FrameError if the folder cannot be read.
    std::vector<int> find_frames() const;

  private:
    /// The frame whose file at() would name exactly `name`.
    std::optional<int> frame_of(std::string_view name) const;

    std::filesystem::path text_;
    std::string before_, after_;  ///< the file name before and after the number
    std::optional<int> digits_;
};

/// A number of 4 to 7 digits right before the extension.
struct NumberInName {
    int number = 0;
    bool after_dot = false;  ///< plate.1002.exr, as sequences have it. Else plate_1002.exr, as photographs have it too.
};

/// The number in the name of a single file, if the file may be part of a sequence. A dot or an underscore must stand
/// before the number, and a name before that.
std::optional<NumberInName> number_in_name(const std::filesystem::path& path);

/// Whether the extension is that of a movie (.mp4 .mov .mkv …). Case does not matter.
bool is_movie(const std::filesystem::path& path);

}  // namespace eikonal
