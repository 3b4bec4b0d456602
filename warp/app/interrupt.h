/// Ctrl-C and termination requests end a run between frames instead of within one.
#pragma once

namespace eikonal {

/// From now on SIGINT, SIGTERM and SIGHUP only raise a flag; a second one ends the program at once. A closed pipe is an
/// error that a write reports, not a signal.
void catch_interrupts();
bool interrupted();

}  // namespace eikonal
