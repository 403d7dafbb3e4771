#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "program/machine.h"

namespace mallow::program {

/// --threads of a command, in the range that SolverConfig::threads has.
inline CLI::Option* add_threads_option(
    CLI::App& command, int& threads, const std::string& text = "Number of threads; 0: one for each processor",
    int least = 0) {
  return command.add_option("--threads", threads, text)->check(CLI::Range(least, most_threads()));
}

}  // namespace mallow::program
