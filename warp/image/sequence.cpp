#include "warp/image/sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <limits>
#include <system_error>
#include <unordered_set>

#include "noise/base/error.h"

namespace eikonal {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse(std::string_view text, std::string_view reason) {
    throw UserError(fmt::format("`frames` '{}': {}; write 1001-1100, 1-9x2, 1-9:2, -5--1 or a list such as 1,5,10-20",
                                text, reason));
}

/// Takes an integer off the front of `rest`.
std::optional<int> take_integer(std::string_view& rest) {
    int value = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (error != std::errc{}) return std::nullopt;
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    return value;
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
    return text;
}

/// Takes a frame number. UserError if it does not fit into an int.
std::optional<int> take_frame(std::string_view& rest, std::string_view text) {
    const std::string_view before = rest;
    const auto frame = take_integer(rest);
    if (frame) return frame;
    const bool negative = before.starts_with('-');
    const std::size_t digits = before.find_first_not_of("0123456789", negative ? 1 : 0);
    const std::string_view number = before.substr(0, digits);
    if (number.size() > (negative ? 1u : 0u))
        refuse(text, fmt::format("{} is beyond the frame numbers, which end at ±{}", number,
                                 std::numeric_limits<int>::max()));
    return std::nullopt;
}

struct Range {
    std::int64_t first, last, step;
};

Range parse_range(std::string_view item, std::string_view text) {
    std::string_view rest = trimmed(item);
    const auto first = take_frame(rest, text);
    if (!first) refuse(text, rest.empty() ? "a frame number is missing" : "this is not a frame number or range");
    Range range{*first, *first, 1};
    if (rest.empty()) return range;
    if (rest.front() != '-') refuse(text, fmt::format("'{}' after frame {} means nothing", rest, *first));
    rest.remove_prefix(1);
    const auto last = take_frame(rest, text);
    if (!last) refuse(text, fmt::format("the range from {} has no end", *first));
    range.last = *last;
    if (rest.empty()) return range;
    if (rest.front() != 'x' && rest.front() != ':')
        refuse(text, fmt::format("'{}' after the range means nothing", rest));
    rest.remove_prefix(1);
    const auto step = take_integer(rest);
    if (!step || !rest.empty() || *step < 1) refuse(text, "the step must be a whole number of at least 1");
    range.step = *step;
    return range;
}

/// The place of the frame number in a name: a run of # and @, or %d, %04d. Where it starts and ends, and its digits.
struct Run {
    std::size_t begin, end;
    int digits;
};

std::optional<Run> last_run(std::string_view name) {
    std::optional<Run> found;
    for (std::size_t i = 0; i < name.size();) {
        if (name[i] == '#' || name[i] == '@') {
            const std::size_t end = std::min(name.find_first_not_of("#@", i), name.size());
            const bool single = end - i == 1 && name[i] == '#';
            found = Run{i, end, single ? 4 : static_cast<int>(end - i)};
            i = end;
        } else if (name[i] == '%') {
            std::size_t end = i + 1;
            int width = 0;
            while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end])) && width < 100)
                width = 10 * width + (name[end++] - '0');
            if (end < name.size() && name[end] == 'd' && (width == 0 || name[i + 1] == '0') && width < 100) {
                found = Run{i, end + 1, std::max(width, 1)};
                i = end;
            }
            ++i;
        } else {
            ++i;
        }
    }
    return found;
}

}  // namespace

std::vector<int> parse_frames(std::string_view text) {
    std::vector<int> frames;
    std::unordered_set<int> seen;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t comma = std::min(text.find(',', begin), text.size());
        const Range range = parse_range(text.substr(begin, comma - begin), text);
        const bool forward = range.last >= range.first;
        const std::int64_t count = (forward ? range.last - range.first : range.first - range.last) / range.step + 1;
        if (static_cast<std::uint64_t>(count) + frames.size() > kMostFrames)
            refuse(text, fmt::format("more than {} frames", kMostFrames));
        for (std::int64_t i = 0; i < count; ++i) {
            const auto frame = static_cast<int>(range.first + (forward ? i : -i) * range.step);
            if (seen.insert(frame).second) frames.push_back(frame);
        }
        begin = comma + 1;
    }
    return frames;
}

FilePattern FilePattern::parse(const fs::path& path) {
    FilePattern pattern;
    pattern.text_ = path;
    const std::string name = path.filename().string();
    if (const auto run = last_run(name)) {
        pattern.before_ = name.substr(0, run->begin);
        pattern.after_ = name.substr(run->end);
        pattern.digits_ = run->digits;
    }
    return pattern;
}

fs::path FilePattern::at(int frame) const {
    if (!is_sequence()) return text_;
    const std::int64_t magnitude = frame < 0 ? -static_cast<std::int64_t>(frame) : frame;
    return text_.parent_path() /
           fmt::format("{}{}{:0{}}{}", before_, frame < 0 ? "-" : "", magnitude, *digits_, after_);
}

std::optional<int> FilePattern::frame_of(std::string_view name) const {
    if (name.size() <= before_.size() + after_.size() || name.substr(0, before_.size()) != before_ ||
        name.substr(name.size() - after_.size()) != after_)
        return std::nullopt;
    const std::string_view number = name.substr(before_.size(), name.size() - before_.size() - after_.size());
    std::string_view rest = number;
    const auto frame = take_integer(rest);
    if (!frame || !rest.empty() || at(*frame).filename().string() != name) return std::nullopt;
    return frame;
}

std::optional<NumberInName> number_in_name(const fs::path& path) {
    constexpr std::size_t kFewest = 4, kMost = 7;  // digits
    const std::string stem = path.stem().string();
    const std::size_t before = stem.find_last_not_of("0123456789");
    if (before == std::string::npos || before == 0 || (stem[before] != '.' && stem[before] != '_')) return std::nullopt;
    std::string_view digits = std::string_view(stem).substr(before + 1);
    if (digits.size() < kFewest || digits.size() > kMost) return std::nullopt;
    return NumberInName{*take_integer(digits), stem[before] == '.'};
}

std::vector<int> FilePattern::find_frames() const {
    std::vector<int> frames;
    if (!is_sequence()) return frames;
    const fs::path folder = text_.has_parent_path() ? text_.parent_path() : fs::path(".");
    std::error_code error;
    fs::directory_iterator entry(folder, error);
    for (const fs::directory_iterator end; !error && entry != end; entry.increment(error))
        if (const auto frame = frame_of(entry->path().filename().string())) frames.push_back(*frame);
    if (error)
        throw FrameError(
            fmt::format("cannot look for '{}': folder '{}': {}", text_.string(), folder.string(), error.message()));
    std::sort(frames.begin(), frames.end());
    return frames;
}

bool is_movie(const fs::path& path) {
    static constexpr std::array kExtensions = {".mp4", ".m4v",  ".mov", ".qt",  ".mkv", ".webm", ".avi", ".mxf",
                                               ".mpg", ".mpeg", ".m2v", ".ts",  ".mts", ".m2ts", ".wmv", ".flv",
                                               ".ogv", ".3gp",  ".nut", ".y4m", ".vob", ".dv"};
    std::string extension = path.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

}  // namespace eikonal
