/// Ctrl-C and termination requests, turned into a std::stop_token for the work of a program.
///
/// Files under way are temporary ones (atomic_file.h), so finished frames stay whole however the program ends.
#pragma once

#include <stop_token>
#include <thread>

namespace eikonal {

/// While it lives, the first SIGINT, SIGTERM or SIGHUP requests a stop, and a second one ends the program at once with
/// exit status 1. A closed pipe and a file beyond the size limit are errors of the write that meets them, not signals.
/// One a program, made first thing in main: threads started earlier would have other signal settings.
class Interrupts {
  public:
    /// program: the name that its last line begins with; a literal.
    explicit Interrupts(const char* program);
    ~Interrupts();
    Interrupts(const Interrupts&) = delete;

    std::stop_token token() const { return stop_.get_token(); }

  private:
    std::stop_source stop_;
    std::thread watcher_;
};

}  // namespace eikonal
