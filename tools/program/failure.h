#pragma once

#include <functional>
#include <stdexcept>
#include <string>

namespace mallow::program {

/// What a program ends with.
inline constexpr int k_exit_done = 0;
inline constexpr int k_exit_run_failed = 1;  ///< a step that cannot be taken, a full disk
inline constexpr int k_exit_bad_input = 2;   ///< command line, scene, input files, output folder

/// Something that went wrong while a run was under way: exit code 1.
class RunFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A run that was told to end, by Ctrl-C or a signal like it: exit code as shells have it.
class Interrupted : public RunFailure {
 public:
  Interrupted(const std::string& message, int signal) : RunFailure(message), exit_code(128 + signal) {}
  int exit_code;
};

/// What main() of a program returns: the exit code that `work` gives, or that of what it throws, which is
/// said on standard error behind the program's name. Standard output that cannot be written is a failure too.
int run_main(const std::string& name, const std::function<int()>& work);

}  // namespace mallow::program
