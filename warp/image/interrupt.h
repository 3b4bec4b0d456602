/// Ctrl-C and termination requests end a run where its work asks for them, never within the writing of a file. Shared
/// by the programs; files that were begun are temporary ones (atomic_file.h), so that finished frames stay whole either
/// way.
#pragma once

namespace eikonal {

/// From now on SIGINT, SIGTERM and SIGHUP only raise a flag; a second one ends the program at once, with exit status 1
/// and a line that begins with `program`, a literal. A closed pipe is an error that a write reports, not a signal.
void catch_interrupts(const char* program);
bool interrupted();

}  // namespace eikonal
