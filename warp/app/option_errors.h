/// Errors of the command line. Each is one line that names the nearest valid name.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace eikonal {

/// "; did you mean 'x'?" with the valid word nearest to `word`, or `otherwise` if none is near.
std::string suggestion(std::string_view word, const std::vector<std::string>& valid, const std::string& otherwise = "");

/// Throws the UserError for what CLI11 found wrong with `words`. It is one line. For a misspelt option or command it
/// names the nearest valid one.
[[noreturn]] void rephrase(const CLI::ParseError& error, const CLI::App& app, const std::vector<std::string>& words);

}  // namespace eikonal
