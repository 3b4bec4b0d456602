#include "warp/app/report.h"

#include <nlohmann/json.hpp>

#include "warp/image/atomic_file.h"

namespace eikonal {

void write_report(const std::filesystem::path& file, const Shot& shot, const RunResult& result, std::size_t kept) {
    nlohmann::ordered_json json;
    json["version"] = EIKONAL_VERSION;
    json["scene"] = shot.scene().file.string();
    json["models"] = shot.displacer().models();
    json["gain"] = shot.gain();
    json["expected_rms_px"] = shot.expected_rms();
    json["far_m"] = shot.depth().far();
    json["focusing_variance"] = shot.displacer().focusing_variance(shot.depth().far());
    json["fps"] = shot.fps();
    json["notes"] = shot.notes();
    json["warnings"] = shot.warnings();
    for (const std::string& warning : result.warnings) json["warnings"].push_back(warning);
    json["interrupted"] = result.interrupted;
    json["frames_kept"] = kept;
    auto& frames = json["frames"] = nlohmann::ordered_json::array();
    for (const FrameRecord& r : result.records) {
        nlohmann::ordered_json frame{{"frame", r.frame}, {"status", r.error.empty() ? "written" : "failed"}};
        if (r.error.empty()) {
            frame["rms_px"] = r.rms;
            frame["largest_px"] = r.largest;
        } else {
            frame["error"] = r.error;
        }
        frame["seconds"] = r.seconds;
        frames.push_back(std::move(frame));
    }
    write_text_file(file, json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace eikonal
