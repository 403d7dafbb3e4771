#pragma once

namespace mallow::program {

/// From now on the first Ctrl-C (or SIGTERM) asks the run to end after the present step, with all files
/// whole; the second one ends the program at once.
void watch_for_interrupt();
/// The signal that asked; 0: none has.
int interrupted();

}  // namespace mallow::program
