#include "reference/compare/frontier.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "reference/compare/comparison_table.h"

namespace eikonal::reference {
namespace {

/// Size and margins of the drawing [SVG units].
constexpr double kWidth = 720, kHeight = 420, kLeft = 74, kRight = 24, kTop = 24, kBottom = 58;
/// The least error [px] and time [ms] that are drawn, so that 0 has a place.
constexpr double kLeastError = 1e-4, kLeastTime = 1e-2;
/// Height of a label, and width of a letter.
constexpr double kLine = 16, kLetter = 7.2;

/// A logarithmic axis over whole decades.
struct Axis {
    double low = 0, high = 1;   ///< log10
    double start = 0, end = 1;  ///< their places in the drawing

    double at(double value) const { return start + (std::log10(value) - low) / (high - low) * (end - start); }
};

Axis axis(std::vector<double> values, double start, double end) {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    const double low = std::floor(std::log10(*least)), high = std::ceil(std::log10(*most));
    return {low, std::max(high, low + 1), start, end};
}

std::string tick(double exponent) {
    return exponent >= -4 && exponent <= 5 ? fmt::format("{:g}", std::pow(10, exponent))
                                           : fmt::format("1e{:g}", exponent);
}

std::string text(double x, double y, const char* anchor, const std::string& kind, const std::string& words) {
    return fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}' class='{}'>{}</text>\n", x, y, anchor, kind,
                       words);
}

std::string line(double x1, double y1, double x2, double y2, const char* kind) {
    return fmt::format("<line x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}' class='{}'/>\n", x1, y1, x2, y2, kind);
}

/// A place where a label may begin: the left end of its baseline.
struct Start {
    double x, y;
};

/// Places labels so that they overlap neither each other nor the points.
class Labels {
  public:
    void avoid(double x, double y) { taken_.push_back({x - 7, y - 7, x + 7, y + 7}); }
    /// Places a label at the first of the starts where there is room, or else at the last.
    std::string place(const std::vector<Start>& starts, const char* kind, const std::string& words) {
        const auto free = [&](const Start& s) {
            const Box box = box_of(s, words);
            return box.x0 >= kLeft && box.x1 <= kWidth - kRight && box.y0 >= kTop && box.y1 <= kHeight - kBottom &&
                   std::none_of(taken_.begin(), taken_.end(), [&](const Box& other) { return box.meets(other); });
        };
        const auto found = std::find_if(starts.begin(), starts.end(), free);
        const Start start = found != starts.end() ? *found : starts.back();
        taken_.push_back(box_of(start, words));
        return text(start.x, start.y, "start", kind, words);
    }
    /// Places a label beside a point: to its right, its left, above, below, and then in rows farther off.
    std::string beside(double x, double y, const char* kind, const std::string& words) {
        constexpr int kRows = 6;
        const double width = width_of(words);
        std::vector<Start> starts{
            {x + 11, y + 5}, {x - 11 - width, y + 5}, {x - width / 2, y - 11}, {x - width / 2, y + 22}};
        for (int row = 1; row <= kRows; ++row)
            for (const double side : {-kLine, kLine})
                for (const double left : {x + 11, x - 11 - width}) starts.push_back({left, y + 5 + row * side});
        return place(starts, kind, words);
    }
    static double width_of(const std::string& words) { return kLetter * static_cast<double>(words.size()); }

  private:
    struct Box {
        double x0, y0, x1, y1;
        bool meets(const Box& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
    };
    static Box box_of(const Start& s, const std::string& words) {
        return {s.x, s.y - kLine + 4, s.x + width_of(words), s.y + 4};
    }
    std::vector<Box> taken_;
};

/// All rules begin with .plot, so that they do not affect the rest of a page.
constexpr const char* kStyle =
    "<style>.plot text{font:13px "
    "ui-sans-serif,system-ui,sans-serif;fill:#3d4248;paint-order:stroke;stroke:#fff;stroke-width:3px}.plot "
    ".quiet{fill:#7a8087;"
    "font-size:12px}.plot .strong{font-weight:600;fill:#b3401e}.plot .grid{stroke:#e4e2dc}.plot .mark{stroke:#8d939a;"
    "stroke-dasharray:2 4}.plot .frontier{fill:none;stroke:#b3401e;stroke-width:2}.plot .other{fill:#fff;"
    "stroke:#3d4248;stroke-width:1.6}.plot .best{fill:#b3401e}</style>\n";

/// The axes with their decades and titles.
std::string grid(const Axis& x, const Axis& y) {
    std::string svg;
    for (double e = x.low; e <= x.high; ++e) {
        const double px = x.at(std::pow(10, e));
        svg += line(px, kTop, px, kHeight - kBottom, "grid") +
               text(px, kHeight - kBottom + 20, "middle", "quiet", tick(e));
    }
    for (double e = y.low; e <= y.high; ++e) {
        const double py = y.at(std::pow(10, e));
        svg += line(kLeft, py, kWidth - kRight, py, "grid") + text(kLeft - 10, py + 4, "end", "quiet", tick(e));
    }
    svg += text((kLeft + kWidth - kRight) / 2, kHeight - 14, "middle", "axis", "time of a frame, map and warp [ms]");
    svg += fmt::format(
        "<text x='20' y='{0:g}' text-anchor='middle' transform='rotate(-90 20 {0:g})'>p95 error of the displacement "
        "[px]</text>\n",
        (kTop + kHeight - kBottom) / 2);
    return svg;
}

/// Vertical and horizontal marks. Their names may stand anywhere along them.
std::string tracer_mark(Labels& labels, double px) {
    const std::string name = "the tracer";
    std::vector<Start> starts;
    for (double py = kTop + 16; py < kHeight - kBottom; py += kLine)
        for (const double left : {px - 6 - Labels::width_of(name), px + 6}) starts.push_back({left, py});
    return line(px, kTop, px, kHeight - kBottom, "mark") + labels.place(starts, "quiet", name);
}
std::string plate_mark(Labels& labels, double py) {
    std::vector<Start> starts;
    for (double px = kLeft + 6; px < kWidth - kRight; px += kLine)
        for (const double below : {-6.0, 15.0}) starts.push_back({px, py + below});
    return line(kLeft, py, kWidth - kRight, py, "mark") + labels.place(starts, "quiet", "no warp at all");
}

}  // namespace

