/// --report: what a run did, as JSON, for scripts and render farms.
#pragma once

#include <filesystem>

#include "warp/app/pipeline.h"
#include "warp/app/shot.h"

namespace eikonal {

/// Tells on stderr that frames are off by more than the shot's tolerance and, if `verbose`, by how much they are off
/// at all. What is told goes to the result's warnings.
void tell_errors(const Shot& shot, RunResult& result, bool verbose);

/// Writes frames (rms and largest displacement and stated error in px,
/// seconds, error), models and how they were chosen, gain, expected rms, notes and warnings.
void write_report(const std::filesystem::path& file, const Shot& shot, const RunResult& result, std::size_t kept);

}  // namespace eikonal
