/// --report: a description of a finished run as JSON, for scripts and render farms.
#pragma once

#include <filesystem>

#include "warp/app/pipeline.h"
#include "warp/shimmer/footage_shot.h"

namespace eikonal {

/// The task of a run of `warp` or `map`, and what preceded its frames.
struct RunSummary {
    std::vector<std::string> warnings;  ///< given before the frames were made
    std::size_t kept = 0;               ///< number of frames that existed already
    std::size_t total = 0;              ///< number of frames to make
    std::string rest;                   ///< what becomes of the frames that were not made, in words
};

/// Ends a run. Reports the errors of its frames, writes the report file, and reports which frames were not made.
/// Returns the exit status.
int conclude(const FootageShot& shot, const RunOptions& options, const RunSummary& summary, RunResult& result);

/// Reports on stderr that frames exceed the shot's tolerance. If `verbose`, also reports the largest errors. The lines
/// are added to the result's warnings.
void tell_errors(const Shot& shot, RunResult& result, bool verbose);

/// Writes the report file. For each frame it holds the rms and largest displacement and the stated error in px, the
/// seconds, and the error message. It also holds the models and how they were chosen, the gain, the expected rms, notes
/// and warnings.
void write_report(const std::filesystem::path& file, const FootageShot& shot, const RunSummary& summary,
                  const RunResult& result);

}  // namespace eikonal
