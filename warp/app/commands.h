/// The four commands of `eikonal`. Each ends once a stop is requested, and returns the exit status: 0 all frames
/// written, 1 some frame failed. UserError (status 2) and FrameError (status 1) leave them as exceptions only before
/// any frame was begun.
#pragma once

#include <stop_token>

#include "warp/app/options.h"

namespace eikonal {

int run(const WarpOptions& options, const std::stop_token& stop);
int run(const MapOptions& options, const std::stop_token& stop);
int run(const FieldOptions& options, const std::stop_token& stop);
int run(const PresetsOptions& options, const std::stop_token& stop);
int run(const Information& information, const std::stop_token& stop);

}  // namespace eikonal
