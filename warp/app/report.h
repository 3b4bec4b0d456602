/// --report: what a run did, as JSON, for scripts and render farms.
#pragma once

#include <filesystem>

#include "warp/app/pipeline.h"
#include "warp/shimmer/footage_shot.h"

namespace eikonal {

/// What a run of `warp` or `map` has been asked and has come to.
struct RunSummary {
    std::vector<std::string> warnings;  ///< told before the frames were made
    std::size_t kept = 0;               ///< frames that were there already
    std::size_t total = 0;              ///< frames to make
    std::string rest;                   ///< what becomes of frames that were not made
};

/// Ends a run: tells how exact its frames are, writes the report, and tells what was not made. Returns the exit status.
int conclude(const FootageShot& shot, const RunOptions& options, const RunSummary& summary, RunResult& result);

/// Tells on stderr that frames are off by more than the shot's tolerance and, if `verbose`, by how much they are off
/// at all. What is told goes to the result's warnings.
void tell_errors(const Shot& shot, RunResult& result, bool verbose);

/// Writes frames (rms and largest displacement and stated error in px, seconds, error), models and how they were
/// chosen, gain, expected rms, notes and warnings.
void write_report(const std::filesystem::path& file, const FootageShot& shot, const RunSummary& summary,
                  const RunResult& result);

}  // namespace eikonal
