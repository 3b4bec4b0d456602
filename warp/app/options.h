/// What the user asks of `eikonal`, as typed: one struct a command, filled by parse_options and not yet checked against
/// any file. Defaults are those of an omitted option.
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

/// Which scene, and what is changed in it.
struct SceneOptions {
    std::optional<std::filesystem::path> scene;
    std::optional<std::string> preset;
    std::vector<std::string> settings;
    std::optional<std::uint64_t> seed;
    std::optional<double> fov;
};

/// The shot: what the displacement is made of.
struct ShotOptions {
    SceneOptions scene;
    DepthSettings depth;
    StrengthSettings strength;
    std::optional<std::string> mask;  ///< FILE[:CHANNEL]
};

/// How the work is done.
struct RunOptions {
    std::optional<std::string> frames;
    int threads = 0;  ///< 0: all processors
    bool overwrite = false;
    bool skip_bad_frames = false;
    bool verbose = false;
    bool explain = false;
    ProgressStyle progress = ProgressStyle::Auto;
    std::optional<std::filesystem::path> report;

    /// Whether anyone will read how far the maps are off.
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
    std::optional<double> frame;  ///< left out: the scene's first
    int medium = 0;
    RunOptions run;
};

struct PresetsOptions {};

/// help or version was asked for: print `text` and exit 0.
struct Information {
    std::string text;
};

using Command = std::variant<WarpOptions, MapOptions, FieldOptions, PresetsOptions, Information>;

/// The finite number that is all of `text`.
std::optional<double> parse_number(std::string_view text);

/// Throws UserError: unknown options (with the nearest valid one), ill-formed values, contradictions.
Command parse_options(int argc, const char* const* argv);

}  // namespace eikonal
