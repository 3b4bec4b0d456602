/// The options of `eikonal` as typed by the user: one struct a command. parse_options fills it without looking at any
/// file. Defaults are those of an omitted option.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "warp/resample/resample.h"
#include "warp/shimmer/settings.h"

namespace eikonal {

enum class ProgressStyle { Auto, Bar, Plain, None };

/// The scene, and the changes to it.
struct SceneOptions {
    std::optional<std::filesystem::path> scene;
    std::optional<std::string> preset;
    std::vector<std::string> settings;
    std::optional<std::uint64_t> seed;
    std::optional<double> fov;
};

/// The options of a shot, which determine the displacement.
struct ShotOptions {
    SceneOptions scene;
    DepthSettings depth;
    StrengthSettings strength;
    std::optional<std::string> mask;  ///< FILE[:CHANNEL] of a matte
};

/// The options of a run, which do not change the result.
struct RunOptions {
    std::optional<std::string> frames;
    int threads = 0;  ///< 0: all processors
    bool overwrite = false;
    bool skip_bad_frames = false;
    bool verbose = false;
    bool explain = false;
    ProgressStyle progress = ProgressStyle::Auto;
    std::optional<std::filesystem::path> report;

    /// Whether the errors of the maps are reported anywhere.
    bool states_errors() const { return verbose || report || explain; }
};

struct WarpOptions {
    std::filesystem::path input, output;
    ShotOptions shot;
    RunOptions run;
    std::optional<std::filesystem::path> stmap, displacement;
    Filter filter = Filter::Cubic;
    Edge edge = Edge::Mirror;
    double shutter = 0;
    int samples = 1;
    double dispersion = 0;
    std::string codec;
    std::optional<double> quality;
};

struct MapOptions {
    std::filesystem::path output;
    ShotOptions shot;
    RunOptions run;
    std::optional<std::filesystem::path> stmap;
};

struct FieldOptions {
    std::filesystem::path output;
    SceneOptions scene;
    std::optional<double> frame;  ///< if left out, the scene's first
    int medium = 0;
    RunOptions run;
};

struct PresetsOptions {};

/// The text to print, with exit status 0, if the user asked for help or the version.
struct Information {
    std::string text;
};

using Command = std::variant<WarpOptions, MapOptions, FieldOptions, PresetsOptions, Information>;

/// The finite number that `text` consists of; nothing if it is anything else.
std::optional<double> parse_number(std::string_view text);

/// Parses the command line. UserError: an unknown option (with the nearest valid one), an ill-formed value, a
/// contradiction.
Command parse_options(int argc, const char* const* argv);

}  // namespace eikonal
