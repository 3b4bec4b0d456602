/// The format of --help: usage, then groups of options, with descriptions wrapped to kHelpWidth columns.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace eikonal {

inline constexpr std::size_t kHelpWidth = 100;

class HelpFormat : public CLI::Formatter {
  public:
    std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
};

}  // namespace eikonal
