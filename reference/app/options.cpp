#include "reference/app/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "noise/base/error.h"
#include "reference/trace/frame_file.h"
#include "warp/scene/message.h"

namespace eikonal::reference {
namespace {

std::vector<std::string_view> integrator_names() {
    std::vector<std::string_view> names;
    for (const auto& [name, value] : kIntegratorNames) names.push_back(name);
    return names;
}

/// A range that also rejects NaN, which CLI::Range accepts.
CLI::Validator within(double low, double high) {
    const auto check = [=](std::string& text) -> std::string {
        double value = 0;
        if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return "";
        return fmt::format("{} is not a number from {:g} to {:g}", text, low, high);
    };
    return {check, fmt::format("{:g} to {:g}", low, high)};
}

void add_common(CLI::App& command, CommonOptions& o) {
    command.add_option("SCENE", o.scene, "scene file (.toml)")->required()->type_name("");
    command
        .add_option("--set", o.settings,
                    "KEY=VALUE: override a key of the scene, e.g. camera.resolution=[640,360]; repeatable")
        ->allow_extra_args(false)
        ->type_name("KEY=VALUE");
    command.add_option("--seed", o.seed, "seed of the whole scene")->type_name("N");
    command.add_option("--threads", o.threads, "threads (default: all; the result does not depend on it)")
        ->check(CLI::Range(1, 4096))
        ->type_name("N");
}

void add_integrator(CLI::App& command, RaySettings& rays) {
    Integrator& integrator = rays.integrator;
    command
        .add_option_function<std::string>(
            "--integrator",
            [&integrator](const std::string& text) {
                for (const auto& [name, value] : kIntegratorNames)
                    if (name == text) {
                        integrator = value;
                        return;
                    }
                const std::vector<std::string_view> names = integrator_names();
                throw UserError(fmt::format("--integrator: '{}' is none of {}{}", text, fmt::join(names, "|"),
                                            scene_file::did_you_mean(text, names)));
            },
            "how rays are followed (default: adaptive)")
        ->type_name(fmt::format("{}", fmt::join(integrator_names(), "|")));
    command
        .add_option("--step", rays.step,
                    "longest step of the fixed-step integrators, thickness of a slice of layers [m] (default: as the "
                    "media need)")
        ->check(within(1e-9, 1e9))
        ->type_name("M");
    command
        .add_option("--step-budget", rays.step_budget,
                    fmt::format("steps after which a ray ends (default: {})", kStepBudget))
        ->check(CLI::Range(10, 1000000000))
        ->type_name("N");
}

/// Adds the options for the accuracy of a picture.
void add_quality(CLI::App& command, RaySettings& rays, int& samples) {
    add_integrator(command, rays);
    command.add_option("--tolerance", rays.tolerance_px, "largest error of the displacement [px]")
        ->check(within(1e-9, 1e3))
        ->capture_default_str()
        ->type_name("PX");
    command.add_option("--samples", samples, "samples a pixel for the colour; powers of two spread best")
        ->check(CLI::Range(1, 1 << 20))
        ->capture_default_str()
        ->type_name("N");
}

void add_frames(CLI::App& command, std::string& frames) {
    command.add_option("--frames", frames, "frames, e.g. 1-24, 1-9x2, 3,7 (default: the scene's first)")
        ->type_name("LIST");
}

/// A vector from the text X,Y,Z.
dvec3 vector_of(const std::string& option, const std::string& text) {
    std::vector<std::string> parts = CLI::detail::split(text, ',');
    dvec3 v{0};
    bool good = parts.size() == 3;
    for (int i = 0; good && i < 3; ++i) {
        good = CLI::detail::lexical_cast(parts[static_cast<std::size_t>(i)], v[i]) && std::abs(v[i]) <= kLargestValue;
    }
    if (!good)
        throw UserError(fmt::format("{}: '{}' must be X,Y,Z, three numbers of at most {:g} in magnitude", option, text,
                                    kLargestValue));
    return v;
}

void add_render(CLI::App& command, RenderOptions& o) {
    add_common(command, o.common);
    command.add_option("-o,--output", o.output, "output .exr; plate.####.exr for a sequence")
        ->required()
        ->type_name("FILE");
    command.add_flag("--straight", o.render.straight,
                     "straight rays: the undistorted plate and the depth that eikonal warp takes");
    add_quality(command, o.render.rays, o.render.samples);
    command.add_flag(
        "--magnification", o.render.magnification,
        "channel magnification, from the spread of each pixel's bundle of rays, and the count of folded pixels");
    command
        .add_option("--light-rays", o.render.light_rays,
                    "follow N x N sun rays through the air onto every quad: caustics and shadows of hot air")
        ->check(CLI::Range(2 * kRaysPerTexel, kMostLightRays))
        ->type_name("N");
    add_frames(command, o.frames);
    command.add_flag(
        "--explain", o.explain,
        "write nothing, but say what the frames need and will be: media, steps, displacement, error, time, "
        "memory");
    command.add_flag("--compact", o.compact,
                     fmt::format("small files: colour slightly lossy (DWAA), Z to {:.0e}", kCompactDepthError));
    command.add_flag("--overwrite", o.overwrite, "render frames again whose files exist");
    command.add_flag("-v,--verbose", o.verbose, "say how many steps and how much time frames took");
}

void add_path(CLI::App& command, PathOptions& o) {
    add_common(command, o.common);
    command
        .add_option_function<std::string>(
            "--origin", [&o](const std::string& text) { o.origin = vector_of("--origin", text); },
            "where the ray starts [m]")
        ->required()
        ->type_name("X,Y,Z");
    command
        .add_option_function<std::string>(
            "--direction", [&o](const std::string& text) { o.direction = vector_of("--direction", text); },
            "where it goes, of any length")
        ->required()
        ->type_name("X,Y,Z");
    command.add_option("--length", o.length, "of the ray, in the parameter u of dx/du = p, |p| = n [m]")
        ->required()
        ->check(within(0.0, kLargestValue))
        ->type_name("U");
    command.add_option("-o,--output", o.output, "CSV file (default: standard output)")->type_name("FILE.csv");
    add_integrator(command, o.rays);
    command.add_option("--tolerance", o.tolerance, "largest error of the position at the end [m]")
        ->check(within(1e-13, 1e3))
        ->capture_default_str()
        ->type_name("M");
    command.add_option("--frame", o.frame, "frame (default: the scene's first)")->type_name("F");
}

void add_compare(CLI::App& command, CompareOptions& o) {
    add_common(command, o.common);
    command.add_option("-o,--output", o.output, "folder for tables, pictures, plot and index.html; made if need be")
        ->required()
        ->type_name("FOLDER");
    command
        .add_option("--models", o.compare.models,
                    "only these models, e.g. screens,first-order, or default (default: all that suit the scene)")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("LIST");
    add_quality(command, o.compare.rays, o.compare.samples);
    add_frames(command, o.frames);
    command.add_flag("--overwrite", o.overwrite, "compare again although the folder holds an index.html");
}

void check(RenderOptions& o) {
    if (o.output.extension() != ".exr")
        throw UserError(fmt::format(
            "--output {}: colour and depth are written as OpenEXR only; use a name ending in .exr", o.output.string()));
    if (o.render.straight && (o.render.magnification || o.render.light_rays > 0))
        throw UserError(
            "--straight: straight rays have no magnification and no light that is bent; leave out --magnification and "
            "--light-rays");
    if (o.render.magnification && !follows_bundles(o.render.rays.integrator))
        throw UserError(fmt::format(
            "--magnification: integrator {} follows no bundle of rays; use adaptive, rk4, leapfrog or euler",
            name_of(o.render.rays.integrator)));
}

void check(PathOptions& o) {
    const double length = glm::length(o.direction);
    if (!(length > 1e-150)) throw UserError("--direction: must not be a zero vector");
    o.direction /= length;
}

}  // namespace

Command parse_options(int argc, const char* const* argv) {
    CLI::App app{
        "Traces the scenes that eikonal distorts along true bent rays: the ground truth for its warp.\n\n"
        "  eikonal-trace render scene.toml -o truth.exr\n"
        "  eikonal-trace render scene.toml -o plate.####.exr --frames 1-24 --straight\n"
        "  eikonal-trace path scene.toml --origin 0,1.5,0 --direction 0,-0.01,-1 --length 200 -o ray.csv\n"
        "  eikonal-trace compare scene.toml -o comparison",
        "eikonal-trace"};
    app.require_subcommand(1);
    app.set_version_flag("--version", "eikonal-trace " EIKONAL_VERSION);
    app.footer(
        "Exit status: 0 all frames written, 1 some frame failed, 2 wrong usage.\n`eikonal-trace COMMAND --help` tells "
        "more.");
    RenderOptions render;
    PathOptions path;
    CompareOptions compare;
    CLI::App* render_command =
        app.add_subcommand("render", "render a scene with bent rays: colour, depth, displacement");
    add_render(*render_command, render);
    CLI::App* path_command = app.add_subcommand("path", "write one ray: columns u,x,y,z,px,py,pz");
    add_path(*path_command, path);
    CLI::App* compare_command =
        app.add_subcommand("compare", "every model of the warp against bent rays: errors, time, pictures, a page");
    add_compare(*compare_command, compare);
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        return Information{app.help()};
    } catch (const CLI::CallForAllHelp&) {
        return Information{app.help("", CLI::AppFormatMode::All)};
    } catch (const CLI::CallForVersion&) {
        return Information{"eikonal-trace " EIKONAL_VERSION "\n"};
    } catch (const CLI::ParseError& error) {
        std::string text = error.what();
        std::replace(text.begin(), text.end(), '\n', ' ');
        throw UserError(text + "; see --help");
    }
    if (app.got_subcommand(render_command)) {
        check(render);
        return render;
    }
    if (app.got_subcommand(compare_command)) return compare;
    check(path);
    return path;
}

}  // namespace eikonal::reference
