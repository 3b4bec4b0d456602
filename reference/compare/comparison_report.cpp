#include "reference/compare/comparison_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "noise/base/error.h"
#include "reference/compare/comparison_table.h"
#include "reference/compare/frontier.h"
#include "reference/compare/heat_map.h"
#include "warp/image/atomic_file.h"
#include "warp/image/picture.h"

namespace eikonal::reference {
namespace {

std::string contents(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    if (!stream) throw FrameError(fmt::format("cannot read '{}' again", file.string()));
    return bytes;
}

PagePicture write_png(const std::filesystem::path& file, const std::string& label, const LinearImage& image) {
    write_picture(file, picture_from_linear(image, file, false, 8));
    return {label, contents(file), false, 0};
}

LinearImage image_of(const std::vector<float>& rgba, int width, int height) {
    const PixelWindow window{0, 0, width, height};
    return {window, window, 1, rgba};
}

/// The end of a scale that at most one pixel in a hundred exceeds.
double fitting_scale(const std::vector<float>& error) {
    std::vector<float> known;
    std::copy_if(error.begin(), error.end(), std::back_inserter(known), [](float e) { return e >= 0; });
    return scale_end(error_statistics(std::move(known)).p99);
}

}  // namespace

std::vector<PagePicture> write_pictures(const std::filesystem::path& folder, const Comparison& c,
                                        const Comparer::Frame& frame) {
    const auto file = [&](const std::string& name) { return folder / fmt::format("{}.{:04}.png", name, frame.number); };
    const auto shown = [&](const std::vector<float>& rgba) { return image_of(rgba, c.width, c.height); };
    std::vector<PagePicture> pictures;
    const auto add_heat = [&](const std::string& name, const std::string& label, const std::vector<float>& error) {
        const double end = fitting_scale(error);
        pictures.push_back(write_png(file(name), label, heat_map(error, c.width, c.height, end)));
        pictures.back().scale_end = end;
    };
    pictures.push_back(write_png(file("plate"), "plate", shown(frame.plate.color)));
    pictures.push_back(write_png(file("truth"), "truth", shown(frame.truth.color)));
    for (std::size_t m = 0; m < c.models.size(); ++m) {
        const ModelResult& model = c.models[m];
        if (!model.applies()) continue;
        const bool warps = model.name != kNoModel;
        if (warps) {
            pictures.push_back(
                write_png(file("warp-" + model.name), "warp: " + row_name(model), shown(frame.models[m].warped)));
            pictures.back().is_default = model.is_default;
        }
        // The plate's own error is the true displacement.
        add_heat("error-" + model.name, warps ? "error: " + row_name(model) : "true displacement",
                 frame.models[m].error);
        if (!frame.models[m].change.empty())
            add_heat("change-" + model.name, warps ? "error of the change: " + row_name(model) : "true change",
                     frame.models[m].change);
    }
    return pictures;
}

void write_report(const std::filesystem::path& folder, const Comparison& c, const std::vector<PageFrame>& frames) {
    write_text_file(folder / "errors.csv", table_csv(c));
    write_text_file(folder / "errors.txt", table_text(c));
    write_text_file(folder / "frontier.svg", frontier_svg(c));
    write_text_file(folder / "index.html", comparison_page(c, frames));
}

}  // namespace eikonal::reference
