#include "reference/app/tile_progress.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace eikonal::reference {

TileProgress::TileProgress(std::string what, int tiles)
    : what_(std::move(what)), tiles_(tiles), shown_(isatty(STDERR_FILENO) != 0), start_(Clock::now()), last_(start_) {}

TileProgress::~TileProgress() {
    if (drawn_) fmt::print(stderr, "\r\033[K");
}

void TileProgress::tile_done() {
    const std::scoped_lock lock(mutex_);
    ++done_;
    const auto now = Clock::now();
    if (!shown_ || now - last_ < std::chrono::milliseconds(100)) return;
    last_ = now;
    drawn_ = true;
    const auto left = std::chrono::duration_cast<std::chrono::seconds>((now - start_) * (tiles_ - done_) / done_);
    fmt::print(stderr, "\r{} {:3} %, {:%M:%S} left\033[K", what_, 100 * done_ / tiles_, left);
}

}  // namespace eikonal::reference
