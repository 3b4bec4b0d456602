/// The number of threads that a program uses.
#pragma once

#include <tbb/global_control.h>

namespace eikonal {

/// While an object lives, oneTBB and the image library use at most this number of threads.
class ThreadLimit {
  public:
    /// threads: 0 for all processors.
    explicit ThreadLimit(int threads);
    int threads() const { return threads_; }

  private:
    int threads_;
    tbb::global_control control_;
};

}  // namespace eikonal
