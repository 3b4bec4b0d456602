/// Turns Ctrl-C and termination requests into a std::stop_token for the work of a program.
///
/// Files in progress are temporary ones (atomic_file.h). Finished frames therefore stay whole however the program ends.
#pragma once

#include <stop_token>
#include <thread>

namespace eikonal {

/// While an object lives, the first SIGINT, SIGTERM or SIGHUP requests a stop, and a second one ends the program at
/// once with exit status 1. A closed pipe and a file beyond the size limit raise no signal; the write fails instead. A
/// program has one object, made first thing in main, because threads started earlier would keep other signal settings.
class Interrupts {
  public:
    /// program: the name at the beginning of the program's last line; a string literal.
    explicit Interrupts(const char* program);
    ~Interrupts();
    Interrupts(const Interrupts&) = delete;

    std::stop_token token() const { return stop_.get_token(); }

  private:
    std::stop_source stop_;
    std::thread watcher_;
};

}  // namespace eikonal
