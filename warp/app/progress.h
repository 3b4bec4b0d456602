/// Progress on stderr: on a terminal a bar with the time left, otherwise a plain line at intervals.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

#include "warp/app/options.h"

namespace eikonal {

class Progress {
  public:
    Progress(ProgressStyle style, std::size_t total, std::string what);
    /// Reports the number of frames if that is still to be done, and ends the bar's line.
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Counts one more frame of `total`, which is made or has failed. Thread-safe.
    void step(bool made = true);
    /// Prints a line (a warning or a failure) above the bar. Thread-safe.
    void line(const std::string& text);

  private:
    void draw(bool last);

    using Clock = std::chrono::steady_clock;
    ProgressStyle style_;
    std::size_t total_, done_ = 0, failed_ = 0;
    std::string what_;
    Clock::time_point start_, drawn_;
    bool on_screen_ = false, ended_ = false;
    std::mutex lock_;
};

}  // namespace eikonal
