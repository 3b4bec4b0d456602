/// How a render is given up on request: within a ray, which may be long, not only between tiles. Header only.
#pragma once

#include <stop_token>

#include "noise/base/error.h"
#include "reference/trace/bent_ray.h"

namespace eikonal::reference {

/// Steps of a ray from one look at the stop token to the next.
inline constexpr int kStepsUnasked = 256;

/// FrameError if a stop has been requested.
inline void check_stop(const std::stop_token& stop) {
    if (stop.stop_requested()) throw FrameError("interrupted; the same command goes on");
}

/// What asks along a ray, for trace(). It refers to `stop`, which must outlive it: copies of a token, one a ray, would
/// make threads wait for its counter.
inline StepRecorder watch(const std::stop_token& stop) {
    if (!stop.stop_possible()) return {};
    return [&stop, steps = 0](const Step&) mutable {
        if (++steps % kStepsUnasked == 0) check_stop(stop);
    };
}

}  // namespace eikonal::reference
