#pragma once

namespace mallow::program {

/// From now on the first Ctrl-C (or SIGTERM) ends the program at once, with exit code 128 and its number, and
/// these words behind "mallow: " on standard error. Of a program that has nothing to lose yet. words: a
/// literal.
void end_at_interrupt(const char* words);
/// From now on the first Ctrl-C (or SIGTERM) asks the run to end after the present step, with all files
/// whole; the second one ends the program at once.
void watch_for_interrupt();
/// The signal that asked; 0: none has.
int interrupted();

}  // namespace mallow::program
