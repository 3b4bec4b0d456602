/// The four commands of `eikonal`. Each returns the exit status: 0 if all frames were written, 1 if some frame failed.
/// Each ends once a stop is requested. UserError (status 2) and FrameError (status 1) are thrown only before the first
/// frame is begun.
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
