/// The reason why a file operation failed, as one line.
#pragma once

#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>

namespace eikonal {

/// A library's message without line breaks. `fallback` if the message is empty.
inline std::string one_line(std::string_view message, std::string_view fallback) {
    std::string line;
    for (const char c : message) {
        const bool blank = c == '\n' || c == '\r' || c == '\t' || c == ' ';
        if (!blank)
            line += c;
        else if (!line.empty() && line.back() != ' ')
            line += ' ';
    }
    if (!line.empty() && line.back() == ' ') line.pop_back();
    return line.empty() ? std::string(fallback) : line;
}

/// The text of errno.
inline std::string last_system_error() {
    return std::strerror(errno);
}

}  // namespace eikonal
