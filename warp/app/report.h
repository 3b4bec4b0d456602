/// --report: what a run did, as JSON, for scripts and render farms.
#pragma once

#include <filesystem>

#include "warp/app/pipeline.h"
#include "warp/app/shot.h"

namespace eikonal {

/// Writes frames (rms and largest displacement in px, seconds, error), models, gain, expected rms, notes and warnings.
void write_report(const std::filesystem::path& file, const Shot& shot, const RunResult& result, std::size_t kept);

}  // namespace eikonal
