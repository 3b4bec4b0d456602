/// `eikonal-trace compare`: compares the warp with the tracer on frames of a scene.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "noise/base/error.h"
#include "reference/app/commands.h"
#include "reference/app/tile_progress.h"
#include "reference/compare/comparison_report.h"
#include "reference/compare/comparison_table.h"
#include "warp/image/sequence.h"
#include "warp/program/option_names.h"

namespace eikonal::reference {
namespace {

void make_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error || !std::filesystem::is_directory(folder, error))
        throw UserError(fmt::format("--output {}: this folder cannot be made{}{}", folder.string(), error ? ": " : "",
                                    error ? error.message() : ""));
}

/// The name of the scene at the head of a folder's table.
std::string compared_scene(const std::filesystem::path& folder) {
    std::ifstream table(folder / "errors.txt");
    std::string name;
    std::getline(table, name);
    return name.empty() ? "something else" : name;
}

/// The comparison, with settings spelled as options in the reasons why models do not apply.
Comparison in_words_of_the_program(Comparison comparison) {
    for (ModelResult& model : comparison.models) model.refusal = with_options(model.refusal);
    return comparison;
}

}  // namespace

int run(const CompareOptions& o, const std::stop_token& stop) {
    const Scene scene = read_scene(o.common.scene, o.common.settings, o.common.seed);
    std::vector<int> frames = o.frames.empty() ? std::vector{scene.time.first_frame} : parse_frames(o.frames);
    std::sort(frames.begin(), frames.end());  // in order of time, however the user lists them
    const std::filesystem::path page = o.output / "index.html";
    CompareSettings settings = o.compare;
    settings.stop = stop;
    Comparer comparer(scene, settings);
    std::error_code ignored;
    if (!o.overwrite && std::filesystem::exists(page, ignored)) {
        const std::string there = compared_scene(o.output), name = scene.file.filename().string();
        if (there != name)
            throw UserError(
                fmt::format("--output {}: holds the comparison of {}, not of {}; --overwrite replaces it, or name "
                            "another folder",
                            o.output.string(), there, name));
        fmt::print(stderr, "kept {} (--overwrite compares again)\n", page.string());
        return 0;
    }
    make_folder(o.output);
    std::vector<PageFrame> pages;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const int frame = frames[i];
        try {
            TileProgress progress(fmt::format("frame {}", frame), comparer.tile_count());
            const Comparer::Frame& compared = comparer.add(frame, [&] { progress.tile_done(); });
            std::vector<PagePicture> written =
                write_pictures(o.output, in_words_of_the_program(comparer.result()), compared);
            if (on_page(i, frames.size())) pages.push_back({frame, std::move(written)});
        } catch (const FrameError& error) {
            throw FrameError(fmt::format("frame {}: {}", frame, error.what()));
        }
    }
    const Comparison result = in_words_of_the_program(comparer.result());
    write_report(o.output, result, pages);
    fmt::print("{}\nwrote {}\n", table_text(result), page.string());
    return 0;
}

}  // namespace eikonal::reference
