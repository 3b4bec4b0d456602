/// The four commands of `eikonal`. Each returns the exit status: 0 all frames written, 1 some frame failed. UserError
/// (status 2) and FrameError (status 1) leave them as exceptions only before any frame was begun.
#pragma once

#include "warp/app/options.h"

namespace eikonal {

int run(const WarpOptions& options);
int run(const MapOptions& options);
int run(const FieldOptions& options);
int run(const PresetsOptions& options);
int run(const Information& information);

}  // namespace eikonal
