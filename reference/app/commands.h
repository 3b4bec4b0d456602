/// The commands of eikonal-trace. Each returns the exit status and ends once a stop is requested.
/// UserError, FrameError.
#pragma once

#include <stop_token>

#include "reference/app/options.h"

namespace eikonal::reference {

int run(const RenderOptions& options, const std::stop_token& stop);
int run(const PathOptions& options, const std::stop_token& stop);
int run(const CompareOptions& options, const std::stop_token& stop);
int run(const Information& information, const std::stop_token& stop);

}  // namespace eikonal::reference