std::vector<std::size_t> efficient(const Comparison& c) {
    double least = std::numeric_limits<double>::infinity();
    for (const ModelResult& m : c.models)
        if (m.name == kNoModel) least = m.all.p95;
    std::vector<std::size_t> order;
    for (std::size_t m = 0; m < c.models.size(); ++m)
        if (c.models[m].applies() && c.models[m].name != kNoModel) order.push_back(m);
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        const ModelResult &p = c.models[a], &q = c.models[b];
        return p.seconds() != q.seconds() ? p.seconds() < q.seconds() : p.all.p95 < q.all.p95;
    });
    std::vector<std::size_t> best;
    for (const std::size_t m : order) {
        if (c.models[m].all.p95 >= least) continue;
        best.push_back(m);
        least = c.models[m].all.p95;
    }
    return best;
}

std::string frontier_svg(const Comparison& c) {
    const auto time = [](double seconds) { return std::max(1e3 * seconds, kLeastTime); };
    const auto error = [](double px) { return std::max(px, kLeastError); };
    std::vector<double> times{time(c.picture_seconds)}, errors;
    for (const ModelResult& m : c.models) {
        if (!m.applies()) continue;
        errors.push_back(error(m.all.p95));
        if (m.name != kNoModel) times.push_back(time(m.seconds()));
    }
    const Axis x = axis(times, kLeft, kWidth - kRight), y = axis(errors, kHeight - kBottom, kTop);
    std::string svg = fmt::format(
        "<svg xmlns='http://www.w3.org/2000/svg' class='plot' viewBox='0 0 {0:g} {1:g}' role='img' aria-label='Error "
        "over time'>\n"
        "{2}<rect width='{0:g}' height='{1:g}' fill='#fff'/>\n",
        kWidth, kHeight, kStyle);
    svg += grid(x, y);
    const std::vector<std::size_t> best = efficient(c);
    std::string path;
    for (const std::size_t m : best)
        path += fmt::format("{}{:.1f},{:.1f}", path.empty() ? "" : " ", x.at(time(c.models[m].seconds())),
                            y.at(error(c.models[m].all.p95)));
    svg += fmt::format("<polyline points='{}' class='frontier'/>\n", path);
    Labels labels;
    std::string points, names;
    for (const bool draw : {false, true})  // labels must avoid what is drawn, so it comes first
        for (std::size_t m = 0; m < c.models.size(); ++m) {
            const ModelResult& model = c.models[m];
            if (!model.applies() || model.name == kNoModel) continue;
            const bool is_best = std::find(best.begin(), best.end(), m) != best.end();
            const double px = x.at(time(model.seconds())), py = y.at(error(model.all.p95));
            if (!draw) {
                labels.avoid(px, py);
                continue;
            }
            points += fmt::format(
                "<circle cx='{:.1f}' cy='{:.1f}' r='5.5' class='{}'><title>{}: {} px, {} ms</title></circle>\n", px, py,
                is_best ? "best" : "other", row_name(model), readable(model.all.p95), readable(1e3 * model.seconds()));
            names += labels.beside(px, py, is_best ? "strong" : "axis", row_name(model));
        }
    std::string marks = tracer_mark(labels, x.at(time(c.picture_seconds)));
    for (const ModelResult& m : c.models)
        if (m.name == kNoModel) marks += plate_mark(labels, y.at(error(m.all.p95)));
    return svg + marks + points + names + "</svg>\n";
}

}  // namespace eikonal::reference
