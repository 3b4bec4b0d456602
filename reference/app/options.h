/// The command line of eikonal-trace. It is declared, parsed and checked here alone.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "reference/compare/comparison.h"
#include "reference/trace/render.h"

namespace eikonal::reference {

/// Options that every command has.
struct CommonOptions {
    std::filesystem::path scene;
    std::vector<std::string> settings;  ///< values of --set
    std::optional<std::uint64_t> seed;
    int threads = 0;  ///< 0: all processors
};

struct RenderOptions {
    CommonOptions common;
    std::filesystem::path output;
    RenderSettings render;
    std::string frames;  ///< empty: the scene's first frame
    bool compact = false, overwrite = false, verbose = false, explain = false;
};

struct PathOptions {
    CommonOptions common;
    std::optional<std::filesystem::path> output;  ///< nothing: standard output
    dvec3 origin{0}, direction{0, 0, -1};
    double length = 0;  ///< length of the path in u [m]
    RaySettings rays;
    double tolerance = 1e-9;  ///< [m]
    std::optional<int> frame;
};

struct CompareOptions {
    CommonOptions common;
    std::filesystem::path output;  ///< a folder
    CompareSettings compare;
    std::string frames;  ///< empty: the scene's first frame
    bool overwrite = false;
};

/// A text that is all a program prints: help or the version.
struct Information {
    std::string text;
};

using Command = std::variant<RenderOptions, PathOptions, CompareOptions, Information>;

/// UserError: one line that names the option, the value and what is allowed.
Command parse_options(int argc, const char* const* argv);

}  // namespace eikonal::reference
