/// How a render is given up on request: within a ray, which may be long, not only between tiles. Header only.
#pragma once

#include "noise/base/error.h"
#include "reference/trace/bent_ray.h"

namespace eikonal::reference {

/// Tells whether to give up. Asked from any thread, for every ray and every kStepsUnasked steps of it. Null: never.
using Cancelled = bool (*)();
inline constexpr int kStepsUnasked = 256;

/// FrameError if the render is to be given up.
inline void check_cancelled(Cancelled cancelled) {
    if (cancelled && cancelled()) throw FrameError("interrupted; the same command goes on");
}

/// What asks along a ray, for trace().
inline StepRecorder watch(Cancelled cancelled) {
    if (!cancelled) return {};
    return [cancelled, steps = 0](const Step&) mutable {
        if (++steps % kStepsUnasked == 0) check_cancelled(cancelled);
    };
}

}  // namespace eikonal::reference
