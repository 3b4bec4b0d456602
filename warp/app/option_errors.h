/// Errors of the command line as one line each, with the nearest valid name.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace eikonal {

/// "; did you mean 'x'?" for a word that is none of `valid`, or `otherwise` if none is near.
std::string suggestion(std::string_view word, const std::vector<std::string>& valid, const std::string& otherwise = "");

/// Throws the UserError for what CLI11 found wrong with `words`: one line, with the nearest valid name for a misspelt
/// option or command.
[[noreturn]] void rephrase(const CLI::ParseError& error, const CLI::App& app, const std::vector<std::string>& words);

}  // namespace eikonal
