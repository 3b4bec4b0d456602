#include "reference/compare/comparison_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace eikonal::reference {
namespace {

using Statistics = ErrorStatistics ModelResult::*;

/// The columns mean … max for one set of pixels.
template <Statistics set>
void add_errors(std::vector<Column>& list, ColumnGroup group, const std::string& prefix, bool brief) {
    const auto add = [&](const char* key, const char* heading, bool in_brief, auto value) {
        list.push_back({group, prefix + key, heading, in_brief, value});
    };
    using Value = std::optional<double>;
    add("mean", "mean px", false,
        [](const Comparison&, const ModelResult& m) { return (m.*set).count > 0 ? Value((m.*set).mean) : Value(); });
    add("p50", "p50 px", false,
        [](const Comparison&, const ModelResult& m) { return (m.*set).count > 0 ? Value((m.*set).p50) : Value(); });
    add("p95", "p95 px", brief,
        [](const Comparison&, const ModelResult& m) { return (m.*set).count > 0 ? Value((m.*set).p95) : Value(); });
    add("p99", "p99 px", brief && group == ColumnGroup::All,
        [](const Comparison&, const ModelResult& m) { return (m.*set).count > 0 ? Value((m.*set).p99) : Value(); });
    add("max", "max px", false,
        [](const Comparison&, const ModelResult& m) { return (m.*set).count > 0 ? Value((m.*set).largest) : Value(); });
}

std::optional<double> positive(double value) {
    return value > 0 ? std::optional(value) : std::nullopt;
}

/// The number of characters in UTF-8 text.
std::size_t letters(const std::string& text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t width, bool right) {
    const std::string blanks(width - std::min(width, letters(text)), ' ');
    return right ? blanks + text : text + blanks;
}

/// Cells as lines of text. The first column is aligned to the left, figures to the right.
std::string aligned(const std::vector<std::vector<std::string>>& rows) {
    std::vector<std::size_t> widths(rows.front().size());
    for (const auto& row : rows)
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], letters(row[i]));
    std::string text;
    for (const auto& row : rows) {
        for (std::size_t i = 0; i < row.size(); ++i) text += (i > 0 ? "  " : "") + padded(row[i], widths[i], i > 0);
        text += '\n';
    }
    return text;
}

std::string percent(double part) {
    return readable(100 * part) + " %";
}

}  // namespace

std::vector<Column> columns(const Comparison& comparison) {
    std::vector<Column> list;
    add_errors<&ModelResult::all>(list, ColumnGroup::All, "", true);
    list.push_back({ColumnGroup::All, "stated_p95", "stated p95", true,
                    [](const Comparison&, const ModelResult& m) { return m.stated_p95; }});
    add_errors<&ModelResult::smooth>(list, ColumnGroup::Smooth, "smooth_", true);
    add_errors<&ModelResult::silhouettes>(list, ColumnGroup::Silhouettes, "silhouette_", true);
    if (comparison.over_time()) add_errors<&ModelResult::temporal>(list, ColumnGroup::Temporal, "temporal_", true);
    using C = const Comparison&;
    using M = const ModelResult&;
    using Value = std::optional<double>;
    const auto add = [&](ColumnGroup group, const char* key, const char* heading, bool brief, Value (*value)(C, M)) {
        list.push_back({group, key, heading, brief, value});
    };
    add(ColumnGroup::Picture, "psnr_db", "PSNR dB", true, [](C, M m) { return Value(m.picture.psnr); });
    add(ColumnGroup::Picture, "ssim", "SSIM", true, [](C, M m) { return Value(m.picture.ssim); });
    add(ColumnGroup::Picture, "butteraugli", "butteraugli", true, [](C, M m) { return Value(m.picture.butteraugli); });
    add(ColumnGroup::Cost, "setup_ms", "once a shot ms", false, [](C, M m) { return positive(1e3 * m.setup_seconds); });
    add(ColumnGroup::Cost, "map_ms", "map ms", true, [](C, M m) { return positive(1e3 * m.map_seconds); });
    add(ColumnGroup::Cost, "warp_ms", "warp ms", true, [](C, M m) { return positive(1e3 * m.warp_seconds); });
    add(ColumnGroup::Cost, "memory_mb", "memory MB", true, [](C, M m) { return positive(1e-6 * m.memory); });
    add(ColumnGroup::Cost, "times_faster", "times faster", true,
        [](C c, M m) { return m.seconds() > 0 ? Value(c.picture_seconds / m.seconds()) : Value(); });
    return list;
}

