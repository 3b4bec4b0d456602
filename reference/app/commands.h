/// The commands of eikonal-trace. Each returns the exit status; UserError, FrameError.
#pragma once

#include "reference/app/options.h"

namespace eikonal::reference {

int run(const RenderOptions& options);
int run(const PathOptions& options);
int run(const CompareOptions& options);
int run(const Information& information);

}  // namespace eikonal::reference
