#pragma once

#include <CLI/CLI.hpp>
#include <cstdio>

#include "program/failure.h"

namespace mallow::program {

/// main() of a program with commands, which run as they are parsed. Without one it prints its help.
inline int parse_and_run(CLI::App& app, int argc, char** argv) {
  return run_main(app.get_name(), [&] {
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? k_exit_done : k_exit_bad_input;
    }
    if (!app.get_subcommands().empty()) return k_exit_done;
    std::fputs(app.help().c_str(), stderr);
    return k_exit_bad_input;
  });
}

}  // namespace mallow::program
