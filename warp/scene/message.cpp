#include "warp/scene/message.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace eikonal::scene_file {

namespace {

/// Number of insertions, deletions, replacements and swaps of neighbours that turn a into b.
int edit_distance(std::string_view a, std::string_view b) {
    std::vector<int> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    std::iota(last.begin(), last.end(), 0);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = static_cast<int>(i);
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
        std::swap(before, last);
        std::swap(last, row);
    }
    return last[b.size()];
}

}  // namespace

std::string printable(std::string_view text) {
    std::string line(text);
    std::replace_if(
        line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
    return line;
}

std::string shortened(std::string_view text) {
    if (text.size() <= kLongestShown) return std::string(text);
    std::size_t end = kLongestShown;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
    return std::string(text.substr(0, end)) + "…";
}

std::string_view nearest(std::string_view name, std::span<const std::string_view> valid) {
    std::string_view best;
    if (name.size() > kLongestShown) return best;
    int fewest = 0;
    for (const std::string_view v : valid) {
        const int edits = edit_distance(name, v);
        const int similar = std::max(1, static_cast<int>(std::max(name.size(), v.size())) / 3);
        if (edits <= similar && (best.empty() || edits < fewest)) {
            best = v;
            fewest = edits;
        }
    }
    return best;
}

std::string did_you_mean(std::string_view name, std::span<const std::string_view> valid) {
    const std::string_view close = nearest(name, valid);
    return close.empty() ? "" : fmt::format("; did you mean '{}'?", close);
}

std::string suggestion(std::string_view name, std::span<const std::string_view> valid) {
    if (std::string text = did_you_mean(name, valid); !text.empty()) return text;
    return fmt::format("; valid: {}", fmt::join(valid, ", "));
}

}  // namespace eikonal::scene_file
