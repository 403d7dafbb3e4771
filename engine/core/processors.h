#pragma once

namespace mallow {

/// Processors that this process may use, >= 1.
int processor_count();

/// Lets this thread run on all of them. With OMP_PROC_BIND the main thread is bound to one when the program
/// starts, and every thread that it starts inherits that.
void use_all_processors();

/// The processor this thread runs on; -1 where the system does not say.
int current_processor();

/// Moves this thread off a processor, if it may use another.
void leave_processor(int processor);

}  // namespace mallow
