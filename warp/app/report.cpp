#include "warp/app/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "warp/app/shot_options.h"
#include "warp/displace/stated_error.h"
#include "warp/image/atomic_file.h"
#include "warp/program/option_names.h"

namespace eikonal {
namespace {

/// The frame with the largest p95; null if no frame has one.
const FrameRecord* worst_frame(const RunResult& result) {
    const FrameRecord* worst = nullptr;
    for (const FrameRecord& r : result.records)
        if (r.stated && (worst == nullptr || r.stated->p95 > worst->stated->p95)) worst = &r;
    return worst;
}

std::optional<std::string> tolerance_warning(const Shot& shot, const RunResult& result) {
    const FrameRecord* worst = worst_frame(result);
    if (worst == nullptr || !shot.tolerance() || worst->stated->p95 <= *shot.tolerance()) return {};
    const auto beyond = std::count_if(result.records.begin(), result.records.end(), [&](const FrameRecord& r) {
        return r.stated && r.stated->p95 > *shot.tolerance();
    });
    const std::optional<Model> better = shot.sufficient_model(worst->stated->p95);
    return fmt::format(
        "--tolerance {:g}: {} of {} frames go beyond it, frame {} by most: {} in 95 of 100 sampled pixels; {}",
        *shot.tolerance(), beyond, result.records.size(), worst->frame, shown_error(worst->stated->p95),
        better ? fmt::format("--model {} should keep within it", name_of(*better))
               : "eikonal-trace render follows the rays truly");
}

nlohmann::ordered_json choice_json(const ModelChoice& choice) {
    nlohmann::ordered_json json{{"model", choice.exact ? "exact" : name_of(choice.model)},
                                {"p95_px", choice.p95},
                                {"within_tolerance", choice.within}};
    for (const TriedModel& tried : choice.tried) {
        nlohmann::ordered_json entry{{"model", name_of(tried.model)}};
        if (tried.refusal.empty())
            entry["p95_px"] = tried.p95;
        else
            entry["refusal"] = with_options(tried.refusal);
        json["tried"].push_back(std::move(entry));
    }
    return json;
}

nlohmann::ordered_json frame_json(const FrameRecord& r) {
    nlohmann::ordered_json frame{{"frame", r.frame}, {"status", r.error.empty() ? "written" : "failed"}};
    if (r.error.empty()) {
        frame["rms_px"] = r.rms;
        frame["largest_px"] = r.largest;
        if (r.stated)
            frame["stated_error_px"] = {{"p50", r.stated->p50},
                                        {"p95", r.stated->p95},
                                        {"max", r.stated->largest},
                                        {"samples", r.stated->samples}};
    } else {
        frame["error"] = r.error;
    }
    frame["seconds"] = r.seconds;
    return frame;
}

}  // namespace

void tell_errors(const Shot& shot, RunResult& result, bool verbose) {
    if (const FrameRecord* worst = worst_frame(result); worst != nullptr && verbose)
        fmt::print(stderr,
                   "eikonal: stated error: 95 of 100 of {} sampled pixels are off by {} at most, half of them by "
                   "{} (frame {}, the worst)\n",
                   worst->stated->samples, shown_error(worst->stated->p95), shown_error(worst->stated->p50),
                   worst->frame);
    if (const auto warning = tolerance_warning(shot, result)) {
        fmt::print(stderr, "eikonal: warning: {}\n", *warning);
        result.warnings.push_back(*warning);
    }
}

int conclude(const FootageShot& shot, const RunOptions& options, const RunSummary& summary, RunResult& result) {
    tell_errors(shot.shot(), result, options.verbose);
    if (options.report) write_report(*options.report, shot, summary, result);
    print_outcome(result, options, summary.total, summary.rest);
    return result.failed() ? 1 : 0;
}

void write_report(const std::filesystem::path& file, const FootageShot& footage_shot, const RunSummary& summary,
                  const RunResult& result) {
    const Shot& shot = footage_shot.shot();
    nlohmann::ordered_json json;
    json["version"] = EIKONAL_VERSION;
    json["scene"] = shot.scene().file.string();
    json["models"] = shot.displacer().models();
    json["gain"] = shot.gain();
    json["expected_rms_px"] = shot.expected_rms();
    json["far_m"] = shot.background().far;
    json["focusing_variance"] = shot.focusing_variance();
    json["fps"] = shot.fps();
    json["notes"] = with_options(footage_shot.notes());
    json["warnings"] = summary.warnings;
    for (const std::string& warning : result.warnings) json["warnings"].push_back(warning);
    if (shot.tolerance()) json["tolerance_px"] = *shot.tolerance();
    if (shot.choice() != nullptr) json["model_choice"] = choice_json(*shot.choice());
    json["interrupted"] = result.interrupted;
    json["frames_kept"] = summary.kept;
    json["frames"] = nlohmann::ordered_json::array();
    for (const FrameRecord& record : result.records) json["frames"].push_back(frame_json(record));
    write_text_file(file, json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace eikonal