std::string heading_of(ColumnGroup group) {
    switch (group) {
        case ColumnGroup::All:
            return "Displacement error";
        case ColumnGroup::Smooth:
            return "on smooth depth";
        case ColumnGroup::Silhouettes:
            return "near silhouettes";
        case ColumnGroup::Temporal:
            return "from frame to frame";
        case ColumnGroup::Picture:
            return "Picture";
        case ColumnGroup::Cost:
            return "Cost of a frame";
    }
    return "";
}

std::string readable(double value) {
    if (std::isinf(value)) return value > 0 ? "∞" : "−∞";
    const double size = std::abs(value);
    if (size == 0) return "0";
    if (size < 1e-4 || size >= 1e6) return fmt::format("{:.1e}", value);
    return fmt::format("{:.{}f}", value, std::clamp(2 - static_cast<int>(std::floor(std::log10(size))), 0, 6));
}

std::string row_name(const ModelResult& model) {
    return model.is_default && model.name != kDefaultModel ? model.name + " (default)" : model.name;
}

std::vector<Fact> facts(const Comparison& c) {
    std::vector<Fact> list{
        {"picture", fmt::format("{} × {}, {} samples a pixel", c.width, c.height, c.samples)},
        {"frames", fmt::format("{}", fmt::join(c.frames, ", "))},
        {"true displacement", fmt::format("{} px rms, {} px at most", readable(c.rms), readable(c.largest))},
        {"focusing variance",
         fmt::format("{} at {} m (rays begin to fold near 1)", readable(c.focusing_variance), readable(c.far))},
        {"folded pixels", c.folded ? percent(*c.folded) : "unknown: this integrator follows no bundles"},
        {"trapped rays", percent(c.trapped)},
        {"near silhouettes", percent(c.silhouettes) + " of the pixels"},
        {"tracer", fmt::format("{}, tolerance {:g} px, its own estimate of its error {} px on average", c.integrator,
                               c.tolerance, readable(c.tracer_error))},
        {"tracer's time", fmt::format("{} ms a frame for the picture, {} ms for one ray a pixel without colour",
                                      readable(1e3 * c.picture_seconds), readable(1e3 * c.tracer_seconds))}};
    if (c.background > 0)
        list.push_back({"background", fmt::format("{} of the pixels; {} m away to the warp and in the true "
                                                  "displacement, infinitely far in the true picture",
                                                  percent(c.background), readable(c.far))});
    if (c.without_index > 0) list.push_back({"rays to n <= 0", percent(c.without_index)});
    return list;
}

std::string table_csv(const Comparison& c) {
    const std::vector<Column> list = columns(c);
    std::string text = "model,default";
    for (const Column& column : list) text += "," + column.key;
    text += '\n';
    for (const ModelResult& model : c.models) {
        if (!model.applies()) continue;
        text += fmt::format("{},{}", model.name, model.is_default ? 1 : 0);
        for (const Column& column : list) {
            const auto value = column.value(c, model);
            text += value && std::isfinite(*value) ? fmt::format(",{:.6g}", *value) : ",";
        }
        text += '\n';
    }
    return text;
}

std::string table_text(const Comparison& c) {
    std::string text = c.scene + "\n\n";
    std::vector<std::vector<std::string>> lines;
    std::size_t width = 0;
    for (const Fact& fact : facts(c)) width = std::max(width, fact.label.size());
    for (const Fact& fact : facts(c)) text += padded(fact.label, width + 2, false) + fact.text + "\n";
    const std::vector<Column> list = columns(c);
    for (std::size_t begin = 0, end = 0; begin < list.size(); begin = end) {
        const ColumnGroup group = list[begin].group;
        while (end < list.size() && list[end].group == group) ++end;
        std::vector<std::vector<std::string>> rows{{heading_of(group)}};
        for (std::size_t i = begin; i < end; ++i) rows.front().push_back(list[i].heading);
        for (const ModelResult& model : c.models) {
            if (!model.applies()) continue;
            rows.push_back({row_name(model)});
            for (std::size_t i = begin; i < end; ++i) {
                const auto value = list[i].value(c, model);
                rows.back().push_back(value ? readable(*value) : "–");
            }
        }
        text += "\n" + aligned(rows);
    }
    for (const ModelResult& model : c.models)
        if (!model.applies()) text += fmt::format("\n{} does not apply: {}\n", model.name, model.refusal);
    return text;
}

}  // namespace eikonal::reference
