#include "warp/app/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <limits>

#include "noise/base/error.h"
#include "warp/app/help_format.h"
#include "warp/app/option_errors.h"
#include "warp/scene/background.h"

namespace eikonal {
namespace {

constexpr const char* kVersion = "eikonal " EIKONAL_VERSION;

constexpr const char* kAbout =
    "Adds physically computed heat shimmer to images, image sequences and movies.\n\n"
    "  eikonal warp plate.jpg -o out.png --preset hot-road\n"
    "  eikonal warp plate.####.exr -o out.####.exr --scene air.toml --depth depth.####.exr:Z\n"
    "  eikonal warp still.png -o shimmer.mp4 --frames 1-96 --preset gentle --rms 1.5";

constexpr const char* kAboutWarp =
    "distort an image, a sequence or a movie\n\n"
    "  eikonal warp plate.jpg -o out.png --preset hot-road --rms 2\n"
    "  eikonal warp plate.####.exr -o out.####.exr --frames 1001-1100 --depth depth.####.exr:Z\n"
    "  eikonal warp drive.mov -o shimmer.mov --preset hot-road --ground 1.5,55%";

constexpr const char* kAboutMap =
    "write displacement maps without any footage\n\n"
    "  eikonal map --scene air.toml -o map.####.exr --frames 1-100 --stmap st.####.exr";

constexpr const char* kAboutField =
    "write slices of the refractive field, for analysis\n\n"
    "  eikonal field --scene air.toml -o slice.####.exr --frame 12";

constexpr const char* kFiles =
    "Files: one image, a sequence (#### four digits, @ one, %04d) or a movie.\n"
    "Exit status: 0 all frames written, 1 some frame failed, 2 wrong usage.";
constexpr const char* kMore = "`eikonal COMMAND --help` tells more.";

template <class T>
using Names = std::vector<std::pair<std::string, T>>;

Names<ModelRequest> model_requests() {
    Names<ModelRequest> names;
    for (const auto& [name, model] : kModelNames) names.emplace_back(name, ModelRequest{false, model});
    names.emplace_back("auto", ModelRequest{true, {}});
    return names;
}

const Names<ModelRequest> kModels = model_requests();
const Names<Filter> kFilters{
    {"bilinear", Filter::Bilinear}, {"cubic", Filter::Cubic}, {"lanczos3", Filter::Lanczos3}, {"area", Filter::Area}};
const Names<Edge> kEdges{
    {"mirror", Edge::Mirror}, {"clamp", Edge::Clamp}, {"wrap", Edge::Wrap}, {"black", Edge::Black}};
const Names<DepthType> kDepthTypes{{"z", DepthType::Z}, {"ray", DepthType::Ray}, {"inverse", DepthType::Inverse}};
const Names<DepthMeeting> kMeetings{
    {"march", DepthMeeting::March}, {"fixed-point", DepthMeeting::FixedPoint}, {"own", DepthMeeting::Own}};
const Names<ProgressStyle> kProgress{{"auto", ProgressStyle::Auto},
                                     {"bar", ProgressStyle::Bar},
                                     {"plain", ProgressStyle::Plain},
                                     {"none", ProgressStyle::None}};

template <class T>
std::string joined(const Names<T>& names) {
    std::string text;
    for (const auto& [name, value] : names) text += (text.empty() ? "" : "|") + name;
    return text;
}

/// Adds an option whose value is one of a list of names.
template <class Target, class T>
void add_choice(CLI::App& app, const std::string& flag, Target& target, const Names<T>& names,
                const std::string& help) {
    app.add_option_function<std::string>(
           flag,
           [flag, &target, &names](const std::string& text) {
               std::vector<std::string> valid;
               for (const auto& [name, value] : names) {
                   if (name == text) {
                       target = value;
                       return;
                   }
                   valid.push_back(name);
               }
               throw UserError(
                   fmt::format("{}: '{}' is none of {}{}", flag, text, joined(names), suggestion(text, valid)));
           },
           help)
        ->type_name(joined(names));
}

double number(const std::string& option, std::string_view text) {
    const std::optional<double> value = parse_number(text);
    if (!value) throw UserError(fmt::format("{}: '{}' is not a number", option, text));
    return *value;
}

/// Adds an option whose value is a number in a range. `allowed` is the range in words.
template <class Target>
void add_number(CLI::App& app, const std::string& flag, Target& target, const std::string& type,
                const std::string& help, const std::string& allowed, bool (*valid)(double)) {
    app.add_option_function<std::string>(
           flag,
           [flag, &target, allowed, valid](const std::string& text) {
               const double value = number(flag, text);
               if (!valid(value)) throw UserError(fmt::format("{}: {} must be {}", flag, text, allowed));
               target = static_cast<std::remove_reference_t<decltype(target)>>(value);
           },
           help)
        ->type_name(type);
}

bool positive(double v) {
    return v > 0;
}
bool is_length(double v) {
    return v >= kSmallestPositive && v <= kLargestValue;
}
bool not_negative(double v) {
    return v >= 0;
}
bool small_count(double v) {
    return v >= 1 && v <= 1024 && v == std::floor(v);
}

std::array<double, 2> pair_of(const std::string& option, const std::string& text) {
    const auto comma = text.find(',');
    if (comma == std::string::npos)
        throw UserError(fmt::format("{}: '{}' must be two numbers, NEAR,FAR", option, text));
    return {number(option, std::string_view(text).substr(0, comma)),
            number(option, std::string_view(text).substr(comma + 1))};
}

/// Begins the heading under which help lists the options that follow.
void begin_group(CLI::App& app, const std::string& name) {
    app.option_defaults()->group(name);
}

void add_scene(CLI::App& app, SceneOptions& o) {
    begin_group(app, "Scene");
    auto* scene =
        app.add_option("--scene", o.scene, "scene file (TOML): media, camera, time, optics")->type_name("FILE");
    auto* preset =
        app.add_option("--preset", o.preset, "a scene that comes with eikonal (default: gentle)")->type_name("NAME");
    scene->excludes(preset);
    app.add_option("--set", o.settings, "change a key of the scene, e.g. medium.0.cn2=1e-13 (repeatable)")
        ->type_name("KEY=VALUE")
        ->expected(1)
        ->take_all();
    app.add_option_function<std::string>(
           "--seed",
           [&o](const std::string& text) {
               std::uint64_t seed = 0;
               const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
               if (error != std::errc() || end != text.data() + text.size())
                   throw UserError(fmt::format("--seed: '{}' must be a whole number from 0 to {}", text,
                                               std::numeric_limits<std::uint64_t>::max()));
               o.seed = seed;
           },
           "another turbulence of the same kind")
        ->type_name("N");
    add_number(app, "--fov", o.fov, "DEG", "horizontal field of view, instead of the scene's",
               fmt::format("from {:g} to {:g} degrees", kSmallestFov, kLargestFov),
               [](double v) { return v >= kSmallestFov && v <= kLargestFov; });
}

const std::string kLengths = fmt::format("from {:g} to {:g} m", kSmallestPositive, kLargestValue);

double part_of_ground(const std::string& all, std::string_view text) {
    const std::optional<double> value = parse_number(text);
    if (!value)
        throw UserError(fmt::format(
            "--ground: '{}' must be HEIGHT,HORIZON: metres above the ground, and the horizon's row from the top in "
            "pixels or as a part of the height like 55%",
            all));
    return *value;
}

GroundSettings parse_ground(const std::string& text) {
    const auto comma = text.find(',');
    if (comma == std::string::npos) part_of_ground(text, "?");
    std::string_view horizon = std::string_view(text).substr(comma + 1);
    const bool fraction = horizon.ends_with('%');
    if (fraction) horizon.remove_suffix(1);
    GroundSettings ground{part_of_ground(text, std::string_view(text).substr(0, comma)), part_of_ground(text, horizon),
                          fraction};
    if (!fraction && ground.horizon > 0 && ground.horizon < 1)
        throw UserError(fmt::format("--ground: the horizon's row {0} is within the first pixel; did you mean {1:g}%?",
                                    horizon, ground.horizon * 100));
    if (fraction) ground.horizon /= 100;
    return ground;
}

void add_depth(CLI::App& app, DepthSettings& o, bool with_input) {
    begin_group(app, "Depth");
    add_number(app, "--distance", o.distance, "M", "constant distance along the axis [m]", kLengths, is_length);
    app.add_option("--depth", o.depth,
                   std::string("depth map; 0 m, infinity and NaN are background") +
                       (with_input ? "; :CHANNEL alone names a channel of INPUT" : ""))
        ->type_name("FILE[:CHANNEL]");
    add_choice(app, "--depth-type", o.depth_type, kDepthTypes,
               "metres along the axis (default), along the ray, or 1/metres");
    app.add_option_function<std::string>(
           "--depth-range", [&o](const std::string& text) { o.depth_range = pair_of("--depth-range", text); },
           "metres that codes 0 and 1 of a map without units mean (inverse: 1 is NEAR)")
        ->type_name("NEAR,FAR");
    app.add_option_function<std::string>(
           "--ground", [&o](const std::string& text) { o.ground = parse_ground(text); },
           "flat ground: camera height [m] and the horizon's row from the top, in pixels or as 55%")
        ->type_name("HEIGHT,HORIZON");
    add_number(
        app, "--far", o.far, "M",
        fmt::format(
            "distance of the background (default: the scene's, else {:g}, or {:g} over surfaces alone); limits depth",
            kDefaultFar, kDefaultSky),
        kLengths, is_length);
    add_choice(app, "--depth-meeting", o.depth_meeting, kMeetings,
               "how a bent ray meets the depth map: followed to the first surface (default), iterated, or the pixel's "
               "own depth");
}

void add_strength(CLI::App& app, ShotOptions& shot, std::optional<std::filesystem::path>& stmap) {
    begin_group(app, "Displacement");
    StrengthSettings& o = shot.strength;
    app.add_option("--mask", shot.mask, "matte that scales the displacement, 0 … 1")->type_name("FILE[:CHANNEL]");
    add_number(app, "--rms", o.rms, "PX", "scale the displacement to this rms at --far, fixed over the shot",
               "0 or more", not_negative);
    add_number(app, "--gain", o.gain, "X", "multiply the displacement (second-order: the air's strength)", "0 or more",
               not_negative);
    add_choice(app, "--model", o.model, kModels,
               "how displacement is computed (default: what suits each medium); auto: the cheapest within --tolerance");
    add_number(app, "--tolerance", o.tolerance, "PX",
               fmt::format("error of the displacement that is allowed, 95 of 100 pixels (default {:g}); implies "
                           "--model auto unless a model is named",
                           kDefaultTolerance),
               "more than 0", positive);
    app.add_option("--stmap", stmap, "also write the map as STMap (Nuke, Blender)")->type_name("FILE");
}

void add_run(CLI::App& app, RunOptions& o) {
    begin_group(app, "Run");
    app.add_option("--frames", o.frames, "1001-1100, 1-9x2 or 1-9:2 (step), lists with commas")->type_name("RANGE");
    add_number(app, "--threads", o.threads, "N", "processors to use (default: all); the result does not depend on it",
               "a whole number from 1 to 1024", small_count);
    app.add_flag("--overwrite", o.overwrite, "make every frame anew (default: keep finished ones)");
    app.add_flag("--skip-bad-frames", o.skip_bad_frames, "go on after a frame that cannot be read or written");
    app.add_flag("--verbose,-v", o.verbose, "say what is computed and why");
    app.add_flag(
        "--explain", o.explain,
        "write nothing, but say what the frames need and will be: media, model, displacement, error, time, memory");
    add_choice(app, "--progress", o.progress, kProgress, "how progress is shown on stderr");
    app.add_option("--report", o.report, "write what was done as JSON")->type_name("FILE");
}

void add_warp(CLI::App& app, WarpOptions& o) {
    begin_group(app, "Files");
    app.add_option("INPUT", o.input, "image, sequence or movie")->required();
    app.add_option("-o,--output", o.output, "image, sequence or movie")->required()->type_name("OUTPUT");
    add_scene(app, o.shot.scene);
    add_depth(app, o.shot.depth, true);
    add_strength(app, o.shot, o.stmap);
    app.add_option("--displacement", o.displacement, "also write the map as channels u, v in pixels")
        ->type_name("FILE");
    begin_group(app, "Picture");
    add_choice(app, "--filter", o.filter, kFilters, "reconstruction (default cubic)");
    add_choice(app, "--edge", o.edge, kEdges, "what lies outside the picture (default mirror)");
    add_number(app, "--shutter", o.shutter, "FRACTION", "motion blur: part of the frame time that the shutter is open",
               "from 0 to 1", [](double v) { return v >= 0 && v <= 1; });
    add_number(app, "--samples", o.samples, "N", "instants within the shutter (default 9 with --shutter)",
               "a whole number from 1 to 1024", small_count);
    add_number(app, "--dispersion", o.dispersion, "X", "colour fringes: 0 off (default), 1 true air", "0 or more",
               not_negative);
    app.add_option("--codec", o.codec, "of a movie (default: the input's, else h264)")->type_name("NAME");
    add_number(app, "--quality", o.quality, "CRF", "of a movie, lower is better", "0 or more", not_negative);
    add_run(app, o.run);
}

void add_map(CLI::App& app, MapOptions& o) {
    begin_group(app, "Files");
    app.add_option("-o,--output", o.output, "displacement map (EXR, channels u and v in pixels)")
        ->required()
        ->type_name("OUTPUT");
    add_scene(app, o.shot.scene);
    add_depth(app, o.shot.depth, false);
    add_strength(app, o.shot, o.stmap);
    add_run(app, o.run);
}

void add_field(CLI::App& app, FieldOptions& o) {
    begin_group(app, "Files");
    app.add_option("-o,--output", o.output, "one file a z-slice (EXR, channels n, F.x, F.y, F.z); #### is the slice")
        ->required()
        ->type_name("OUTPUT");
    add_scene(app, o.scene);
    app.remove_option(app.get_option("--fov"));
    begin_group(app, "Field");
    add_number(app, "--frame", o.frame, "F", "frame whose field is written (default: the scene's first)", "a number",
               [](double) { return true; });
    app.add_option_function<std::string>(
           "--medium",
           [&o](const std::string& text) {
               const double n = number("--medium", text);
               if (n < 0 || n != std::floor(n)) throw UserError(fmt::format("--medium: {} must be 0 or more", text));
               o.medium = static_cast<int>(n);
           },
           "which medium of the scene, from 0 (default)")
        ->type_name("N");
    add_run(app, o.run);
    for (const char* name : {"--frames", "--skip-bad-frames", "--report", "--explain"})
        app.remove_option(app.get_option(name));
}

void check(const DepthSettings& o) {
    int sources = 0;
    std::string given;
    for (const auto& [name, is] :
         {std::pair{"--distance", o.distance.has_value()}, std::pair{"--depth", o.depth.has_value()},
          std::pair{"--ground", o.ground.has_value()}})
        if (is) {
            ++sources;
            given += fmt::format("{}{}", given.empty() ? "" : " and ", name);
        }
    if (sources > 1) throw UserError(given + " contradict each other; give one of them");
    if (o.depth_range && !o.depth) throw UserError("--depth-range: needs a --depth map");
    if (o.depth_type && !o.depth) throw UserError("--depth-type: needs a --depth map");
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
    return value;
}

Command parse_options(int argc, const char* const* argv) {
    CLI::App app{kAbout};
    app.name("eikonal");
    app.footer(kMore);
    app.require_subcommand(1);
    app.set_version_flag("--version", kVersion);
    app.formatter(std::make_shared<HelpFormat>());

    WarpOptions warp;
    MapOptions map;
    FieldOptions field;
    auto* warp_command = app.add_subcommand("warp", kAboutWarp);
    add_warp(*warp_command, warp);
    auto* map_command = app.add_subcommand("map", kAboutMap);
    add_map(*map_command, map);
    auto* field_command = app.add_subcommand("field", kAboutField);
    add_field(*field_command, field);
    app.add_subcommand("presets", "list the presets, a line each");
    for (CLI::App* command : {warp_command, map_command, field_command}) command->footer(kFiles);

    std::vector<std::string> words(argv + 1, argv + argc);
    try {
        std::vector<std::string> reversed(words.rbegin(), words.rend());
        app.parse(reversed);
    } catch (const CLI::CallForHelp&) {
        return Information{app.help()};
    } catch (const CLI::CallForAllHelp&) {
        return Information{app.help("", CLI::AppFormatMode::All)};
    } catch (const CLI::CallForVersion&) {
        return Information{std::string(kVersion) + "\n"};
    } catch (const CLI::ParseError& error) {
        rephrase(error, app, words);
    }
    if (app.got_subcommand("warp")) {
        check(warp.shot.depth);
        if (warp.shutter > 0 && warp_command->count("--samples") == 0)
            warp.samples = 9;  // odd, so that the middle instant is the frame's own
        if (warp.shutter == 0 && warp.samples > 1)
            throw UserError("--samples: has no meaning without --shutter; give --shutter 0.5");
        return warp;
    }
    if (app.got_subcommand("map")) {
        check(map.shot.depth);
        return map;
    }
    if (app.got_subcommand("field")) return field;
    return PresetsOptions{};
}

}  // namespace eikonal
