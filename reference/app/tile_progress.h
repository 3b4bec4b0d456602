/// Progress of one frame: a line with the time left. It is rewritten on a terminal; there is no output elsewhere.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace eikonal::reference {

class TileProgress {
  public:
    TileProgress(std::string what, int tiles);
    /// Clears the line.
    ~TileProgress();
    TileProgress(const TileProgress&) = delete;
    TileProgress& operator=(const TileProgress&) = delete;

    /// Counts one more finished tile. Thread-safe.
    void tile_done();

  private:
    using Clock = std::chrono::steady_clock;
    std::string what_;
    int tiles_, done_ = 0;
    bool shown_, drawn_ = false;
    Clock::time_point start_, last_;
    std::mutex mutex_;
};

}  // namespace eikonal::reference
